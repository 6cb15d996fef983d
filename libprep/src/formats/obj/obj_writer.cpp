#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "base/atomic_files.h"
#include "formats/writers.h"
#include "text/blocks.h"
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

std::string one_word(std::string name) {
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return name;
}

class ObjWriter {
  public:
    ObjWriter(const PreparedScene& prepared, const std::filesystem::path& path,
              const SaveOptions& options)
        : scene_(prepared.scene), path_(path), files_(rules_for(prepared, path, options)) {}

    WriteResult run() {
        text_.text() = "# meshprep\n";
        std::string mtl;
        if (!scene_.materials.empty()) {
            name_materials();
            mtl = materials();
            text_.text() += fmt::format("mtllib {}.mtl\n", path_.stem().string());
        }
        const std::vector<glm::dmat4> world = world_transforms(scene_);
        bool instanced = false, extra = false;
        for (const Node& node : scene_.nodes) meshes_ += node.mesh != no_index;
        std::vector<bool> seen(scene_.meshes.size(), false);
        for (std::size_t n = 0; n < scene_.nodes.size(); ++n) {
            extra |= scene_.nodes[n].camera != no_index || scene_.nodes[n].light != no_index ||
                     scene_.nodes[n].skin != no_index;
            const Index m = scene_.nodes[n].mesh;
            if (m == no_index) continue;
            instanced |= seen[m];
            seen[m] = true;
            write_mesh(scene_.meshes[m], world[n]);
        }
        if (instanced) note("OBJ has no instances: meshes used twice are written twice");
        if (extra) note("OBJ holds no cameras, lights or skins: left out");
        if (!mtl.empty()) {
            std::filesystem::path mtl_path = path_;
            mtl_path.replace_extension(".mtl");
            if (auto done = files_.add(mtl_path, std::as_bytes(std::span(mtl))); !done)
                return std::move(done).error();
        }
        if (failure_) return std::move(*failure_);
        if (auto done = files_.add(path_, text_.parts()); !done) return std::move(done).error();
        if (auto done = files_.commit(); !done) return std::move(done).error();
        return std::move(notes_);
    }

  private:
    void note(const std::string& text) {
        if (std::find(notes_.begin(), notes_.end(), text) == notes_.end()) notes_.push_back(text);
    }

    void write_mesh(const Mesh& mesh, const glm::dmat4& world) {
        if (!mesh.tangents.empty()) note("OBJ holds no tangents: left out");
        if (mesh.uvs.size() > 1) note("OBJ holds one UV set: the others are left out");
        if (mesh.colors.size() > 1) note("OBJ holds one set of colours: the others are left out");
        const glm::dmat3 linear(world);
        mirrored_ = glm::determinant(linear) < 0;
        const bool moved = world != glm::dmat4(1.0) || mesh.origin != glm::dvec3(0.0);
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
        const bool uv = !mesh.uvs.empty() && !mesh.uvs[0].empty(), normals = !mesh.normals.empty();
        if (uv)
            text_.short_lines(mesh.uvs[0].values.size(), 4 * max_number_text,
                              [&](char* to, std::size_t i) {
                                  const glm::vec2& t = mesh.uvs[0].values[i];
                                  *to++ = 'v';
                                  *to++ = 't';
                                  to = write_floats(to, &t.x, 1);
                                  *to++ = ' ';
                                  // The origin moves from the top left to the bottom left.
                                  to = write_flipped(to, t.y);
                                  *to++ = '\n';
                                  return to;
                              });
        if (normals) {
            const double sign = mirrored_ ? -1 : 1;
            const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]),
                                      glm::cross(linear[2], linear[0]),
                                      glm::cross(linear[0], linear[1]));
            const bool turned = linear != glm::dmat3(1.0);
            text_.short_lines(mesh.normals.values.size(), 4 * max_number_text,
                              [&](char* to, std::size_t i) {
                                  glm::vec3 n = mesh.normals.values[i];
                                  if (turned) {
                                      const glm::dvec3 t = cofactor * glm::dvec3(n) * sign;
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
        faces(mesh, uv, normals);
        for (std::size_t l = 0; l + 1 < mesh.line_offsets.size(); ++l) {
            text_.text() += 'l';
            for (Index k = mesh.line_offsets[l]; k < mesh.line_offsets[l + 1]; ++k)
                text_.text() += fmt::format(" {}", vertex_base_ + mesh.line_vertices[k] + 1);
            text_.text() += '\n';
        }
        for (const Index v : mesh.points)
            text_.text() += fmt::format("p {}\n", vertex_base_ + v + 1);
        tags(mesh);
        vertex_base_ += mesh.vertex_count();
        if (uv) uv_base_ += mesh.uvs[0].values.size();
        if (normals) normal_base_ += mesh.normals.values.size();
        face_base_ += mesh.face_count();
    }

    std::vector<glm::vec4> vertex_colors(const Mesh& mesh) {
        if (!mesh.vertex_colors.empty()) {
            for (const glm::vec4& c : mesh.vertex_colors)
                if (c.a != 1) note("OBJ holds colours without alpha: left out");
            return mesh.vertex_colors;
        }
        if (mesh.colors.empty() || mesh.colors[0].empty()) return {};
        std::vector<glm::vec4> colors(mesh.vertex_count(), glm::vec4(1.0f));
        bool differ = false, alpha = false;
        std::vector<bool> set(mesh.vertex_count(), false);
        for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
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
    void faces(const Mesh& mesh, bool uv, bool normals) {
        const auto value = [](const std::vector<Index>& list, std::size_t f, Index otherwise) {
            return list.empty() ? otherwise : list[f];
        };
        for (std::size_t f = 0; f < mesh.face_count();) {
            const Index p = value(mesh.face_parts, f, no_index);
            const Index m = value(mesh.face_materials, f, no_index);
            const Index s = value(mesh.face_smoothing, f, 0);
            part(mesh, p);
            if (m != material_)
                text_.text() += fmt::format("usemtl {}\n", m < scene_.materials.size()
                                                               ? material_name(m)
                                                               : std::string("default"));
            if (s != smoothing_)
                text_.text() += s ? fmt::format("s {}\n", s) : std::string("s off\n");
            material_ = m;
            smoothing_ = s;
            std::size_t end = f + 1;
            while (end < mesh.face_count() && value(mesh.face_parts, end, no_index) == p &&
                   value(mesh.face_materials, end, no_index) == m &&
                   value(mesh.face_smoothing, end, 0) == s)
                ++end;
            // A corner is three indices of at most 20 digits, and what stands between them.
            text_.lines(
                end - f,
                [&](std::size_t from, std::size_t to) {
                    return (to - from) * 2 +
                           (mesh.face_offsets[f + to] - mesh.face_offsets[f + from]) *
                               std::size_t(64);
                },
                [&](char* to, std::size_t i) { return face(mesh, f + i, uv, normals, to); });
            f = end;
        }
    }

    // What the reader joins as "object/group" is taken apart again. Of several meshes each is an
    // object.
    void part(const Mesh& mesh, Index p) {
        std::string object, group = p < mesh.parts.size() ? one_word(mesh.parts[p]) : "";
        if (meshes_ > 1) {
            object = mesh.name.empty() ? "mesh" : one_word(mesh.name);
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

    char* face(const Mesh& mesh, std::size_t f, bool uv, bool normals, char* to) const {
        *to++ = 'f';
        const Index begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        for (Index k = begin; k < end; ++k) {
            // A mirror turns the winding: the front stays the front.
            const Index c = mirrored_ && k > begin ? begin + end - k : k;
            *to++ = ' ';
            to = write_integer(to, vertex_base_ + mesh.corner_vertices[c] + 1);
            const Index t = uv ? mesh.uvs[0].indices[c] : no_index;
            const Index n = normals ? mesh.normals.indices[c] : no_index;
            if (t != no_index) {
                *to++ = '/';
                to = write_integer(to, uv_base_ + t + 1);
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

    const std::string& material_name(Index m) const { return material_names_[m]; }

    // OBJ tells materials apart by name alone.
    void name_materials() {
        std::unordered_set<std::string> taken;
        for (const Material& material : scene_.materials)
            if (!material.name.empty()) taken.insert(one_word(material.name));
        std::unordered_set<std::string> used;
        for (Index m = 0; m < scene_.materials.size(); ++m) {
            const std::string& own = scene_.materials[m].name;
            std::string name = own.empty() ? fmt::format("material_{}", m) : one_word(own);
            if (own.empty() ? taken.contains(name) : used.contains(name)) {
                const std::string stem = name;
                for (Index k = 2; taken.contains(name) || used.contains(name); ++k)
                    name = fmt::format("{}_{}", stem, k);
                if (!own.empty())
                    note("OBJ tells materials apart by name: equal ones got a number");
            }
            used.insert(name);
            material_names_.push_back(std::move(name));
        }
    }

    std::string materials() {
        std::string mtl = "# meshprep\n";
        for (Index m = 0; m < scene_.materials.size(); ++m) {
            const Material& in = scene_.materials[m];
            mtl += fmt::format("\nnewmtl {}\n", material_name(m));
            const auto color = [&](const char* word, const glm::vec3& c) {
                mtl += fmt::format("{} {} {} {}\n", word, c.r, c.g, c.b);
            };
            glm::vec3 diffuse(in.diffuse), specular = in.specular;
            float shininess = in.shininess;
            if (in.metallic_roughness && in.unlit) {
                specular = glm::vec3(0.0f);  // its colour is all there is of it
            } else if (in.metallic_roughness) {
                const BlinnPhong derived = blinn_phong(diffuse, in.metallic, in.roughness);
                diffuse = derived.diffuse;
                specular = glm::min(derived.specular, glm::vec3(1.0f));  // all that MTL allows
                shininess = derived.shininess;
                note("MTL has no metallic-roughness: written as Blinn-Phong");
            }
            color("Ka", in.ambient);
            color("Kd", diffuse);
            color("Ks", specular);
            color("Ke", in.emissive);
            // Opaque materials ignore their alpha.
            const float opacity = in.alpha_mode == AlphaMode::opaque ? 1.0f : in.diffuse.a;
            mtl += fmt::format("Ns {}\nd {}\nillum {}\n", shininess, opacity, in.unlit ? 0 : 2);
            if (in.alpha_mode == AlphaMode::mask)
                note("MTL has no alpha masks: what they cut out is drawn");
            if (in.double_sided) note("MTL has no double-sided materials: left out");
            map(mtl, "map_Kd", in.diffuse_map);
            map(mtl, "map_Ks", in.specular_map);
            map(mtl, "map_Ke", in.emissive_map);
            map(mtl, "norm", in.normal_map);
            map(mtl, "bump", in.bump_map);
            map(mtl, "disp", in.displacement_map);
            if (in.metallic_roughness_map || in.occlusion_map)
                note("MTL has no metallic-roughness and occlusion maps: left out");
        }
        return mtl;
    }

    void map(std::string& mtl, const char* word, const TextureRef& ref) {
        if (!ref || ref.texture >= scene_.textures.size()) return;
        const Index image = scene_.textures[ref.texture].image;
        if (image >= scene_.images.size()) return;
        const std::string file = image_file(image);
        if (file.empty()) return;
        mtl += word;
        if (ref.strength != 1) mtl += fmt::format(" -bm {}", ref.strength);
        if (ref.scale != glm::vec2(1.0f))
            mtl += fmt::format(" -s {} {} 1", ref.scale.x, ref.scale.y);
        // v runs upwards there: 1 − v' = s · (1 − v) + o.
        const float up = 1 - ref.scale.y - ref.offset.y;
        if (ref.offset.x != 0 || up != 0) mtl += fmt::format(" -o {} {} 0", ref.offset.x, up);
        const Texture& texture = scene_.textures[ref.texture];
        if (texture.wrap_u == Wrap::clamp && texture.wrap_v == Wrap::clamp)
            mtl += " -clamp on";
        else if (texture.wrap_u != Wrap::repeat || texture.wrap_v != Wrap::repeat)
            note("MTL repeats or clamps textures in both directions: others will repeat");
        if (ref.rotation != 0) note("MTL has no texture rotation: left out");
        mtl += fmt::format(" {}\n", file);
    }

    // The image's name relative to the output; embedded ones are written beside it.
    std::string image_file(Index image) {
        const ImageRef& ref = scene_.images[image];
        if (ref.bytes.empty()) {
            std::error_code ec;
            const auto relative = std::filesystem::relative(
                ref.path, path_.parent_path().empty() ? "." : path_.parent_path(), ec);
            return ec || relative.empty() ? ref.path.string() : relative.generic_string();
        }
        const auto known = written_.find(image);
        if (known != written_.end()) return known->second;
        const bool png = std::to_integer<int>(ref.bytes[0]) == 0x89;
        const std::string file =
            fmt::format("{}_image{}.{}", path_.stem().string(), image, png ? "png" : "jpg");
        if (auto done = files_.add(path_.parent_path() / file, ref.bytes); !done && !failure_)
            failure_ = std::move(done).error();
        written_.emplace(image, file);
        return file;
    }

    const Scene& scene_;
    const std::filesystem::path& path_;
    TextBlocks text_;
    std::vector<std::string> notes_;
    FileSet files_;
    std::optional<Error> failure_;
    std::unordered_map<Index, std::string> written_;
    std::vector<std::string> material_names_;
    // The state that the lines written so far leave a reader in.
    std::string object_, group_;
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
