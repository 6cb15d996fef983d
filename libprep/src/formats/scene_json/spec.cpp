#include "formats/scene_json/spec.h"

#include <cmath>

namespace prep::detail {
namespace {

using schema::choice;
using schema::dictionary;
using schema::Field;
using schema::flag;
using schema::Json;
using schema::list;
using schema::name;
using schema::number;
using schema::numbers;
using schema::object;
using schema::Outcome;
using schema::Problem;
using schema::required;
using schema::Table;
using schema::text;
using schema::whole;
using schema::word;

constexpr double huge = 1e30;  // coordinates and intensities: within float, squares within double

template <class T, class Value>
Field<T> optional_number(std::string key, std::optional<Value> T::*member, double least,
                         double greatest) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                double read = 0;
                if (Outcome problem = schema::read_number(value, pointer, least, greatest, read))
                    return problem;
                out.*member = read;
                return {};
            }};
}

template <class T>
Field<T> optional_whole(std::string key, std::optional<int> T::*member, int least, int greatest) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                double read = 0;
                if (Outcome problem = schema::read_number(value, pointer, least, greatest, read))
                    return problem;
                if (read != std::floor(read))
                    return Problem{pointer, "expected a whole number, found " + value.dump()};
                out.*member = static_cast<int>(read);
                return {};
            }};
}

template <class T>
Field<T> optional_point(std::string key, std::optional<glm::dvec3> T::*member) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                glm::dvec3 read{0};
                if (Outcome problem = schema::read_numbers(value, pointer, 3, -huge, huge, &read.x))
                    return problem;
                out.*member = read;
                return {};
            }};
}

float linear(int level) {
    const double c = level / 255.0;
    return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

// "#rrggbb" (sRGB), [r, g, b] (linear) or one number for grey (linear).
Outcome read_color(const Json& value, const std::string& pointer, double greatest, glm::vec3& out) {
    if (value.is_string()) {
        const std::string hex = value.get<std::string>();
        bool good = hex.size() == 7 && hex[0] == '#';
        for (std::size_t i = 1; good && i < 7; ++i) good = hex_digit(hex[i]) >= 0;
        if (!good)
            return Problem{pointer, "expected a colour such as \"#ff8800\", found '" + hex + "'"};
        for (int i = 0; i < 3; ++i)
            out[i] = linear(hex_digit(hex[std::size_t(1 + 2 * i)]) * 16 +
                            hex_digit(hex[std::size_t(2 + 2 * i)]));
        return {};
    }
    double read[3];
    if (value.is_number()) {
        if (Outcome problem = schema::read_number(value, pointer, 0, greatest, read[0]))
            return problem;
        out = glm::vec3(static_cast<float>(read[0]));
        return {};
    }
    if (!value.is_array() || value.size() != 3)
        return schema::wrong_type(value, pointer,
                                  "a colour: \"#rrggbb\", [r, g, b] or one number for grey");
    if (Outcome problem = schema::read_numbers(value, pointer, 3, 0, greatest, read))
        return problem;
    for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(read[i]);
    return {};
}

template <class T>
Field<T> color(std::string key, std::function<glm::vec3&(T&)> where, double greatest) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                return read_color(value, pointer, greatest, where(out));
            }};
}

const std::vector<std::pair<std::string, Wrap>> wraps = {{"repeat", Wrap::repeat},
                                                         {"mirror", Wrap::mirror},
                                                         {"clamp", Wrap::clamp},
                                                         {"border", Wrap::border}};

template <class T>
Field<T> optional_wrap(std::string key, std::optional<Wrap> T::*member) {
    return choice<T>(
        std::move(key), member,
        std::vector<std::pair<std::string, std::optional<Wrap>>>(wraps.begin(), wraps.end()));
}

Table<TextureSpec> texture_table() {
    using T = TextureSpec;
    return {
        required(name("file", &T::file)),
        choice("wrap", &T::wrap, wraps),
        optional_wrap("wrap_u", &T::wrap_u),
        optional_wrap("wrap_v", &T::wrap_v),
        choice("mag", &T::mag, {{"nearest", Filter::nearest}, {"linear", Filter::linear}}),
        choice("min", &T::min, {{"nearest", Filter::nearest}, {"linear", Filter::linear}}),
        choice("mip", &T::mip,
               {{"none", MipFilter::none},
                {"nearest", MipFilter::nearest},
                {"linear", MipFilter::linear}}),
    };
}

Table<MapSpec> map_table() {
    using T = MapSpec;
    const auto of_ref = [](Field<TextureRef> inner) {
        return Field<T>{inner.key,
                        [read = inner.read](const Json& value, const std::string& pointer, T& out) {
                            return read(value, pointer, out.ref);
                        }};
    };
    return {
        required(name("texture", &T::texture)),
        of_ref(whole("uv_set", &TextureRef::uv_set, 0, 7)),
        of_ref(numbers("offset", &TextureRef::offset, -1e6, 1e6)),
        of_ref(numbers("scale", &TextureRef::scale, -1e6, 1e6)),
        number("rotate", &T::rotate, -360, 360),
        of_ref(number("strength", &TextureRef::strength, -1e3, 1e3)),
    };
}

Field<MaterialSpec> map_field(const MapSlot& slot) {
    const auto member = slot.spec;
    return {
        slot.key,
        [member](const Json& value, const std::string& pointer, MaterialSpec& out) -> Outcome {
            MapSpec map;
            if (value.is_string()) {  // the texture's name alone
                map.texture.pointer = pointer;
                if (Outcome problem = schema::read_text(value, pointer, map.texture.text))
                    return problem;
            } else if (Outcome problem = schema::read_object(value, pointer, map_table(), map)) {
                return problem;
            }
            out.*member = std::move(map);
            return {};
        }};
}

Table<MaterialSpec> material_table() {
    using T = MaterialSpec;
    const auto of_material = [](Field<Material> inner) {
        return Field<T>{inner.key,
                        [read = inner.read](const Json& value, const std::string& pointer, T& out) {
                            return read(value, pointer, out.material);
                        }};
    };
    Table<T> table = {
        color<T>(
            "ambient", [](T& m) -> glm::vec3& { return m.material.ambient; }, 1e6),
        Field<T>{"diffuse",
                 [](const Json& value, const std::string& pointer, T& out) -> Outcome {
                     glm::vec3 read{0};
                     if (Outcome problem = read_color(value, pointer, 1, read)) return problem;
                     out.material.diffuse = glm::vec4(read, 1);
                     return {};
                 }},
        color<T>(
            "specular", [](T& m) -> glm::vec3& { return m.material.specular; }, 1),
        color<T>(
            "emissive", [](T& m) -> glm::vec3& { return m.material.emissive; }, 1e6),
        of_material(number("shininess", &Material::shininess, 0, 1e6)),
        number("opacity", &T::opacity, 0, 1),
        of_material(flag("unlit", &Material::unlit)),
        of_material(flag("double_sided", &Material::double_sided)),
        of_material(choice("alpha_mode", &Material::alpha_mode,
                           {{"opaque", AlphaMode::opaque},
                            {"mask", AlphaMode::mask},
                            {"blend", AlphaMode::blend}})),
        of_material(number("alpha_cutoff", &Material::alpha_cutoff, 0, 1)),
        of_material(
            choice("normal_map_space", &Material::normal_map_space,
                   {{"tangent", NormalMapSpace::tangent}, {"object", NormalMapSpace::object}})),
        of_material(flag("normal_map_flip_green", &Material::normal_map_flip_green)),
    };
    for (const MapSlot& slot : map_slots) table.push_back(map_field(slot));
    return table;
}

Table<ShapeSpec> shape_table() {
    using T = ShapeSpec;
    return {
        required(choice("kind", &T::kind,
                        {{"plane", ShapeKind::plane},
                         {"box", ShapeKind::box},
                         {"sphere", ShapeKind::sphere},
                         {"cylinder", ShapeKind::cylinder},
                         {"torus", ShapeKind::torus}})),
        numbers("size", &T::size, 1 / huge, huge),
        number("radius", &T::radius, 1 / huge, huge),
        number("height", &T::height, 1 / huge, huge),
        number("tube", &T::tube, 1 / huge, huge),
        whole("segments", &T::segments, 1, 1u << 24),
        whole("rings", &T::rings, 1, 1u << 24),
    };
}

bool has_key(ShapeKind kind, const std::string& key) {
    const bool box = kind == ShapeKind::box, plane = kind == ShapeKind::plane;
    const bool cylinder = kind == ShapeKind::cylinder;
    if (key == "size") return box || plane;
    if (key == "radius") return !box && !plane;
    if (key == "height") return cylinder;
    if (key == "tube") return kind == ShapeKind::torus;
    if (key == "segments") return !box;
    if (key == "rings") return !box && !cylinder;
    return true;
}

Table<MeshSpec> mesh_table() {
    using T = MeshSpec;
    return {
        name("file", &T::file),
        Field<T>{"shape",
                 [](const Json& value, const std::string& pointer, T& out) -> Outcome {
                     ShapeSpec shape;
                     if (Outcome problem =
                             schema::read_object(value, pointer, shape_table(), shape))
                         return problem;
                     for (const auto& [key, item] : value.items())
                         if (!has_key(shape.kind, key))
                             return Problem{pointer + "/" + pointer_key(key),
                                            "a shape of this kind has no '" + key + "'"};
                     out.shape = shape;
                     return {};
                 }},
        name("material", &T::material),
        Field<T>{"materials",
                 [](const Json& value, const std::string& pointer, T& out) -> Outcome {
                     if (!value.is_object())
                         return schema::wrong_type(value, pointer, "an object of names");
                     for (const auto& [key, item] : value.items()) {
                         schema::Name to{{}, pointer + "/" + pointer_key(key)};
                         if (Outcome problem = schema::read_text(item, to.pointer, to.text))
                             return problem;
                         out.replaced.emplace_back(key, std::move(to));
                     }
                     return {};
                 }},
    };
}

Table<NodeSpec> node_table() {
    using T = NodeSpec;
    const auto of_transform = [](Field<TransformSpec> inner) {
        return Field<T>{inner.key,
                        [read = inner.read](const Json& value, const std::string& pointer, T& out) {
                            return read(value, pointer, out.transform);
                        }};
    };
    return {
        name("name", &T::name),
        name("parent", &T::parent),
        name("mesh", &T::mesh),
        of_transform(optional_point("translate", &TransformSpec::translate)),
        of_transform(optional_point("rotate", &TransformSpec::rotate)),
        Field<T>{"scale",
                 [](const Json& value, const std::string& pointer, T& out) -> Outcome {
                     glm::dvec3 read{1};
                     Outcome problem;
                     if (value.is_array())
                         problem = schema::read_numbers(value, pointer, 3, -huge, huge, &read.x);
                     else
                         problem = schema::read_number(value, pointer, -huge, huge, read.x);
                     if (problem) return problem;
                     out.transform.scale = value.is_array() ? read : glm::dvec3(read.x);
                     return {};
                 }},
        Field<T>{"matrix",
                 [](const Json& value, const std::string& pointer, T& out) -> Outcome {
                     double m[16];
                     if (Outcome problem = schema::read_numbers(value, pointer, 16, -huge, huge, m))
                         return problem;
                     if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
                         return Problem{pointer,
                                        "the last row (entries 3, 7, 11, 15; columns come first) "
                                        "must be 0, 0, 0, 1"};
                     glm::dmat4 matrix;
                     for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = m[i];
                     out.transform.matrix = matrix;
                     return {};
                 }},
    };
}

Table<LightSpec> light_table() {
    using T = LightSpec;
    return {
        name("name", &T::name),
        required(choice("kind", &T::kind,
                        {{"ambient", LightKind::ambient},
                         {"directional", LightKind::directional},
                         {"point", LightKind::point},
                         {"spot", LightKind::spot}})),
        color<T>(
            "color", [](T& l) -> glm::vec3& { return l.color; }, 1e6),
        number("intensity", &T::intensity, 0, 1e9),
        optional_point("direction", &T::direction),
        optional_point("position", &T::position),
        number("range", &T::range, 0, huge),
        optional_number("inner_cone", &T::inner_cone, 0, 90),
        optional_number("outer_cone", &T::outer_cone, 0, 90),
    };
}

Table<OrbitSpec> orbit_table() {
    using T = OrbitSpec;
    return {
        number("azimuth", &T::azimuth, -360, 360),
        number("elevation", &T::elevation, -90, 90),
        number("distance", &T::distance, 0.01, 1e6),
    };
}

Table<CameraSpec> camera_table() {
    using T = CameraSpec;
    return {
        optional_point("position", &T::position),
        optional_point("target", &T::target),
        numbers("up", &T::up, -huge, huge),
        optional_number("fov", &T::fov, 0.01, 179),
        optional_number("height", &T::height, 1e-30, huge),
        number("near", &T::near, 1e-30, huge),
        number("far", &T::far, 0, huge),
        object("orbit", &T::orbit, orbit_table()),
    };
}

Table<PictureSettings> picture_table() {
    using T = PictureSettings;
    return {
        Field<T>{"size",
                 [](const Json& value, const std::string& pointer, T& out) -> Outcome {
                     double read[2];
                     if (Outcome problem = schema::read_numbers(value, pointer, 2, 1, 32768, read))
                         return problem;
                     if (read[0] != std::floor(read[0]) || read[1] != std::floor(read[1]))
                         return Problem{pointer, "expected whole numbers, found " + value.dump()};
                     out.size = glm::uvec2(static_cast<std::uint32_t>(read[0]),
                                           static_cast<std::uint32_t>(read[1]));
                     return {};
                 }},
        word("shading", &T::shading, {"flat", "gouraud", "phong", "normal-mapped"}),
        Field<T>{"background",
                 [](const Json& value, const std::string& pointer, T& out) -> Outcome {
                     glm::vec3 read{0};
                     if (Outcome problem = read_color(value, pointer, 1e6, read)) return problem;
                     out.background = read;
                     return {};
                 }},
        word("cull", &T::cull, {"by-material", "back", "front", "none"}),
        word("filter", &T::filter,
             {"sampler", "nearest", "bilinear", "nearest-mip", "trilinear", "bicubic",
              "anisotropic", "ripmap", "ewa"}),
        Field<T>{
            "samples",
            [](const Json& value, const std::string& pointer, T& out) -> Outcome {
                for (const int offered : {1, 2, 4, 8, 16})
                    if (value.is_number() && value == offered) {
                        out.samples = offered;
                        return {};
                    }
                return Problem{pointer, "expected 1, 2, 4, 8 or 16 samples, found " + value.dump()};
            }},
        optional_whole("supersample", &T::supersample, 1, 16),
        word("coverage", &T::coverage, {"samples", "area"}),
        optional_whole("max_anisotropy", &T::max_anisotropy, 1, 16),
        word("tone_map", &T::tone_map, {"off", "reinhard"}),
        optional_number("exposure", &T::exposure, 1e-6, 1e6),
    };
}

}  // namespace

const Table<SceneSpec>& scene_table() {
    using T = SceneSpec;
    static const Table<T> table = {
        required(whole("meshprep", &T::version, 1, 1000)),
        text("name", &T::name),
        dictionary("textures", &T::textures, texture_table()),
        dictionary("materials", &T::materials, material_table()),
        required(dictionary("meshes", &T::meshes, mesh_table())),
        list("nodes", &T::nodes, node_table()),
        list("lights", &T::lights, light_table()),
        object("camera", &T::camera, camera_table()),
        object("picture", &T::picture, picture_table()),
    };
    return table;
}

}  // namespace prep::detail
