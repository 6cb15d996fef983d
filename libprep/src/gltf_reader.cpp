#include <algorithm>
#include <cmath>
#include <exception>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <set>

#include "gltf_document.h"
#include "gltf_materials.h"

namespace prep {
namespace {

using namespace detail;
using Index = std::uint32_t;

// What a file may require and still be read in full.
const std::set<std::string>& supported_extensions() {
    static const std::set<std::string> names{"KHR_mesh_quantization",
                                             "KHR_texture_transform",
                                             "KHR_lights_punctual",
                                             "KHR_materials_unlit",
                                             "KHR_materials_specular",
                                             "KHR_materials_emissive_strength",
                                             "KHR_materials_ior",
                                             "KHR_materials_clearcoat",
                                             "KHR_materials_sheen",
                                             "KHR_materials_transmission",
                                             "KHR_materials_volume",
                                             "KHR_materials_iridescence",
                                             "KHR_materials_anisotropy",
                                             "KHR_materials_variants",
                                             "KHR_materials_pbrSpecularGlossiness",
                                             "EXT_meshopt_compression",
                                             "KHR_draco_mesh_compression",
                                             "EXT_texture_webp",
                                             "KHR_xmp_json_ld",
                                             "KHR_animation_pointer"};
    return names;
}

class Reader {
  public:
    explicit Reader(std::shared_ptr<GltfDocument> document) : d_(*document), document_(document) {}

    Result<Scene> run() {
        if (auto done = extensions(); !done) return std::move(done).error();
        for (const char* key :
             {"accessors", "bufferViews", "meshes", "nodes", "scenes", "materials", "textures",
              "images", "samplers", "cameras", "skins", "animations"})
            if (auto list = top_array(d_, key); !list) return list.error();
        if (auto done = read_gltf_materials(d_, scene_); !done) return std::move(done).error();
        if (auto done = meshes(); !done) return std::move(done).error();
        if (auto done = cameras(); !done) return std::move(done).error();
        if (auto done = lights(); !done) return std::move(done).error();
        if (auto done = nodes(); !done) return std::move(done).error();
        if (auto done = skins(); !done) return std::move(done).error();
        if (auto done = animations(); !done) return std::move(done).error();
        if (auto done = active_scene(); !done) return std::move(done).error();
        scene_.name = d_.name;
        scene_.document = document_;
        return std::move(scene_);
    }

  private:
    Error bad(const std::string& pointer, std::string text,
              ErrorCode code = ErrorCode::invalid) const {
        return {code, std::move(text), d_.place(pointer)};
    }
    std::size_t size_of(const char* key) const {
        return d_.json.contains(key) ? d_.json[key].size() : 0;
    }
    static std::string name_of(const Json& object) {
        const auto it = object.find("name");
        return it != object.end() && it->is_string() ? it->get<std::string>() : std::string();
    }

    Result<void> extensions() {
        const auto it = d_.json.find("extensionsRequired");
        if (it == d_.json.end()) return {};
        if (!it->is_array()) return bad("/extensionsRequired", "expected an array");
        for (std::size_t i = 0; i < it->size(); ++i) {
            const std::string pointer = "/extensionsRequired/" + std::to_string(i);
            if (!(*it)[i].is_string()) return bad(pointer, "expected a string");
            const std::string name = (*it)[i].get<std::string>();
            if (!supported_extensions().contains(name))
                return bad(pointer,
                           "the file requires the extension " + name + ", which is not supported",
                           ErrorCode::unsupported);
        }
        return {};
    }

    // An attribute's values: from Draco where it has them, else from the accessor.
    Result<RawAccessor> attribute(const GltfPrimitive& primitive, const std::string& semantic,
                                  Index accessor) const {
        const auto known = primitive.draco.find(semantic);
        if (known != primitive.draco.end()) return known->second;
        return d_.raw_accessor(accessor);
    }

    Result<void> meshes() {
        const Json* list = *top_array(d_, "meshes");
        for (std::size_t m = 0; m < list->size(); ++m) {
            const Json& in = (*list)[m];
            const std::string pointer = "/meshes/" + std::to_string(m);
            scene_.meshes.emplace_back();
            scene_.meshes.back().name = name_of(in);
            document_->primitives.emplace_back();
            const auto primitives = in.find("primitives");
            if (primitives == in.end() || !primitives->is_array() || primitives->empty())
                return bad(pointer + "/primitives", "expected a list with at least one primitive");
            for (std::size_t p = 0; p < primitives->size(); ++p)
                if (auto done = primitive((*primitives)[p], p,
                                          pointer + "/primitives/" + std::to_string(p));
                    !done)
                    return done;
            finish_layers(scene_.meshes.back());
        }
        return {};
    }

    Result<void> primitive(const Json& in, std::size_t number, const std::string& pointer) {
        Mesh& mesh = scene_.meshes.back();
        if (!in.is_object()) return bad(pointer, "expected an object");
        const auto attributes = in.find("attributes");
        if (attributes == in.end() || !attributes->is_object() || attributes->empty())
            return bad(pointer + "/attributes", "expected an object with at least one attribute");
        GltfPrimitive out;
        out.first_vertex = Index(mesh.positions.size());
        const auto mode = whole_member(d_, in, "mode", pointer, 0, 6, 4);
        if (!mode) return mode.error();
        out.triangles = *mode >= 4;
        const auto material = index_member(d_, in, "material", pointer, size_of("materials"));
        if (!material) return material.error();

        std::optional<std::vector<Index>> draco_indices;
        if (in.contains("extensions") && in["extensions"].is_object() &&
            in["extensions"].contains("KHR_draco_mesh_compression")) {
            auto decoded = decode_draco(d_, in, pointer, out.draco);
            if (!decoded) return std::move(decoded).error();
            draco_indices = *std::move(decoded);
        }
        if (auto done = read_attributes(*attributes, pointer + "/attributes", out, mesh); !done)
            return done;
        if (auto done = check_targets(in, pointer, out); !done) return done;

        std::vector<Index> indices;
        if (draco_indices) {
            indices = *std::move(draco_indices);
        } else if (in.contains("indices")) {
            const auto accessor = index_member(d_, in, "indices", pointer, size_of("accessors"));
            if (!accessor) return accessor.error();
            const auto raw = d_.raw_accessor(*accessor);
            if (!raw) return raw.error();
            const std::string place = "/accessors/" + std::to_string(*accessor);
            if (raw->width != 1 || raw->component_type == 5126 || raw->component_type == 5120 ||
                raw->component_type == 5122)
                return bad(place, "indices must be unsigned whole scalars");
            indices = to_indices(*raw);
        } else {
            indices.resize(out.vertex_count);
            for (Index i = 0; i < out.vertex_count; ++i) indices[i] = i;
        }
        for (std::size_t i = 0; i < indices.size(); ++i)
            if (indices[i] >= out.vertex_count)
                return bad(pointer + "/indices",
                           "index " + std::to_string(indices[i]) + " (number " + std::to_string(i) +
                               ") is out of range: the primitive has " +
                               std::to_string(out.vertex_count) + " vertices");
        if (out.vertex_count > 0) add_elements(int(*mode), indices, out.first_vertex, mesh);
        const std::size_t faces = mesh.face_count();
        mesh.face_materials.resize(faces, *material);
        mesh.face_parts.resize(faces, Index(number));
        mesh.parts.resize(number + 1);
        document_->primitives.back().push_back(std::move(out));
        return {};
    }

    // Layers grow by this primitive's vertices; a vertex without the attribute is marked, and
    // finish_layers() makes "no value" of it.
    template <class T>
    struct Growing {
        std::vector<T> values;
        std::vector<bool> has;
        void append(std::size_t first, const std::vector<T>& more) {
            values.resize(first, T(0.0f));
            has.resize(first, false);
            values.insert(values.end(), more.begin(), more.end());
            has.resize(values.size(), true);
        }
    };

    template <class T>
    static std::vector<T> elements(const std::vector<float>& floats, int width) {
        std::vector<T> out(floats.size() / std::size_t(width));
        for (std::size_t i = 0; i < out.size(); ++i)
            for (int k = 0; k < std::min(width, T::length()); ++k)
                out[i][k] = floats[i * std::size_t(width) + std::size_t(k)];
        return out;
    }

    Result<void> read_attributes(const Json& attributes, const std::string& pointer,
                                 GltfPrimitive& out, Mesh& mesh) {
        // Positions first: they say how many vertices there are.
        std::optional<std::size_t> count;
        for (const bool positions : {true, false})
            for (const auto& item : attributes.items()) {
                const std::string& semantic = item.key();
                if ((semantic == "POSITION") != positions) continue;
                const std::string place = pointer + "/" + semantic;
                const auto accessor =
                    index_member(d_, attributes, semantic.c_str(), pointer, size_of("accessors"));
                if (!accessor) return accessor.error();
                auto raw = attribute(out, semantic, *accessor);
                if (!raw) return std::move(raw).error();
                if (!count) count = raw->count;
                if (raw->count != *count)
                    return bad(place, "has " + std::to_string(raw->count) +
                                          " elements, other attributes have " +
                                          std::to_string(*count));
                if (auto done = use_attribute(semantic, *raw, place, out.first_vertex, mesh); !done)
                    return done;
            }
        const bool has_positions = attributes.contains("POSITION");
        if (!has_positions)
            scene_.warnings.push_back(d_.place(pointer) + ": no positions: nothing to draw");
        if (mesh.positions.size() + *count >= no_index)
            return bad(pointer, "more than 2^32 - 2 vertices", ErrorCode::limit);
        out.vertex_count = has_positions ? Index(*count) : 0;
        return {};
    }

    Result<void> use_attribute(const std::string& semantic, const RawAccessor& raw,
                               const std::string& place, std::size_t first, Mesh& mesh) {
        const auto wants = [&](int low, int high) -> Result<void> {
            if (raw.width < low || raw.width > high)
                return bad(place, semantic + " needs " + std::to_string(low) +
                                      (high > low ? " or " + std::to_string(high) : "") +
                                      " components, found " + std::to_string(raw.width));
            if (raw.component_type == 5125)
                return bad(place, semantic + " cannot be of unsigned 32-bit type");
            return {};
        };
        const auto set_number = [&](const char* prefix) -> std::optional<std::size_t> {
            if (!semantic.starts_with(prefix)) return std::nullopt;
            const std::string digits = semantic.substr(std::string_view(prefix).size());
            if (digits.empty() || digits.size() > 2 ||
                digits.find_first_not_of("0123456789") != std::string::npos)
                return std::nullopt;
            return std::size_t(std::stoul(digits));
        };
        if (semantic == "POSITION") {
            if (auto done = wants(3, 3); !done) return done;
            const auto values = elements<glm::vec3>(to_floats(raw), 3);
            mesh.positions.insert(mesh.positions.end(), values.begin(), values.end());
        } else if (semantic == "NORMAL") {
            if (auto done = wants(3, 3); !done) return done;
            normals_.append(first, elements<glm::vec3>(to_floats(raw), 3));
        } else if (semantic == "TANGENT") {
            if (auto done = wants(4, 4); !done) return done;
            tangents_.append(first, elements<glm::vec4>(to_floats(raw), 4));
        } else if (const auto uv = set_number("TEXCOORD_")) {
            if (auto done = wants(2, 2); !done) return done;
            if (uvs_.size() <= *uv) uvs_.resize(*uv + 1);
            uvs_[*uv].append(first, elements<glm::vec2>(to_floats(raw), 2));
        } else if (const auto color = set_number("COLOR_")) {
            if (auto done = wants(3, 4); !done) return done;
            if (colors_.size() <= *color) colors_.resize(*color + 1);
            auto values = elements<glm::vec4>(to_floats(raw), raw.width);
            if (raw.width == 3)
                for (glm::vec4& c : values) c.a = 1;
            colors_[*color].append(first, values);
        }
        return {};
    }

    Result<void> check_targets(const Json& in, const std::string& pointer,
                               const GltfPrimitive& out) const {
        const auto targets = in.find("targets");
        if (targets == in.end()) return {};
        if (!targets->is_array()) return bad(pointer + "/targets", "expected an array");
        for (std::size_t t = 0; t < targets->size(); ++t) {
            const std::string place = pointer + "/targets/" + std::to_string(t);
            if (!(*targets)[t].is_object()) return bad(place, "expected an object");
            for (const auto& item : (*targets)[t].items()) {
                const auto accessor = index_member(d_, (*targets)[t], item.key().c_str(), place,
                                                   size_of("accessors"));
                if (!accessor) return accessor.error();
                const auto raw = d_.raw_accessor(*accessor);
                if (!raw) return raw.error();
                if (raw->count != out.vertex_count && out.vertex_count > 0)
                    return bad(place + "/" + item.key(), "has " + std::to_string(raw->count) +
                                                             " elements, the primitive has " +
                                                             std::to_string(out.vertex_count) +
                                                             " vertices");
            }
        }
        return {};
    }

    static void add_elements(int mode, const std::vector<Index>& indices, Index base, Mesh& mesh) {
        const std::size_t n = indices.size();
        const auto face = [&](Index a, Index b, Index c) {
            for (const Index v : {a, b, c}) mesh.corner_vertices.push_back(base + v);
            mesh.face_offsets.push_back(Index(mesh.corner_vertices.size()));
        };
        const auto line = [&](std::size_t first, std::size_t last, bool closed) {
            if (last - first < 2) return;
            for (std::size_t i = first; i < last; ++i)
                mesh.line_vertices.push_back(base + indices[i]);
            if (closed) mesh.line_vertices.push_back(base + indices[first]);
            mesh.line_offsets.push_back(Index(mesh.line_vertices.size()));
        };
        switch (mode) {
            case 0:
                for (const Index v : indices) mesh.points.push_back(base + v);
                break;
            case 1:
                for (std::size_t i = 0; i + 1 < n; i += 2) line(i, i + 2, false);
                break;
            case 2:
                line(0, n, true);
                break;
            case 3:
                line(0, n, false);
                break;
            case 4:
                for (std::size_t i = 0; i + 2 < n; i += 3)
                    face(indices[i], indices[i + 1], indices[i + 2]);
                break;
            case 5:  // the order of the specification: the first vertex stays the provoking one
                for (std::size_t i = 0; i + 2 < n; ++i)
                    face(indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]);
                break;
            case 6:
                for (std::size_t i = 0; i + 2 < n; ++i)
                    face(indices[i + 1], indices[i + 2], indices[0]);
                break;
            default:
                break;
        }
    }

    template <class T>
    static void finish_layer(Growing<T>& growing, const Mesh& mesh, CornerLayer<T>& layer) {
        if (!growing.values.empty() && mesh.corner_count() > 0) {
            growing.values.resize(mesh.vertex_count(), T(0.0f));
            growing.has.resize(mesh.vertex_count(), false);
            layer.indices.resize(mesh.corner_count());
            for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
                const Index v = mesh.corner_vertices[c];
                layer.indices[c] = growing.has[v] ? v : no_index;
            }
            layer.values = std::move(growing.values);
        }
        growing = {};
    }

    void finish_layers(Mesh& mesh) {
        finish_layer(normals_, mesh, mesh.normals);
        finish_layer(tangents_, mesh, mesh.tangents);
        mesh.uvs.resize(uvs_.size());
        for (std::size_t s = 0; s < uvs_.size(); ++s) finish_layer(uvs_[s], mesh, mesh.uvs[s]);
        if (!colors_.empty() && mesh.corner_count() == 0 && !colors_[0].values.empty()) {
            colors_[0].values.resize(mesh.vertex_count(), glm::vec4(1.0f));
            mesh.vertex_colors = colors_[0].values;
        }
        mesh.colors.resize(mesh.corner_count() > 0 ? colors_.size() : 0);
        for (std::size_t s = 0; s < mesh.colors.size(); ++s)
            finish_layer(colors_[s], mesh, mesh.colors[s]);
        uvs_.clear();
        colors_.clear();
    }

    // A number member; `otherwise` where it is absent.
    Result<double> number(const Json& object, const char* key, const std::string& pointer,
                          std::optional<double> otherwise) const {
        const auto it = object.find(key);
        if (it == object.end()) {
            if (otherwise) return *otherwise;
            return bad(pointer + "/" + key, "the member is missing");
        }
        if (!it->is_number()) return bad(pointer + "/" + key, "expected a number");
        return it->get<double>();
    }

    Result<void> numbers(const Json& object, const char* key, const std::string& pointer,
                         std::size_t count, double* out) const {
        const auto it = object.find(key);
        if (it == object.end()) return {};
        const std::string place = pointer + "/" + key;
        if (!it->is_array() || it->size() != count)
            return bad(place, "expected " + std::to_string(count) + " numbers");
        for (std::size_t i = 0; i < count; ++i) {
            if (!(*it)[i].is_number())
                return bad(place + "/" + std::to_string(i), "expected a number");
            out[i] = (*it)[i].get<double>();
        }
        return {};
    }

    Result<void> cameras() {
        const Json* list = *top_array(d_, "cameras");
        for (std::size_t c = 0; c < list->size(); ++c) {
            const Json& in = (*list)[c];
            const std::string pointer = "/cameras/" + std::to_string(c);
            Camera out;
            out.name = name_of(in);
            const auto type = in.find("type");
            if (type == in.end() || !type->is_string())
                return bad(pointer + "/type", "expected a string");
            const std::string kind = type->get<std::string>();
            if (kind != "perspective" && kind != "orthographic")
                return bad(pointer + "/type", "expected perspective or orthographic");
            const auto lens = in.find(kind);
            if (lens == in.end() || !lens->is_object())
                return bad(pointer + "/" + kind, "expected an object");
            const std::string place = pointer + "/" + kind;
            out.perspective = kind == "perspective";
            const auto take = [&](const char* key, std::optional<double> otherwise, double& to,
                                  double low) -> Result<void> {
                const auto value = number(*lens, key, place, otherwise);
                if (!value) return value.error();
                if (lens->contains(key) && !(*value >= low && std::isfinite(*value)))
                    return bad(place + "/" + key, "out of range");
                to = *value;
                return {};
            };
            if (out.perspective) {
                if (auto r = take("yfov", {}, out.yfov, 1e-9); !r) return r;
                if (auto r = take("aspectRatio", 0.0, out.aspect, 1e-9); !r) return r;
                if (auto r = take("znear", {}, out.znear, 1e-30); !r) return r;
                if (auto r = take("zfar", 0.0, out.zfar, 1e-30); !r) return r;
                if (out.yfov >= 3.14159) return bad(place + "/yfov", "must be below π");
                if (lens->contains("zfar") && out.zfar <= out.znear)
                    return bad(place + "/zfar", "must be greater than znear");
            } else {
                if (auto r = take("xmag", {}, out.xmag, -1e300); !r) return r;
                if (auto r = take("ymag", {}, out.ymag, -1e300); !r) return r;
                if (auto r = take("znear", {}, out.znear, 0); !r) return r;
                if (auto r = take("zfar", {}, out.zfar, 0); !r) return r;
                if (out.xmag == 0) return bad(place + "/xmag", "must not be zero");
                if (out.ymag == 0) return bad(place + "/ymag", "must not be zero");
                if (out.zfar <= out.znear)
                    return bad(place + "/zfar", "must be greater than znear");
            }
            scene_.cameras.push_back(out);
        }
        return {};
    }

    Result<void> lights() {
        if (!d_.json.contains("extensions") || !d_.json["extensions"].is_object()) return {};
        const Json& extensions = d_.json["extensions"];
        if (!extensions.contains("KHR_lights_punctual")) return {};
        const Json& extension = extensions["KHR_lights_punctual"];
        const std::string base = "/extensions/KHR_lights_punctual/lights";
        if (!extension.is_object() || !extension.contains("lights") ||
            !extension["lights"].is_array())
            return bad(base, "expected an array");
        for (std::size_t l = 0; l < extension["lights"].size(); ++l) {
            const Json& in = extension["lights"][l];
            const std::string pointer = base + "/" + std::to_string(l);
            if (!in.is_object()) return bad(pointer, "expected an object");
            Light out;
            out.name = name_of(in);
            const std::string type =
                in.contains("type") && in["type"].is_string() ? in["type"].get<std::string>() : "";
            if (type == "directional")
                out.kind = LightKind::directional;
            else if (type == "point")
                out.kind = LightKind::point;
            else if (type == "spot")
                out.kind = LightKind::spot;
            else
                return bad(pointer + "/type", "expected directional, point or spot");
            double rgb[3] = {1, 1, 1};
            if (auto r = numbers(in, "color", pointer, 3, rgb); !r) return r;
            out.color = glm::vec3(glm::dvec3(rgb[0], rgb[1], rgb[2]));
            const auto intensity = number(in, "intensity", pointer, 1.0);
            const auto range = number(in, "range", pointer, 0.0);
            if (!intensity) return intensity.error();
            if (!range) return range.error();
            out.intensity = float(*intensity);
            out.range = float(*range);
            if (in.contains("spot") && in["spot"].is_object()) {
                const auto inner = number(in["spot"], "innerConeAngle", pointer + "/spot", 0.0);
                const auto outer =
                    number(in["spot"], "outerConeAngle", pointer + "/spot", double(out.outer_cone));
                if (!inner) return inner.error();
                if (!outer) return outer.error();
                out.inner_cone = float(*inner);
                out.outer_cone = float(*outer);
            }
            scene_.lights.push_back(out);
        }
        return {};
    }

    Result<void> node_transform(const Json& in, const std::string& pointer, Node& out) const {
        double m[16], t[3] = {0, 0, 0}, r[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
        if (in.contains("matrix")) {
            if (auto done = numbers(in, "matrix", pointer, 16, m); !done) return done;
            for (int c = 0; c < 4; ++c)
                for (int k = 0; k < 4; ++k) out.transform[c][k] = m[4 * c + k];
            return {};
        }
        if (auto done = numbers(in, "translation", pointer, 3, t); !done) return done;
        if (auto done = numbers(in, "rotation", pointer, 4, r); !done) return done;
        if (auto done = numbers(in, "scale", pointer, 3, s); !done) return done;
        glm::dquat q(r[3], r[0], r[1], r[2]);
        const double length = glm::length(q);
        if (length > 0 && std::isfinite(length)) q = q / length;
        glm::dmat4 rotation = glm::mat4_cast(q);
        for (int c = 0; c < 3; ++c) rotation[c] *= s[c];
        rotation[3] = glm::dvec4(t[0], t[1], t[2], 1);
        out.transform = rotation;
        return {};
    }

    Result<void> nodes() {
        const Json* list = *top_array(d_, "nodes");
        scene_.nodes.resize(list->size());
        for (std::size_t n = 0; n < list->size(); ++n) {
            const Json& in = (*list)[n];
            const std::string pointer = "/nodes/" + std::to_string(n);
            Node& out = scene_.nodes[n];
            out.name = name_of(in);
            if (auto done = node_transform(in, pointer, out); !done) return done;
            const auto take = [&](const char* key, std::size_t size, Index& to) -> Result<void> {
                const auto value = index_member(d_, in, key, pointer, size);
                if (!value) return value.error();
                to = *value;
                return {};
            };
            if (auto done = take("mesh", scene_.meshes.size(), out.mesh); !done) return done;
            if (auto done = take("camera", scene_.cameras.size(), out.camera); !done) return done;
            if (auto done = take("skin", size_of("skins"), out.skin); !done) return done;
            if (in.contains("extensions") && in["extensions"].is_object() &&
                in["extensions"].contains("KHR_lights_punctual") &&
                in["extensions"]["KHR_lights_punctual"].is_object()) {
                const auto light =
                    index_member(d_, in["extensions"]["KHR_lights_punctual"], "light",
                                 pointer + "/extensions/KHR_lights_punctual", scene_.lights.size());
                if (!light) return light.error();
                out.light = *light;
            }
            const auto children = in.find("children");
            if (children == in.end()) continue;
            if (!children->is_array()) return bad(pointer + "/children", "expected an array");
            for (std::size_t c = 0; c < children->size(); ++c) {
                const std::string place = pointer + "/children/" + std::to_string(c);
                if (!(*children)[c].is_number_unsigned() ||
                    (*children)[c].get<std::uint64_t>() >= list->size())
                    return bad(place, "expected the index of a node, found " +
                                          (*children)[c].dump().substr(0, 40));
                Node& child = scene_.nodes[(*children)[c].get<std::size_t>()];
                if (child.parent != no_index)
                    return bad(place,
                               "the node has another parent: " + std::to_string(child.parent));
                child.parent = Index(n);
            }
        }
        return check_cycles();
    }

    // With one parent each, a node that cannot reach a root is on a cycle or below one.
    Result<void> check_cycles() const {
        std::vector<std::uint8_t> good(scene_.nodes.size(), 0);
        for (Index n = 0; n < scene_.nodes.size(); ++n) {
            Index k = n;
            std::size_t steps = 0;
            while (k != no_index && !good[k] && steps <= scene_.nodes.size()) {
                k = scene_.nodes[k].parent;
                ++steps;
            }
            if (steps > scene_.nodes.size())
                return bad("/nodes/" + std::to_string(n), "the node is its own ancestor");
            for (k = n; k != no_index && !good[k]; k = scene_.nodes[k].parent) good[k] = 1;
        }
        return {};
    }

    Result<void> skins() {
        const Json* list = *top_array(d_, "skins");
        for (std::size_t s = 0; s < list->size(); ++s) {
            const Json& in = (*list)[s];
            const std::string pointer = "/skins/" + std::to_string(s);
            Skin out;
            out.name = name_of(in);
            const auto joints = in.find("joints");
            if (joints == in.end() || !joints->is_array() || joints->empty())
                return bad(pointer + "/joints", "expected a list with at least one node");
            for (std::size_t j = 0; j < joints->size(); ++j) {
                if (!(*joints)[j].is_number_unsigned() ||
                    (*joints)[j].get<std::uint64_t>() >= scene_.nodes.size())
                    return bad(pointer + "/joints/" + std::to_string(j),
                               "expected the index of a node");
                out.joints.push_back((*joints)[j].get<Index>());
            }
            const auto accessor =
                index_member(d_, in, "inverseBindMatrices", pointer, size_of("accessors"));
            if (!accessor) return accessor.error();
            if (auto r = index_member(d_, in, "skeleton", pointer, scene_.nodes.size()); !r)
                return r.error();
            out.inverse_bind.assign(out.joints.size(), glm::mat4(1.0f));
            if (*accessor != no_index) {
                const auto raw = d_.raw_accessor(*accessor);
                if (!raw) return raw.error();
                if (raw->width != 16 || raw->component_type != 5126 ||
                    raw->count < out.joints.size())
                    return bad(pointer + "/inverseBindMatrices",
                               "expected a float MAT4 for each of " +
                                   std::to_string(out.joints.size()) + " joints");
                const std::vector<float> floats = to_floats(*raw);
                for (std::size_t j = 0; j < out.joints.size(); ++j)
                    for (int k = 0; k < 16; ++k)
                        out.inverse_bind[j][k / 4][k % 4] = floats[16 * j + std::size_t(k)];
            }
            scene_.skins.push_back(std::move(out));
        }
        return {};
    }

    // Animations are carried, not played: only what would break their writing back is looked at.
    Result<void> animations() {
        const Json* list = *top_array(d_, "animations");
        for (std::size_t a = 0; a < list->size(); ++a) {
            const Json& in = (*list)[a];
            const std::string pointer = "/animations/" + std::to_string(a);
            for (const char* key : {"samplers", "channels"})
                if (!in.contains(key) || !in[key].is_array() || in[key].empty())
                    return bad(pointer + "/" + key, "expected a list with at least one entry");
            for (std::size_t s = 0; s < in["samplers"].size(); ++s) {
                const Json& sampler = in["samplers"][s];
                const std::string place = pointer + "/samplers/" + std::to_string(s);
                if (!sampler.is_object()) return bad(place, "expected an object");
                for (const char* key : {"input", "output"}) {
                    const auto accessor =
                        index_member(d_, sampler, key, place, size_of("accessors"));
                    if (!accessor) return accessor.error();
                    if (*accessor == no_index)
                        return bad(place + "/" + key, "the member is missing");
                    if (const auto raw = d_.raw_accessor(*accessor); !raw) return raw.error();
                }
            }
            for (std::size_t c = 0; c < in["channels"].size(); ++c) {
                const Json& channel = in["channels"][c];
                const std::string place = pointer + "/channels/" + std::to_string(c);
                if (!channel.is_object()) return bad(place, "expected an object");
                const auto sampler =
                    index_member(d_, channel, "sampler", place, in["samplers"].size());
                if (!sampler) return sampler.error();
                if (!channel.contains("target") || !channel["target"].is_object())
                    return bad(place + "/target", "expected an object");
                if (auto node = index_member(d_, channel["target"], "node", place + "/target",
                                             scene_.nodes.size());
                    !node)
                    return node.error();
            }
        }
        return {};
    }

    // Nodes outside the active scene keep their place in the list, but nothing of theirs is drawn.
    Result<void> active_scene() {
        const Json* list = *top_array(d_, "scenes");
        const auto chosen = index_member(d_, d_.json, "scene", "", list->size());
        if (!chosen) return chosen.error();
        for (std::size_t s = 0; s < list->size(); ++s)
            if (auto done = scene_nodes((*list)[s], "/scenes/" + std::to_string(s)); !done)
                return done;
        if (list->empty()) return {};
        const Json& scene = (*list)[*chosen == no_index ? 0 : *chosen];
        std::vector<bool> root(scene_.nodes.size(), false), drawn(scene_.nodes.size(), false);
        if (scene.contains("nodes"))
            for (const Json& n : scene["nodes"]) root[n.get<std::size_t>()] = true;
        for (Index n = 0; n < scene_.nodes.size(); ++n)
            for (Index k = n; k != no_index; k = scene_.nodes[k].parent)
                if (root[k]) {
                    drawn[n] = true;
                    break;
                }
        for (Index n = 0; n < scene_.nodes.size(); ++n) {
            Node& node = scene_.nodes[n];
            if (!drawn[n]) node.mesh = node.light = node.camera = no_index;
            if (node.camera != no_index && scene_.active_camera == no_index)
                scene_.active_camera = n;
        }
        return {};
    }

    Result<void> scene_nodes(const Json& scene, const std::string& pointer) const {
        const auto nodes = scene.find("nodes");
        if (nodes == scene.end()) return {};
        if (!nodes->is_array()) return bad(pointer + "/nodes", "expected an array");
        for (std::size_t i = 0; i < nodes->size(); ++i) {
            const std::string place = pointer + "/nodes/" + std::to_string(i);
            if (!(*nodes)[i].is_number_unsigned() ||
                (*nodes)[i].get<std::uint64_t>() >= scene_.nodes.size())
                return bad(place, "expected the index of a node");
            if (scene_.nodes[(*nodes)[i].get<std::size_t>()].parent != no_index)
                return bad(place, "the node is not a root");
        }
        return {};
    }

    const GltfDocument& d_;
    std::shared_ptr<GltfDocument> document_;
    Scene scene_;
    Growing<glm::vec3> normals_;
    Growing<glm::vec4> tangents_;
    std::vector<Growing<glm::vec2>> uvs_;
    std::vector<Growing<glm::vec4>> colors_;
};

}  // namespace

Result<Scene> parse_gltf(std::span<const std::byte> bytes, const GltfOptions& options) {
    try {
        auto opened = detail::open_gltf(bytes, options);
        if (!opened) return std::move(opened).error();
        return Reader(std::make_shared<GltfDocument>(*std::move(opened))).run();
    } catch (const detail::Json::exception& e) {
        // Types are checked where they are read; this is the net below that.
        return Error{ErrorCode::invalid, std::string("unexpected JSON: ") + e.what(), options.name};
    }
}

Result<Scene> load_gltf(const std::filesystem::path& path, const LoadOptions&) {
    const auto bytes = read_file(path);
    if (!bytes) return bytes.error();
    GltfOptions options;
    options.name = path.filename().string();
    options.directory = path.parent_path();
    auto scene = parse_gltf(*bytes, options);
    if (scene) scene->source = path;
    return scene;
}

}  // namespace prep
