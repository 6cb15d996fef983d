#include <algorithm>
#include <unordered_map>

#include "obj_blocks.h"
#include "obj_tags.h"
#include "parallel.h"
#include "prep/io.h"
#include "prep/obj.h"

namespace prep {
namespace {

using namespace detail;
using Index = std::uint32_t;

struct Counts {
    std::size_t positions = 0, uvs = 0, normals = 0;
    std::size_t faces = 0, corners = 0, lines = 0;
};

class Assembler {
  public:
    Assembler(std::vector<ObjBlock> blocks, const ObjOptions& options)
        : blocks_(std::move(blocks)), options_(options) {}

    Result<Scene> run() {
        if (auto done = count(); !done) return std::move(done).error();
        scene_.name = options_.name;
        scene_.meshes.emplace_back();
        mesh_ = &scene_.meshes.back();
        mesh_->name = std::filesystem::path(options_.name).stem().string();
        vertices();
        if (auto done = faces(); !done) return std::move(done).error();
        if (auto done = polylines(); !done) return std::move(done).error();
        states();
        if (auto done = tags(); !done) return std::move(done).error();
        colors();
        warnings();
        instance_unused_meshes(scene_);
        return std::move(scene_);
    }

  private:
    Error error_at(std::size_t line, std::string text, ErrorCode code = ErrorCode::invalid) const {
        return {code, std::move(text), options_.name + ":" + std::to_string(line)};
    }
    std::size_t line_of(std::size_t block, std::uint32_t local) const {
        return bases_[block].lines + local;
    }

    Result<void> count() {
        bases_.resize(blocks_.size() + 1);
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            const ObjBlock& block = blocks_[b];
            const Counts& base = bases_[b];
            if (block.failure)
                return error_at(base.lines + block.failure->line, block.failure->text,
                                ErrorCode::syntax);
            bases_[b + 1] = {
                base.positions + block.positions.size(),   base.uvs + block.uvs.size(),
                base.normals + block.normals.size(),       base.faces + block.faces.ends.size(),
                base.corners + block.faces.corners.size(), base.lines + block.lines};
        }
        const Counts& total = bases_.back();
        const std::size_t limit = std::size_t(relative_bias);
        if (total.positions >= limit || total.uvs >= limit || total.normals >= limit ||
            total.corners >= no_index)
            return Error{ErrorCode::limit,
                         "more than 2^30 vertices or 2^32 - 2 corners: cut the file into pieces",
                         options_.name};
        return {};
    }

    void vertices() {
        const Counts& total = bases_.back();
        std::vector<glm::dvec3> positions(total.positions);
        scene_.meshes[0].uvs.clear();
        uvs_.resize(total.uvs);
        mesh_->normals.values.resize(total.normals);
        parallel_blocks(blocks_.size(), 1, options_.threads, [&](std::size_t b, std::size_t) {
            const ObjBlock& block = blocks_[b];
            const Counts& base = bases_[b];
            std::copy(block.positions.begin(), block.positions.end(),
                      positions.begin() + std::ptrdiff_t(base.positions));
            std::copy(block.uvs.begin(), block.uvs.end(), uvs_.begin() + std::ptrdiff_t(base.uvs));
            std::copy(block.normals.begin(), block.normals.end(),
                      mesh_->normals.values.begin() + std::ptrdiff_t(base.normals));
        });
        set_positions(*mesh_, positions);
    }

    // The 0-based index into all the file's elements; false when there is no such element.
    static bool resolve(ObjIndex raw, std::size_t base, std::size_t total, Index& out) {
        if (raw == 0) {
            out = no_index;
            return true;
        }
        const std::int64_t i = raw > 0 ? std::int64_t(raw) - 1
                                       : std::int64_t(base) - (std::int64_t(raw) + relative_bias);
        if (i < 0 || i >= std::int64_t(total)) return false;
        out = Index(i);
        return true;
    }

    struct BadIndex {  // the first in a block
        bool found = false;
        std::size_t line = 0;
        std::string text;
    };

    void report(BadIndex& bad, std::size_t block, const ObjElements& elements, std::size_t corner,
                const char* what, ObjIndex raw, std::size_t base, std::size_t total) const {
        const std::size_t element =
            std::size_t(std::upper_bound(elements.ends.begin(), elements.ends.end(), corner) -
                        elements.ends.begin());
        bad.found = true;
        bad.line = line_of(block, elements.lines[element]);
        const std::int64_t written =
            raw > 0 ? raw : std::int64_t(base) - (std::int64_t(raw) + relative_bias) + 1;
        bad.text = std::string(what) + " index " + std::to_string(written) +
                   " is out of range: the file has " + std::to_string(total);
    }

    Result<void> faces() {
        const Counts& total = bases_.back();
        mesh_->face_offsets.resize(total.faces + 1);
        mesh_->corner_vertices.resize(total.corners);
        std::vector<Index> uv_indices(total.corners), normal_indices(total.corners);
        std::vector<BadIndex> bad(blocks_.size());
        std::vector<char> has_uv(blocks_.size(), 0), has_normal(blocks_.size(), 0);
        parallel_blocks(blocks_.size(), 1, options_.threads, [&](std::size_t b, std::size_t) {
            const ObjElements& faces = blocks_[b].faces;
            const Counts& base = bases_[b];
            for (std::size_t f = 0; f < faces.ends.size(); ++f)
                mesh_->face_offsets[base.faces + f + 1] = Index(base.corners + faces.ends[f]);
            for (std::size_t c = 0; c < faces.corners.size(); ++c) {
                const ObjCorner& corner = faces.corners[c];
                const std::size_t to = base.corners + c;
                const auto take = [&](ObjIndex raw, std::size_t local, std::size_t all, Index& out,
                                      const char* what) {
                    if (resolve(raw, local, all, out)) return true;
                    report(bad[b], b, faces, c, what, raw, local, all);
                    return false;
                };
                if (!take(corner.v, base.positions, total.positions, mesh_->corner_vertices[to],
                          "vertex") ||
                    !take(corner.t, base.uvs, total.uvs, uv_indices[to], "texture coordinate") ||
                    !take(corner.n, base.normals, total.normals, normal_indices[to], "normal"))
                    return;
                has_uv[b] |= corner.t != 0;
                has_normal[b] |= corner.n != 0;
            }
        });
        for (const BadIndex& first : bad)
            if (first.found) return error_at(first.line, first.text);
        const auto any = [](const std::vector<char>& flags) {
            return std::find(flags.begin(), flags.end(), 1) != flags.end();
        };
        if (any(has_uv)) {
            mesh_->uvs.emplace_back();
            mesh_->uvs[0].values = std::move(uvs_);
            mesh_->uvs[0].indices = std::move(uv_indices);
        }
        if (any(has_normal)) {
            mesh_->normals.indices = std::move(normal_indices);
        } else {
            mesh_->normals = {};
        }
        return {};
    }

    Result<void> polylines() {
        const std::size_t total = bases_.back().positions;
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            for (const bool lines : {true, false}) {
                const ObjElements& elements = lines ? blocks_[b].polylines : blocks_[b].points;
                for (std::size_t c = 0; c < elements.corners.size(); ++c) {
                    Index v = no_index;
                    if (!resolve(elements.corners[c].v, bases_[b].positions, total, v)) {
                        BadIndex bad;
                        report(bad, b, elements, c, "vertex", elements.corners[c].v,
                               bases_[b].positions, total);
                        return error_at(bad.line, bad.text);
                    }
                    (lines ? mesh_->line_vertices : mesh_->points).push_back(v);
                }
                if (!lines) continue;
                const Index base = mesh_->line_offsets.back();
                for (const std::uint32_t end : elements.ends)
                    mesh_->line_offsets.push_back(base + end);
            }
        }
        return {};
    }

    // usemtl, s, o and g hold from their line to the next of their kind, across blocks.
    void states() {
        bool any_material = false, any_smoothing = false, any_part = false;
        for (const ObjBlock& block : blocks_)
            for (const ObjEvent& e : block.events) {
                any_material |= e.kind == ObjEvent::Kind::material;
                any_smoothing |= e.kind == ObjEvent::Kind::smoothing;
                any_part |= e.kind == ObjEvent::Kind::group || e.kind == ObjEvent::Kind::object;
                if (e.kind == ObjEvent::Kind::library) libraries(e.text);
            }
        for (Index m = 0; m < scene_.materials.size(); ++m)
            materials_.emplace(scene_.materials[m].name, m);

        const std::size_t faces = bases_.back().faces;
        if (any_material) mesh_->face_materials.assign(faces, no_index);
        if (any_smoothing) mesh_->face_smoothing.assign(faces, 0);
        if (any_part) mesh_->face_parts.assign(faces, no_index);
        Index material = no_index, smoothing = 0, part = no_index;
        std::string object, group;
        std::size_t from = 0;
        const auto fill = [&](std::size_t to) {
            if (any_material)
                std::fill(mesh_->face_materials.begin() + std::ptrdiff_t(from),
                          mesh_->face_materials.begin() + std::ptrdiff_t(to), material);
            if (any_smoothing)
                std::fill(mesh_->face_smoothing.begin() + std::ptrdiff_t(from),
                          mesh_->face_smoothing.begin() + std::ptrdiff_t(to), smoothing);
            if (any_part && to > from) {
                if (part == no_index) part = part_named(object, group);
                std::fill(mesh_->face_parts.begin() + std::ptrdiff_t(from),
                          mesh_->face_parts.begin() + std::ptrdiff_t(to), part);
            }
            from = to;
        };
        for (std::size_t b = 0; b < blocks_.size(); ++b)
            for (const ObjEvent& e : blocks_[b].events) {
                fill(bases_[b].faces + e.face);
                switch (e.kind) {
                    case ObjEvent::Kind::material:
                        material = material_named(e.text);
                        break;
                    case ObjEvent::Kind::smoothing:
                        smoothing = e.number;
                        break;
                    case ObjEvent::Kind::object:
                        object = e.text;
                        group.clear();
                        part = no_index;
                        break;
                    case ObjEvent::Kind::group:
                        group = e.text;
                        part = no_index;
                        break;
                    case ObjEvent::Kind::library:
                        break;
                }
            }
        fill(faces);
        // "s off" throughout is what exporters write when they know of no groups: no information.
        if (std::all_of(mesh_->face_smoothing.begin(), mesh_->face_smoothing.end(),
                        [](Index s) { return s == 0; }))
            mesh_->face_smoothing.clear();
    }

    Index part_named(const std::string& object, const std::string& group) {
        const std::string name = object.empty()  ? group
                                 : group.empty() ? object
                                                 : object + "/" + group;
        const auto [it, added] = parts_.emplace(name, Index(mesh_->parts.size()));
        if (added) mesh_->parts.push_back(name);
        return it->second;
    }

    Index material_named(const std::string& name) {
        const auto [it, added] = materials_.emplace(name, Index(scene_.materials.size()));
        if (added) {
            scene_.materials.emplace_back();
            scene_.materials.back().name = name;
            if (options_.read_materials && !missing_library_)
                scene_.warnings.push_back("material '" + name +
                                          "' is in no library: the default look is used");
        }
        return it->second;
    }

    void libraries(const std::string& names) {
        if (!options_.read_materials) return;
        // One file name with blanks, or several names: what exists decides.
        if (library(names)) return;
        LineWords words(names);
        bool several = false;
        for (std::string word; words.next(word);) {
            if (word == names) break;
            several = true;
            if (!library(word)) missing(word);
        }
        if (!several) missing(names);
    }

    struct LineWords {
        explicit LineWords(std::string_view names) : text(names) {}
        bool next(std::string& word) {
            const std::size_t begin = text.find_first_not_of(" \t");
            if (begin == std::string_view::npos) return false;
            text.remove_prefix(begin);
            const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
            word = std::string(text.substr(0, end));
            text.remove_prefix(end);
            return true;
        }
        std::string_view text;
    };

    void missing(const std::string& name) {
        missing_library_ = true;
        scene_.warnings.push_back("material library '" + name +
                                  "' cannot be read: its materials get the default look");
    }

    bool library(const std::string& name) {
        std::string portable = name;
        std::replace(portable.begin(), portable.end(), '\\', '/');
        if (portable.empty()) return false;
        const std::filesystem::path path = options_.directory / portable;
        std::error_code ec;
        if (!std::filesystem::is_regular_file(path, ec)) return false;
        const auto bytes = read_file(path);
        if (!bytes) return false;
        MtlLibrary lib = parse_mtl({reinterpret_cast<const char*>(bytes->data()), bytes->size()},
                                   name, path.parent_path());
        const Index textures = Index(scene_.textures.size()), images = Index(scene_.images.size());
        for (Texture& t : lib.textures) {
            t.image += images;
            scene_.textures.push_back(t);
        }
        for (ImageRef& image : lib.images) scene_.images.push_back(std::move(image));
        for (Material& m : lib.materials) {
            for (TextureRef* ref :
                 {&m.diffuse_map, &m.specular_map, &m.emissive_map, &m.occlusion_map, &m.normal_map,
                  &m.bump_map, &m.displacement_map, &m.metallic_roughness_map})
                if (*ref) ref->texture += textures;
            scene_.materials.push_back(std::move(m));
        }
        for (std::string& w : lib.warnings) scene_.warnings.push_back(std::move(w));
        return true;
    }

    Result<void> tags() {
        for (std::size_t b = 0; b < blocks_.size(); ++b)
            for (const ObjTag& tag : blocks_[b].tags) {
                std::string problem = read_obj_tag(tag.text, *mesh_);
                if (!problem.empty()) return error_at(line_of(b, tag.line), std::move(problem));
            }
        return {};
    }

    void colors() {
        const bool any = std::any_of(blocks_.begin(), blocks_.end(),
                                     [](const ObjBlock& b) { return !b.colors.empty(); });
        if (!any) return;
        std::vector<glm::vec4> values(bases_.back().positions, glm::vec4(1.0f));
        for (std::size_t b = 0; b < blocks_.size(); ++b)
            std::copy(blocks_[b].colors.begin(), blocks_[b].colors.end(),
                      values.begin() + std::ptrdiff_t(bases_[b].positions));
        if (mesh_->corner_count() > 0) {
            mesh_->colors.emplace_back();
            mesh_->colors[0].indices = mesh_->corner_vertices;
            mesh_->colors[0].values = std::move(values);
        } else {
            mesh_->vertex_colors = std::move(values);
        }
    }

    void warn(std::uint64_t count, std::size_t first_line, const std::string& text) {
        if (count > 0)
            scene_.warnings.push_back(options_.name + ":" + std::to_string(first_line) + ": " +
                                      text + " (" + std::to_string(count) + " in all)");
    }

    void warnings() {
        std::uint64_t shorts = 0, free_form = 0, unknown = 0, non_finite = 0;
        std::size_t short_line = 0, free_line = 0, unknown_line = 0, finite_line = 0;
        std::string word;
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            const ObjBlock& block = blocks_[b];
            const auto gather = [&](std::uint64_t& sum, std::size_t& line, std::uint32_t n,
                                    std::uint32_t local) {
                if (sum == 0 && n > 0) line = line_of(b, local);
                sum += n;
            };
            if (unknown == 0) word = block.unknown_word;
            gather(shorts, short_line, block.short_faces, block.short_face_line);
            gather(free_form, free_line, block.free_form, block.free_form_line);
            gather(unknown, unknown_line, block.unknown, block.unknown_line);
            gather(non_finite, finite_line, block.non_finite, block.non_finite_line);
        }
        warn(shorts, short_line, "elements with too few corners were dropped");
        warn(free_form, free_line, "free-form geometry is not supported and was skipped");
        warn(unknown, unknown_line, "unknown statement " + word + " was skipped");
        warn(non_finite, finite_line, "coordinates that are not finite");
    }

    std::vector<ObjBlock> blocks_;
    const ObjOptions& options_;
    std::vector<Counts> bases_;
    std::vector<glm::vec2> uvs_;
    Scene scene_;
    Mesh* mesh_ = nullptr;
    std::unordered_map<std::string, Index> materials_, parts_;
    bool missing_library_ = false;
};

}  // namespace

Result<Scene> parse_obj(std::span<const std::byte> bytes, const ObjOptions& options) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark
    const std::vector<std::size_t> starts = obj_block_starts(text);
    std::vector<ObjBlock> blocks(starts.size());
    parallel_blocks(blocks.size(), 1, options.threads, [&](std::size_t b, std::size_t) {
        const std::size_t end = b + 1 < starts.size() ? starts[b + 1] : text.size();
        blocks[b] = parse_obj_block(text.substr(starts[b], end - starts[b]));
    });
    return Assembler(std::move(blocks), options).run();
}

Result<Scene> load_obj(const std::filesystem::path& path, int threads) {
    const auto bytes = read_file(path);
    if (!bytes) return bytes.error();
    ObjOptions options;
    options.name = path.filename().string();
    options.directory = path.parent_path();
    options.threads = threads;
    auto scene = parse_obj(*bytes, options);
    if (scene) scene->source = path;
    return scene;
}

}  // namespace prep
