#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_files.h"
#include "formats/obj/mtl_writer.h"
#include "formats/writers.h"
#include "model/origin.h"
#include "prep/formats.h"
#include "text/blocks.h"
#include "text/note_once.h"
#include "text/numbers.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

char* write_floats(char* to, const float* values, int count) {
    for (int k = 0; k < count; ++k) {
        *to++ = ' ';
        to = write_float(to, values[k]);
    }
    return to;
}

class ObjWriter {
  public:
    ObjWriter(const PreparedScene& prepared, const std::filesystem::path& path,
              const SaveOptions& options)
        : scene_(prepared.scene),
          path_(path),
          // Those of other formats hold no materials of OBJ.
          keep_libraries_(options.replace_sources && !scene_.libraries.empty() &&
                          lower_ending(scene_.name) == ".obj"),
          text_(options.threads),
          files_(rules_for(prepared, path, options)),
          materials_(scene_, path_, files_, notes_) {}

    WriteResult run() {
        text_.text() = "# meshprep\n";
        std::string mtl;
        if (!scene_.materials.empty()) {
            if (!keep_libraries_) {
                auto library = materials_.text();
                if (!library) return std::move(library).error();
                mtl = *std::move(library);
            }
            for (const std::string& name : libraries())
                text_.text() += fmt::format("mtllib {}\n", name);
        }
        const std::vector<glm::dmat4> world = world_transforms(scene_);
        bool instanced = false;
        for (const Node& node : scene_.nodes) {
            if (node.mesh == no_index) continue;
            ++meshes_;
            const std::string name = statement_name(scene_.meshes[node.mesh].name);
            if (!name.empty()) object_names_.keep_free(name);
        }
        std::vector<bool> seen(scene_.meshes.size(), false);
        for (std::size_t n = 0; n < scene_.nodes.size(); ++n) {
            const Index m = scene_.nodes[n].mesh;
            if (m == no_index) continue;
            instanced |= seen[m];
            seen[m] = true;
            if (meshes_ > 1) name_object(scene_.meshes[m], scene_.nodes[n]);
            write_mesh(scene_.meshes[m], world[n]);
        }
        if (instanced) note("OBJ has no instances: meshes used twice are written twice");
        if (!mtl.empty()) {
            const std::filesystem::path library = path_.parent_path() / materials_.library_name();
            if (auto done = files_.add(library, std::as_bytes(std::span(mtl))); !done)
                return std::move(done).error();
        }
        if (auto done = files_.add(path_, text_.parts()); !done) return std::move(done).error();
        if (auto done = files_.commit(); !done) return std::move(done).error();
        return std::move(notes_);
    }

  private:
    static constexpr std::uint64_t unused = ~std::uint64_t(0);

    void note(const std::string& text) { note_once(notes_, text); }

    // Of several meshes each is an object, and each time that it is there.
    void name_object(const Mesh& mesh, const Node& node) {
        std::string name = statement_name(mesh.name);
        if (name != mesh.name) note(changed_names);
        const bool own = !name.empty();
        if (!own) name = statement_name(node.name);
        mesh_object_ = object_names_.unique(name.empty() ? "mesh" : name, own);
        if (!name.empty() && mesh_object_ != name)
            note("OBJ tells objects apart by name: equal ones got a number");
    }

    void write_mesh(const Mesh& mesh, const glm::dmat4& world) {
        if (!mesh.tangents.empty()) note("OBJ holds no tangents: left out");
        if (std::count_if(mesh.uvs.begin(), mesh.uvs.end(),
                          [](const auto& set) { return !set.empty(); }) > 1)
            note("OBJ holds one UV set: the others are left out");
        if (mesh.colors.size() > 1) note("OBJ holds one set of colours: the others are left out");
        const glm::dmat3 linear(world);
        mirrored_ = mirrors(linear);
        const bool moved = world != glm::dmat4(1.0) || mesh.origin != glm::dvec3(0.0) ||
                           may_be_far(mesh.positions);
        const std::vector<glm::vec4> colors = vertex_colors(mesh);
        text_.short_lines(mesh.vertex_count(), 8 * max_number_text, [&](char* to, std::size_t v) {
            *to++ = 'v';
            if (moved) {
                const glm::dvec3 p(world *
                                   glm::dvec4(glm::dvec3(mesh.positions[v]) + mesh.origin, 1.0));
                for (int k = 0; k < 3; ++k) {
                    *to++ = ' ';
                    to = write_double(to, p[k]);
                }
            } else {
                to = write_floats(to, &mesh.positions[v].x, 3);
            }
            if (!colors.empty()) to = write_floats(to, &colors[v].x, 3);
            *to++ = '\n';
            return to;
        });
        const bool normals = !mesh.normals.empty();
        const std::vector<std::uint64_t> uv_bases = number_uvs(mesh);
        for (std::size_t set = 0; set < uv_bases.size(); ++set) {
            if (uv_bases[set] == unused) continue;
            text_.short_lines(mesh.uvs[set].values.size(), 4 * max_number_text,
                              [&](char* to, std::size_t i) {
                                  const glm::vec2& t = mesh.uvs[set].values[i];
                                  *to++ = 'v';
                                  *to++ = 't';
                                  to = write_floats(to, &t.x, 1);
                                  *to++ = ' ';
                                  // The origin moves from the top left to the bottom left.
                                  to = write_flipped(to, t.y);
                                  *to++ = '\n';
                                  return to;
                              });
        }
        if (normals) {
            const glm::dmat3 to_world = normal_matrix(linear);
            const bool turned = linear != glm::dmat3(1.0);
            text_.short_lines(mesh.normals.values.size(), 4 * max_number_text,
                              [&](char* to, std::size_t i) {
                                  glm::vec3 n = mesh.normals.values[i];
                                  if (turned) {
                                      const glm::dvec3 t = to_world * glm::dvec3(n);
                                      const double length = glm::length(t);
                                      if (length > 0) n = glm::vec3(t / length);
                                  }
                                  *to++ = 'v';
                                  *to++ = 'n';
                                  to = write_floats(to, &n.x, 3);
                                  *to++ = '\n';
                                  return to;
                              });
        }
        loose(mesh);
        faces(mesh, uv_bases, normals);
        tags(mesh);
        vertex_base_ += mesh.vertex_count();
        if (normals) normal_base_ += mesh.normals.values.size();
        face_base_ += mesh.face_count();
    }

    // Before the mesh's faces: what states those leave behind is not theirs.
    void loose(const Mesh& mesh) {
        if (mesh.line_vertices.empty() && mesh.points.empty()) return;
        state(mesh, no_index, no_index);
        for (std::size_t l = 0; l + 1 < mesh.line_offsets.size(); ++l) {
            text_.text() += 'l';
            for (Index k = mesh.line_offsets[l]; k < mesh.line_offsets[l + 1]; ++k)
                text_.text() += fmt::format(" {}", vertex_base_ + mesh.line_vertices[k] + 1);
            text_.text() += '\n';
        }
        for (const Index v : mesh.points)
            text_.text() += fmt::format("p {}\n", vertex_base_ + v + 1);
    }

    // Of what follows.
    void state(const Mesh& mesh, Index of_part, Index material) {
        part(mesh, of_part);
        if (material != material_)
            text_.text() += fmt::format("usemtl {}\n", materials_.name(material));
        material_ = material;
    }

    // Of the faces with the material; no_index where they lack the set that its maps read: with
    // another the maps would be seen.
    Index uv_set(const Mesh& mesh, Index material) {
        const Index set = materials_.uv_set(material);
        if (set < mesh.uvs.size() && !mesh.uvs[set].empty()) return set;
        const auto there = std::find_if(mesh.uvs.begin(), mesh.uvs.end(),
                                        [](const auto& layer) { return !layer.empty(); });
        if (there == mesh.uvs.end()) return no_index;
        if (set == no_index) return Index(there - mesh.uvs.begin());
        note("faces without the UV set that their material's maps read are written without UVs");
        return no_index;
    }

    // Where each set's values begin in the file, where faces have it.
    std::vector<std::uint64_t> number_uvs(const Mesh& mesh) {
        std::vector<std::uint64_t> bases(mesh.uvs.size(), unused);
        if (bases.empty()) return bases;
        const auto use = [&](Index set) {
            if (set != no_index) bases[set] = 0;
        };
        if (mesh.face_materials.empty()) use(uv_set(mesh, no_index));
        for (const Index m : mesh.face_materials) use(uv_set(mesh, m));
        for (std::size_t set = 0; set < bases.size(); ++set) {
            if (mesh.uvs[set].empty()) bases[set] = unused;
            if (bases[set] == unused) continue;
            bases[set] = uv_base_;
            uv_base_ += mesh.uvs[set].values.size();
        }
        return bases;
    }

    std::vector<glm::vec4> vertex_colors(const Mesh& mesh) {
        const bool of_corners = !mesh.colors.empty() && !mesh.colors[0].empty();
        if (mesh.vertex_colors.empty() && !of_corners) return {};
        std::vector<glm::vec4> colors = mesh.vertex_colors;
        colors.resize(mesh.vertex_count(), glm::vec4(1.0f));
        bool differ = false;
        bool alpha =
            std::any_of(colors.begin(), colors.end(), [](const glm::vec4& c) { return c.a != 1; });
        std::vector<bool> set(mesh.vertex_count(), false);
        for (std::size_t c = 0; of_corners && c < mesh.corner_count(); ++c) {
            const Index i = mesh.colors[0].indices[c], v = mesh.corner_vertices[c];
            if (i == no_index) continue;
            differ |= set[v] && colors[v] != mesh.colors[0].values[i];
            alpha |= mesh.colors[0].values[i].a != 1;
            colors[v] = mesh.colors[0].values[i];
            set[v] = true;
        }
        if (differ) note("OBJ holds one colour per vertex: corners that differ lost theirs");
        if (alpha) note("OBJ holds colours without alpha: left out");
        return colors;
    }

    // State lines stand where the state changes; runs of faces between them are formatted together.
    void faces(const Mesh& mesh, const std::vector<std::uint64_t>& uv_bases, bool normals) {
        const auto value = [](const std::vector<Index>& list, std::size_t f, Index otherwise) {
            return list.empty() ? otherwise : list[f];
        };
        for (std::size_t f = 0; f < mesh.face_count();) {
            const Index p = value(mesh.face_parts, f, no_index);
            const Index m = value(mesh.face_materials, f, no_index);
            const Index s = value(mesh.face_smoothing, f, 0);
            state(mesh, p, m);
            if (s != smoothing_)
                text_.text() += s ? fmt::format("s {}\n", s) : std::string("s off\n");
            smoothing_ = s;
            std::size_t end = f + 1;
            while (end < mesh.face_count() && value(mesh.face_parts, end, no_index) == p &&
                   value(mesh.face_materials, end, no_index) == m &&
                   value(mesh.face_smoothing, end, 0) == s)
                ++end;
            const Index set = uv_set(mesh, m);
            const FaceUvs uvs = set < uv_bases.size() && uv_bases[set] != unused
                                    ? FaceUvs{&mesh.uvs[set], uv_bases[set]}
                                    : FaceUvs{};
            // A corner is three indices of at most 20 digits, and what stands between them.
            text_.lines(
                end - f,
                [&](std::size_t from, std::size_t to) {
                    return (to - from) * 2 +
                           (mesh.face_offsets[f + to] - mesh.face_offsets[f + from]) *
                               std::size_t(64);
                },
                [&](char* to, std::size_t i) { return face(mesh, f + i, uvs, normals, to); });
            f = end;
        }
    }

    // What the reader joins as "object/group" is taken apart again.
    void part(const Mesh& mesh, Index p) {
        std::string object, group = p < mesh.parts.size() ? statement_name(mesh.parts[p]) : "";
        if (p < mesh.parts.size() && group != mesh.parts[p]) note(changed_names);
        if (meshes_ > 1) {
            object = mesh_object_;
        } else {
            const std::size_t slash = group.find('/');
            object = group.substr(0, slash);
            group.erase(0, slash == std::string::npos ? group.size() : slash + 1);
        }
        if (object != object_) {
            text_.text() += fmt::format("o {}\n", object);
            group_.clear();
        }
        if (group != group_) text_.text() += fmt::format("g {}\n", group);
        object_ = object;
        group_ = group;
    }

    struct FaceUvs {
        const CornerLayer<glm::vec2>* set = nullptr;
        std::uint64_t base = 0;
    };

    char* face(const Mesh& mesh, std::size_t f, const FaceUvs& uvs, bool normals, char* to) const {
        *to++ = 'f';
        const Index begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        for (Index k = begin; k < end; ++k) {
            // A mirror turns the winding: the front stays the front.
            const Index c = mirrored_ && k > begin ? begin + end - k : k;
            *to++ = ' ';
            to = write_integer(to, vertex_base_ + mesh.corner_vertices[c] + 1);
            const Index t = uvs.set ? uvs.set->indices[c] : no_index;
            const Index n = normals ? mesh.normals.indices[c] : no_index;
            if (t != no_index) {
                *to++ = '/';
                to = write_integer(to, uvs.base + t + 1);
            }
            if (n != no_index) {
                *to++ = '/';
                if (t == no_index) *to++ = '/';
                to = write_integer(to, normal_base_ + n + 1);
            }
        }
        *to++ = '\n';
        return to;
    }

    void tags(const Mesh& mesh) {
        const SubdivisionTags& tags = mesh.subdivision;
        for (const EdgeMark& e : tags.creases)
            text_.text() += fmt::format("t crease 2/1/0 {} {} {}\n", vertex_base_ + e.v0,
                                        vertex_base_ + e.v1, e.sharpness);
        for (const VertexMark& v : tags.corners)
            text_.text() +=
                fmt::format("t corner 1/1/0 {} {}\n", vertex_base_ + v.vertex, v.sharpness);
        for (const Index f : tags.holes)
            text_.text() += fmt::format("t hole 1/0/0 {}\n", face_base_ + f);
        if (tags.interpolate_boundary != SubdivisionTags{}.interpolate_boundary)
            text_.text() +=
                fmt::format("t interpolateboundary 1/0/0 {}\n", tags.interpolate_boundary);
        if (tags.face_varying_boundary != SubdivisionTags{}.face_varying_boundary)
            text_.text() += fmt::format("t facevaryinginterpolateboundary 1/0/0 {}\n",
                                        tags.face_varying_boundary);
    }

    // Written in place, a mesh goes on using the libraries it was read with, which say more than
    // what would be written again.
    std::vector<std::string> libraries() const {
        if (!keep_libraries_) return {materials_.library_name()};
        std::vector<std::string> names;
        for (const std::filesystem::path& library : scene_.libraries)
            names.push_back(path_from(path_, library));
        return names;
    }

    const Scene& scene_;
    const std::filesystem::path& path_;
    const bool keep_libraries_;
    TextBlocks text_;
    std::vector<std::string> notes_;
    FileSet files_;
    MtlWriter materials_;
    // The state that the lines written so far leave a reader in.
    std::string object_, group_;
    std::string mesh_object_;  // of the mesh being written, where there are several
    UniqueNames object_names_;
    Index material_ = no_index, smoothing_ = 0;
    std::size_t meshes_ = 0;
    bool mirrored_ = false;  // the mesh being written
    std::uint64_t vertex_base_ = 0, uv_base_ = 0, normal_base_ = 0, face_base_ = 0;
};

}  // namespace

WriteResult write_obj(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options) {
    return ObjWriter(prepared, path, options).run();
}

}  // namespace prep::detail
