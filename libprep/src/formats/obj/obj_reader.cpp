#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>

#include "base/parallel.h"
#include "formats/loose_points.h"
#include "formats/obj/blocks.h"
#include "formats/obj/obj.h"
#include "formats/obj/tags.h"
#include "formats/picture_search.h"
#include "prep/files.h"
#include "text/line_ends.h"
#include "text/scan.h"

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
    Assembler(std::vector<ObjBlock> blocks, const glm::dvec3& origin, const ObjOptions& options)
        : blocks_(std::move(blocks)), origin_(origin), options_(options) {}

    Result<Scene> run() {
        if (auto done = count(); !done) return std::move(done).error();
        scene_.name = options_.name;
        scene_.meshes.emplace_back();
        mesh_ = &scene_.meshes.back();
        mesh_->name = std::filesystem::path(options_.name).stem().string();
        make_room();
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
                base.positions + block.positions.size(), base.uvs + block.uvs.size(),
                base.normals + block.normals.size(),     base.faces + block.faces.count,
                base.corners + block.faces.v.size(),     base.lines + block.lines};
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

    static bool any(const std::vector<ObjBlock>& blocks, std::vector<ObjIndex> ObjElements::*list) {
        return std::any_of(blocks.begin(), blocks.end(),
                           [&](const ObjBlock& block) { return !(block.faces.*list).empty(); });
    }

    // Some exporters name texture coordinates or normals that they do not write: faces then have
    // none.
    void drop_unmet(std::vector<ObjIndex> ObjElements::*list, const char* what) {
        std::uint64_t corners = 0;
        std::size_t first_line = 0;
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            std::vector<ObjIndex>& indices = blocks_[b].faces.*list;
            for (std::size_t c = 0; c < indices.size(); ++c) {
                if (indices[c] == 0) continue;
                if (++corners == 1) first_line = line_of(b, blocks_[b].faces.line_of_corner(c));
            }
            indices.clear();
        }
        warn_of(corners, first_line,
                std::string("corners name ") + what + ", of which the file has none: left out");
    }

    // All lists at their full size. Memory is first touched here: each list on a thread of its own.
    void make_room() {
        const Counts& total = bases_.back();
        if (total.uvs == 0) drop_unmet(&ObjElements::t, "texture coordinates");
        if (total.normals == 0) drop_unmet(&ObjElements::n, "normals");
        const bool uv = any(blocks_, &ObjElements::t), normals = any(blocks_, &ObjElements::n);
        if (uv) mesh_->uvs.resize(1);
        parallel_blocks(7, 1, options_.threads, [&](std::size_t list, std::size_t) {
            if (list == 0) mesh_->corner_vertices.resize(total.corners);
            if (list == 1 && uv) mesh_->uvs[0].indices.resize(total.corners);
            if (list == 2 && normals) mesh_->normals.indices.resize(total.corners);
            if (list == 3) mesh_->positions.resize(total.positions);
            if (list == 4) mesh_->face_offsets.resize(total.faces + 1);
            if (list == 5 && uv) mesh_->uvs[0].values.resize(total.uvs);
            if (list == 6 && normals) mesh_->normals.values.resize(total.normals);
        });
    }

    void vertices() {
        mesh_->origin = origin_;
        const bool uv = !mesh_->uvs.empty(), normals = !mesh_->normals.indices.empty();
        parallel_blocks(blocks_.size(), 1, options_.threads, [&](std::size_t b, std::size_t) {
            const ObjBlock& block = blocks_[b];
            const Counts& base = bases_[b];
            std::copy(block.positions.begin(), block.positions.end(),
                      mesh_->positions.begin() + std::ptrdiff_t(base.positions));
            if (uv)
                std::copy(block.uvs.begin(), block.uvs.end(),
                          mesh_->uvs[0].values.begin() + std::ptrdiff_t(base.uvs));
            if (normals)
                std::copy(block.normals.begin(), block.normals.end(),
                          mesh_->normals.values.begin() + std::ptrdiff_t(base.normals));
        });
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

    // One block's indices of one kind, absent ones (an empty list) included. Returns the first
    // corner whose index is out of range, or their number.
    static std::size_t resolve_list(const std::vector<ObjIndex>& from, bool relative,
                                    std::size_t base, std::size_t total, std::size_t corners,
                                    Index* to) {
        if (from.empty()) {
            std::fill(to, to + corners, no_index);
            return corners;
        }
        if (!relative) {
            // 0 becomes no_index by itself; it is over any total, so that it needs the second look.
            bool doubtful = false;
            for (std::size_t c = 0; c < corners; ++c) {
                to[c] = Index(from[c]) - 1;
                doubtful |= to[c] >= total;
            }
            if (!doubtful) return corners;
        }
        for (std::size_t c = 0; c < corners; ++c)
            if (!resolve(from[c], base, total, to[c])) return c;
        return corners;
    }

    Error out_of_range(std::size_t block, const ObjElements& elements, std::size_t corner,
                       const char* what, ObjIndex raw, std::size_t base, std::size_t total) const {
        const std::size_t line = line_of(block, elements.line_of_corner(corner));
        if (raw < 0) {  // counts back from its line on: it can only reach too far
            const std::int64_t first = std::int64_t(base) - (std::int64_t(raw) + relative_bias) + 1;
            return error_at(line, std::string("relative ") + what + " index reaches " +
                                      std::to_string(1 - first) + " before the first " + what +
                                      "; " + std::to_string(total) + " are in the file");
        }
        return error_at(line, std::string(what) + " index " + std::to_string(raw) +
                                  " is out of range: the file has " + std::to_string(total));
    }

    Result<void> faces() {
        const Counts& total = bases_.back();
        std::vector<std::optional<Error>> bad(blocks_.size());
        parallel_blocks(blocks_.size(), 1, options_.threads, [&](std::size_t b, std::size_t) {
            const ObjElements& faces = blocks_[b].faces;
            const Counts& base = bases_[b];
            Index end = Index(base.corners);
            Index* offset = mesh_->face_offsets.data() + base.faces + 1;
            for (std::size_t r = 0; r < faces.sizes.size(); ++r) {
                const Index until =
                    r + 1 < faces.sizes.size() ? faces.sizes[r + 1].element : faces.count;
                for (Index f = faces.sizes[r].element; f < until; ++f)
                    *offset++ = end += faces.sizes[r].value;
            }
            const std::size_t corners = faces.v.size();
            std::size_t first = corners;
            const auto take = [&](const std::vector<ObjIndex>& from, std::vector<Index>& to,
                                  std::size_t local, std::size_t all, const char* what) {
                if (to.empty()) return;
                const std::size_t c = resolve_list(from, faces.relative, local, all, corners,
                                                   to.data() + base.corners);
                if (c >= first) return;  // the file's first error is the one to name
                first = c;
                bad[b] = out_of_range(b, faces, c, what, from[c], local, all);
            };
            take(faces.v, mesh_->corner_vertices, base.positions, total.positions, "vertex");
            if (!mesh_->uvs.empty())
                take(faces.t, mesh_->uvs[0].indices, base.uvs, total.uvs, "texture coordinate");
            take(faces.n, mesh_->normals.indices, base.normals, total.normals, "normal");
        });
        for (std::optional<Error>& first : bad)
            if (first) return std::move(*first);
        return {};
    }

    Result<void> polylines() {
        const std::size_t total = bases_.back().positions;
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            for (const bool lines : {true, false}) {
                const ObjElements& elements = lines ? blocks_[b].polylines : blocks_[b].points;
                for (std::size_t c = 0; c < elements.v.size(); ++c) {
                    Index v = no_index;
                    if (!resolve(elements.v[c], bases_[b].positions, total, v))
                        return out_of_range(b, elements, c, "vertex", elements.v[c],
                                            bases_[b].positions, total);
                    (lines ? mesh_->line_vertices : mesh_->points).push_back(v);
                }
                if (!lines) continue;
                for (std::size_t r = 0; r < elements.sizes.size(); ++r) {
                    const Index until = r + 1 < elements.sizes.size()
                                            ? elements.sizes[r + 1].element
                                            : elements.count;
                    for (Index l = elements.sizes[r].element; l < until; ++l)
                        mesh_->line_offsets.push_back(mesh_->line_offsets.back() +
                                                      elements.sizes[r].value);
                }
            }
        }
        if (is_cloud()) {
            mesh_->points.resize(total);
            std::iota(mesh_->points.begin(), mesh_->points.end(), Index(0));
            const bool uvs = bases_.back().uvs > 0, normals = bases_.back().normals > 0;
            if (uvs || normals)
                scene_.warnings.push_back(options_.name + values_of_points_left_out(normals, uvs));
        }
        return {};
    }

    // Vertices alone, as scanners' programs write them: not those of curves or of broken faces.
    bool is_cloud() const {
        return mesh_->corner_vertices.empty() && mesh_->line_vertices.empty() &&
               mesh_->points.empty() &&
               std::all_of(blocks_.begin(), blocks_.end(), [](const ObjBlock& block) {
                   return block.free_form.count == 0 && block.short_faces.count == 0;
               });
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
        // Groups without a name say nothing either.
        if (mesh_->parts.size() == 1 && mesh_->parts[0].empty()) {
            mesh_->parts.clear();
            mesh_->face_parts.clear();
        }
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

    // A name may hold a #; one that only exists without what looks like a comment is meant so.
    Index material_named(const std::string& whole) {
        std::string name = whole;
        if (!materials_.contains(name)) {
            const std::string before = before_comment(whole);
            if (!before.empty() && materials_.contains(before)) name = before;
        }
        const auto [it, added] = materials_.emplace(name, Index(scene_.materials.size()));
        if (added) {
            scene_.materials.emplace_back();
            scene_.materials.back().name = name;
            if (options_.read_materials && !missing_library_)
                warn_named("material '" + name + "' is in no library: the default look is used");
        }
        return it->second;
    }

    void libraries(const std::string& whole) {
        if (!options_.read_materials) return;
        // One file name with blanks, or several names: what exists decides.
        if (library(whole)) return;
        const std::string names = before_comment(whole);
        if (names != whole && library(names)) return;
        LineScanner words(names);
        bool several = false;
        while (!words.at_end()) {
            const std::string word(words.word());
            if (word == names) break;
            several = true;
            if (!library(word)) missing(word);
        }
        if (!several) missing(names);
    }

    void missing(const std::string& name) {
        missing_library_ = scene_.library_missing = true;
        warn_named("material library '" + name +
                   "' cannot be read: its materials get the default look");
    }

    static bool is_utf16(std::span<const std::byte> bytes) {
        return bytes.size() > 1 && ((bytes[0] == std::byte{0xff} && bytes[1] == std::byte{0xfe}) ||
                                    (bytes[0] == std::byte{0xfe} && bytes[1] == std::byte{0xff}));
    }

    bool library(const std::string& name) {
        const auto path = files_.locate(name);
        if (!path) return false;
        // Exporters name the same library with each object.
        std::error_code ignored;
        const std::filesystem::path file = std::filesystem::weakly_canonical(*path, ignored);
        if (!libraries_read_.insert(file.native()).second) return true;
        const auto bytes = read_file(*path);
        if (!bytes) return false;
        scene_.libraries.push_back(*path);
        if (is_utf16(*bytes)) {
            missing_library_ = true;
            scene_.warnings.push_back("material library '" + name +
                                      "' is in UTF-16, which is not read: save it as UTF-8; its "
                                      "materials get the default look");
            return true;
        }
        PictureSearch pictures(path->parent_path(), options_.texture_directories);
        MtlLibrary lib = parse_mtl({reinterpret_cast<const char*>(bytes->data()), bytes->size()},
                                   name, pictures);
        const Index textures = Index(scene_.textures.size()), images = Index(scene_.images.size());
        for (Texture& t : lib.textures) {
            t.image += images;
            scene_.textures.push_back(t);
        }
        for (ImageRef& image : lib.images) scene_.images.push_back(std::move(image));
        for (Material& m : lib.materials) {
            for (const MaterialMap& map : material_maps)
                if (TextureRef& ref = m.*map.ref) ref.texture += textures;
            scene_.materials.push_back(std::move(m));
        }
        for (std::string& w : lib.warnings) scene_.warnings.push_back(std::move(w));
        pictures.tell(scene_);
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

    // Some programs' colours of vertices; others have none above 1, or such as are no bytes.
    static bool are_bytes(const std::vector<glm::vec4>& colors) {
        bool above = false;
        for (const glm::vec4& c : colors)
            for (int k = 0; k < 3 && c != no_color; ++k) {
                if (!(c[k] >= 0 && c[k] <= 255 && c[k] == std::floor(c[k]))) return false;
                above |= c[k] > 1;
            }
        return above;
    }

    void colors() {
        const bool any = std::any_of(blocks_.begin(), blocks_.end(),
                                     [](const ObjBlock& b) { return !b.colors.empty(); });
        if (!any) return;
        std::vector<glm::vec4> values(bases_.back().positions, no_color);
        for (std::size_t b = 0; b < blocks_.size(); ++b)
            std::copy(blocks_[b].colors.begin(), blocks_[b].colors.end(),
                      values.begin() + std::ptrdiff_t(bases_[b].positions));
        if (are_bytes(values)) {
            for (glm::vec4& c : values)
                if (c != no_color) c = glm::vec4(glm::vec3(c) / 255.0f, c.a);
            scene_.warnings.push_back(options_.name +
                                      ": the colours are of 0 to 255: taken for that of 1");
        }
        for (glm::vec4& c : values) c.a = 1;
        const bool faces = mesh_->corner_count() > 0;
        if (!faces || !mesh_->line_vertices.empty() || !mesh_->points.empty())
            mesh_->vertex_colors = values;
        if (!faces) return;
        mesh_->colors.emplace_back();
        mesh_->colors[0].indices = mesh_->corner_vertices;
        mesh_->colors[0].values = std::move(values);
    }

    // A file of nonsense must not flood the report: a dozen of these, and how many more there are.
    void warn_named(std::string text) {
        if (++named_warnings_ <= most_named) scene_.warnings.push_back(std::move(text));
    }

    void warn(ObjOddity ObjBlock::*oddity, const std::string& text) {
        std::uint64_t count = 0;
        std::size_t line = 0;
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            const ObjOddity& here = blocks_[b].*oddity;
            if (count == 0 && here.count > 0) line = line_of(b, here.first_line);
            count += here.count;
        }
        warn_of(count, line, text);
    }

    void warn_of(std::uint64_t count, std::size_t first_line, const std::string& text) {
        if (count > 0)
            scene_.warnings.push_back(options_.name + ":" + std::to_string(first_line) + ": " +
                                      text + " (" + std::to_string(count) + " in all)");
    }

    void warnings() {
        files_.tell(scene_);
        if (named_warnings_ > most_named)
            scene_.warnings.push_back("and " + std::to_string(named_warnings_ - most_named) +
                                      " more materials or libraries like these");
        std::string word;
        bool any_material = false;
        for (ObjBlock& block : blocks_) {
            if (word.empty()) word = block.unknown_word;
            // Of the material that an earlier block ended with.
            if (any_material && block.loose_before.count > 0)
                block.loose_materials = {block.loose_before.count + block.loose_materials.count,
                                         block.loose_before.first_line};
            any_material |= block.any_material;
        }
        warn(&ObjBlock::short_faces, "elements with too few corners were dropped");
        warn(&ObjBlock::free_form, "free-form geometry is not supported and was skipped");
        warn(&ObjBlock::unknown, "unknown statement " + word + " was skipped");
        warn(&ObjBlock::non_finite, "coordinates that are not finite");
        warn(&ObjBlock::third_uvs,
             "texture coordinates have two values here: the third was left out");
        warn(&ObjBlock::loose_uvs, "lines and points have no texture coordinates here: left out");
        warn(&ObjBlock::loose_materials, "lines and points have no material here: left out");
    }

    std::vector<ObjBlock> blocks_;
    glm::dvec3 origin_;
    const ObjOptions& options_;
    std::vector<Counts> bases_;
    Scene scene_;
    Mesh* mesh_ = nullptr;
    std::unordered_map<std::string, Index> materials_, parts_;
    PictureSearch files_{options_.directory};
    std::set<std::string> libraries_read_;
    bool missing_library_ = false;
    static constexpr std::size_t most_named = 12;
    std::size_t named_warnings_ = 0;
};

// A zero byte in one of the first two characters, or the byte order mark that says it.
bool is_utf16(const ObjSource& source) {
    char text[2];
    if (source.size() < 2 || !source.read(0, 2, text)) return false;
    const std::string_view mark(text, 2);
    return text[0] == '\0' || text[1] == '\0' || mark == "\xff\xfe" || mark == "\xfe\xff";
}

// The text of a source whose lines end with carriage returns alone, with line feeds; empty for all
// others, and where it cannot be read.
std::string mended_line_ends(const ObjSource& source) {
    std::string text(std::min(source.size(), line_end_head), '\0');
    if (!source.read(0, text.size(), text.data()) || !ends_lines_with_cr(text)) return {};
    text.resize(source.size());
    if (!source.read(0, text.size(), text.data())) return {};
    return with_line_feeds(text);
}

Result<Scene> read_obj(const ObjSource& source, const ObjOptions& options) {
    if (const std::string text = mended_line_ends(source); !text.empty())
        return read_obj(ObjMemory(text), options);
    if (is_utf16(source))
        return Error{ErrorCode::syntax,
                     "this is UTF-16 or no text; expected OBJ as ASCII or UTF-8: save it so",
                     options.name + ":1"};
    auto blocks = parse_obj_blocks(source, options.name, options.threads);
    if (!blocks) return std::move(blocks).error();
    PositionBounds bounds;
    for (const ObjBlock& block : *blocks) bounds.add(block.bounds);
    const glm::dvec3 origin = bounds.origin();
    if (origin != glm::dvec3(0.0)) {
        // Far from zero, which is rare: once more, now with the place that floats are about. To
        // keep every coordinate in double until that is known would cost all other files more.
        blocks = parse_obj_blocks(source, options.name, options.threads, origin);
        if (!blocks) return std::move(blocks).error();
    }
    return Assembler(*std::move(blocks), origin, options).run();
}

}  // namespace

Result<Scene> parse_obj(std::span<const std::byte> bytes, const ObjOptions& options) {
    return read_obj(ObjMemory({reinterpret_cast<const char*>(bytes.data()), bytes.size()}),
                    options);
}

Result<Scene> load_obj(const std::filesystem::path& path, const LoadOptions& load) {
    ObjFile file;
    if (auto opened = file.open(path); !opened) return std::move(opened).error();
    ObjOptions options;
    options.name = path.filename().string();
    options.directory = path.parent_path();
    options.threads = load.threads;
    options.texture_directories = load.texture_directories;
    auto scene = read_obj(file, options);
    if (scene) scene->source = path;
    return scene;
}

}  // namespace prep
