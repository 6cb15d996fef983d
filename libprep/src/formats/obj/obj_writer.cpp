#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "base/atomic_files.h"
#include "formats/writers.h"
#include "image/packed_channels.h"
#include "image/picture_kind.h"
#include "prep/formats.h"
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
        : scene_(prepared.scene),
          path_(path),
          // Those of other formats hold no materials of OBJ.
          keep_libraries_(options.replace_sources && !scene_.libraries.empty() &&
                          lower_ending(scene_.name) == ".obj"),
          files_(rules_for(prepared, path, options)) {}

    WriteResult run() {
        text_.text() = "# meshprep\n";
        std::string mtl;
        if (!scene_.materials.empty()) {
            name_materials();
            if (!keep_libraries_) mtl = materials();
            for (const std::string& name : libraries())
                text_.text() += fmt::format("mtllib {}\n", name);
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
                text_.text() +=
                    fmt::format("usemtl {}\n",
                                m < scene_.materials.size() ? material_name(m) : no_material_name_);
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

    // Written in place, a mesh goes on using the libraries it was read with, which say more than
    // what would be written again.
    std::vector<std::string> libraries() const {
        if (!keep_libraries_) return {path_.stem().string() + ".mtl"};
        std::vector<std::string> names;
        for (const std::filesystem::path& library : scene_.libraries)
            names.push_back(relative(library));
        return names;
    }

    // As it is named from where the output stands.
    std::string relative(const std::filesystem::path& file) const {
        std::error_code ec;
        const std::filesystem::path name = std::filesystem::relative(
            file, path_.parent_path().empty() ? "." : path_.parent_path(), ec);
        return ec || name.empty() ? file.string() : name.generic_string();
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
        for (Index k = 2; used.contains(no_material_name_); ++k)
            no_material_name_ = fmt::format("default_{}", k);
    }

    std::string materials() {
        std::string mtl = "# meshprep\n";
        for (Index m = 0; m < scene_.materials.size(); ++m) {
            const Material& in = scene_.materials[m];
            mtl += fmt::format("\nnewmtl {}\n", material_name(m));
            const auto color = [&](const char* word, const glm::vec3& c) {
                mtl += fmt::format("{} {} {} {}\n", word, c.r, c.g, c.b);
            };
            glm::vec3 specular = in.specular;
            float shininess = in.shininess;
            const bool physical = in.metallic_roughness && !in.unlit;
            if (in.metallic_roughness && in.unlit) {
                specular = glm::vec3(0.0f);  // its colour is all there is of it
            } else if (physical) {
                const BlinnPhong derived =
                    blinn_phong(glm::vec3(in.diffuse), in.metallic, in.roughness, in.reflectance);
                specular = glm::min(derived.specular, glm::vec3(1.0f));  // all that MTL allows
                shininess = derived.shininess;
                note(
                    "metallic-roughness is written as Pr and Pm; Kd is the base colour, Ks and Ns "
                    "are for programs that do not read them");
            }
            color("Ka", in.ambient);
            // With Pm the base colour, of metals too, as other programs write and read it.
            color("Kd", glm::vec3(in.diffuse));
            color("Ks", specular);
            color("Ke", in.emissive);
            // Opaque materials ignore their alpha.
            const float opacity = in.alpha_mode == AlphaMode::opaque ? 1.0f : in.diffuse.a;
            mtl += fmt::format("Ns {}\nd {}\nillum {}\n", shininess, opacity, in.unlit ? 0 : 2);
            if (physical) physical_statements(in, mtl);
            if (in.alpha_mode == AlphaMode::mask)
                note("MTL has no alpha masks: what they cut out is drawn");
            if (in.double_sided) note("MTL has no double-sided materials: left out");
            map(mtl, "map_Kd", in.diffuse_map);
            map(mtl, "map_Ks", in.specular_map);
            map(mtl, "map_Ke", in.emissive_map);
            map(mtl, "norm", in.normal_map);
            map(mtl, "bump", in.bump_map);
            displacement(in, mtl);
            if (in.alpha_mode == AlphaMode::blend) opacity_map(in.diffuse_map, mtl);
            if (in.occlusion_map) note("MTL has no occlusion maps: left out");
        }
        return mtl;
    }

    // base + gain · texel is (texel − midlevel) · scale.
    void displacement(const Material& in, std::string& mtl) {
        if (!in.displacement_map) return;
        if (in.displacement_kind != DisplacementKind::height)
            return note("MTL has no vector displacement: left out");
        const double gain = double(in.displacement_scale);
        const double base = -double(in.displacement_midlevel) * gain;
        // Not −0.
        const std::string range =
            base == 0 && gain == 1 ? "" : fmt::format(" -mm {} {}", base == 0 ? 0.0 : base, gain);
        map(mtl, "disp" + range, in.displacement_map);
    }

    void physical_statements(const Material& in, std::string& mtl) {
        const auto number = [&](const char* word, float value) {
            mtl += fmt::format("{} {}\n", word, value);
        };
        number("Pr", in.roughness);
        number("Pm", in.metallic);
        const glm::vec3& f0 = in.reflectance;
        if (f0.r != f0.g || f0.r != f0.b) note("MTL has one reflectance for all colours: the mean");
        const double mean = (double(f0.r) + double(f0.g) + double(f0.b)) / 3;
        // What an index of refraction reflects: ((n − 1)/(n + 1))².
        if (f0 != glm::vec3(0.04f) && mean < 0.999) {
            const double root = std::sqrt(std::max(mean, 0.0));
            number("Ni", float((1 + root) / (1 - root)));
        }
        if (in.clearcoat > 0) {
            number("Pc", in.clearcoat);
            number("Pcr", in.clearcoat_roughness);
        }
        if (in.sheen != glm::vec3(0.0f))
            mtl += fmt::format("Ps {} {} {}\n", in.sheen.r, in.sheen.g, in.sheen.b);
        if (in.anisotropy > 0) {
            number("aniso", in.anisotropy);
            number("anisor", in.anisotropy_rotation / 6.2831853f);
        }
        if (!in.metallic_roughness_map) return;
        // Programs read grey pictures there, one for each.
        if (in.roughness > 0) grey_map(mtl, "map_Pr", in.metallic_roughness_map, 1, "roughness");
        if (in.metallic > 0) grey_map(mtl, "map_Pm", in.metallic_roughness_map, 2, "metallic");
    }

    // A channel of the packed picture as a file of its own; what was put together is named again.
    void grey_map(std::string& mtl, const char* word, const TextureRef& ref, std::uint32_t channel,
                  const char* what) {
        const ImageRef* image = image_of(ref);
        if (!image) return;
        if (!image->channels.empty()) {
            if (channel >= image->channels.size()) return;
            const PackedChannel& packed = image->channels[channel];
            if (!packed.source) return;
            if (packed.source->bytes.empty() && packed.channel == 0 && !packed.inverted)
                return map_line(mtl, word, ref, path_from_output(packed.source->path));
        }
        const Index index = scene_.textures[ref.texture].image;
        const std::string file =
            fmt::format("{}_image{}_{}.png", path_.stem().string(), index, what);
        if (!grey_files_.contains(file)) {
            const auto decoded = load_image(*image);
            const auto png =
                decoded ? encode_png(single_channel(*decoded, channel)) : decoded.error();
            if (!png) {
                note("the metallic-roughness picture '" + image->name +
                     "' cannot be read: left out (" + png.error().text + ")");
                return;
            }
            if (auto done = files_.add(path_.parent_path() / file, *png); !done && !failure_)
                failure_ = std::move(done).error();
            grey_files_.insert(file);
        }
        map_line(mtl, word, ref, file);
    }

    // The alpha of the colour's picture: the same file, or the one that it was put together from.
    void opacity_map(const TextureRef& ref, std::string& mtl) {
        const ImageRef* image = image_of(ref);
        if (!image) return;
        if (image->channels.size() < 4) {
            // Of a picture without alpha, programs would take the brightness.
            const auto decoded = load_image(*image);
            if (decoded && decoded->channels % 2 == 0) map(mtl, "map_d", ref);
            if (!decoded && decoded.error().code != ErrorCode::io)
                note("whether '" + image->name + "' has alpha is unknown: " + decoded.error().text);
            return;
        }
        const auto& opacity = image->channels[3].source;
        if (!opacity) return;
        // Numbers behind those of the scene's own pictures.
        const Index number = Index(scene_.images.size()) + scene_.textures[ref.texture].image;
        map_line(mtl, "map_d", ref,
                 opacity->bytes.empty() ? path_from_output(opacity->path)
                                        : embedded_file(*opacity, number));
    }

    const ImageRef* image_of(const TextureRef& ref) const {
        if (!ref || ref.texture >= scene_.textures.size()) return nullptr;
        const Index image = scene_.textures[ref.texture].image;
        return image < scene_.images.size() ? &scene_.images[image] : nullptr;
    }

    std::string path_from_output(const std::filesystem::path& file) const {
        std::error_code ec;
        const auto relative = std::filesystem::relative(
            file, path_.parent_path().empty() ? "." : path_.parent_path(), ec);
        return ec || relative.empty() ? file.string() : relative.generic_string();
    }

    void map(std::string& mtl, const std::string& word, const TextureRef& ref) {
        if (!ref || ref.texture >= scene_.textures.size()) return;
        const Index image = scene_.textures[ref.texture].image;
        if (image >= scene_.images.size()) return;
        map_line(mtl, word, ref, image_file(image));
    }

    void map_line(std::string& mtl, const std::string& word, const TextureRef& ref,
                  const std::string& file) {
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
        // The colour of what was put together with an opacity.
        if (!ref.channels.empty()) {
            const auto& source = ref.channels[0].source;
            if (!source) return "";
            return source->bytes.empty() ? path_from_output(source->path)
                                         : embedded_file(*source, image);
        }
        if (ref.bytes.empty()) return path_from_output(ref.path);
        return embedded_file(ref, image);
    }

    std::string embedded_file(const ImageRef& ref, Index image) {
        const auto known = written_.find(image);
        if (known != written_.end()) return known->second;
        const std::string_view kind = picture_kind(ref.bytes);
        const std::string file =
            fmt::format("{}_image{}{}", path_.stem().string(), image,
                        ref.path.has_extension() ? ref.path.extension().string()
                        : kind.empty()           ? ".jpg"
                                                 : "." + std::string(kind));
        if (auto done = files_.add(path_.parent_path() / file, ref.bytes); !done && !failure_)
            failure_ = std::move(done).error();
        written_.emplace(image, file);
        return file;
    }

    const Scene& scene_;
    const std::filesystem::path& path_;
    const bool keep_libraries_;
    TextBlocks text_;
    std::vector<std::string> notes_;
    FileSet files_;
    std::optional<Error> failure_;
    std::unordered_map<Index, std::string> written_;
    std::unordered_set<std::string> grey_files_;
    std::vector<std::string> material_names_;
    std::string no_material_name_ = "default";
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
