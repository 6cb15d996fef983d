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
Field<T> optional_point(std::string key, std::optional<glm::dvec3> T::*member) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                glm::dvec3 read{0};
                if (Outcome problem = schema::read_numbers(value, pointer, 3, -huge, huge, &read.x))
                    return problem;
                out.*member = read;
                return {};
            }};
}

// "#rrggbb" (sRGB), [r, g, b] (linear) or one number for grey (linear).
Outcome read_color(const Json& value, const std::string& pointer, double greatest, glm::vec3& out) {
    if (value.is_string()) {
        const std::string hex = value.get<std::string>();
        const std::optional<glm::vec3> color = color_from_hex(hex);
        if (!color)
            return Problem{pointer, "expected a colour such as \"#ff8800\", found '" + hex + "'"};
        out = *color;
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

Table<TextureSpec> texture_table() {
    using T = TextureSpec;
    return {
        required(name("file", &T::file)), choice("wrap", &T::wrap), choice("wrap_u", &T::wrap_u),
        choice("wrap_v", &T::wrap_v),     choice("mag", &T::mag),   choice("min", &T::min),
        choice("mip", &T::mip),
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
        optional_number("strength", &T::strength, -1e3, 1e3),
    };
}

Field<MaterialSpec> map_field(const MaterialMap& row) {
    return {
        row.scene_key,
        [kind = std::size_t(row.kind)](const Json& value, const std::string& pointer,
                                       MaterialSpec& out) -> Outcome {
            MapSpec map;
            if (value.is_string()) {  // the texture's name alone
                map.texture.pointer = pointer;
                if (Outcome problem = schema::read_text(value, pointer, map.texture.text))
                    return problem;
            } else if (Outcome problem = schema::read_object(value, pointer, map_table(), map)) {
                return problem;
            }
            out.maps[kind] = std::move(map);
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
        of_material(choice("alpha_mode", &Material::alpha_mode)),
        of_material(number("alpha_cutoff", &Material::alpha_cutoff, 0, 1)),
        of_material(choice("normal_map_space", &Material::normal_map_space)),
        of_material(flag("normal_map_flip_green", &Material::normal_map_flip_green)),
        of_material(number("displacement_scale", &Material::displacement_scale, -1e6, 1e6)),
        of_material(number("displacement_midlevel", &Material::displacement_midlevel, -1e6, 1e6)),
        of_material(choice("displacement_kind", &Material::displacement_kind)),
    };
    for (const MaterialMap& row : material_maps)
        if (row.scene_key != nullptr) table.push_back(map_field(row));
    return table;
}

Table<ShapeSpec> shape_table() {
    using T = ShapeSpec;
    return {
        required(choice("kind", &T::kind)),           numbers("size", &T::size, 1 / huge, huge),
        number("radius", &T::radius, 1 / huge, huge), number("height", &T::height, 1 / huge, huge),
        number("tube", &T::tube, 1 / huge, huge),     whole("segments", &T::segments, 1, 1u << 24),
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

// What encloses nothing is no shape; 0 stands for what is not said.
Outcome check_parts(const ShapeSpec& shape, const std::string& pointer) {
    if (shape.kind == ShapeKind::plane) return {};
    const auto fewer = [&](std::uint32_t parts, std::uint32_t fewest, const char* key) -> Outcome {
        if (parts == 0 || parts >= fewest) return {};
        return Problem{pointer + "/" + key, "is " + std::to_string(parts) + ", fewer than the " +
                                                std::to_string(fewest) + " that make such a shape"};
    };
    if (Outcome problem = fewer(shape.segments, 3, "segments")) return problem;
    return fewer(shape.rings, shape.kind == ShapeKind::torus ? 3 : 2, "rings");
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
                     if (Outcome problem = check_parts(shape, pointer)) return problem;
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
        required(choice("kind", &T::kind)),
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
        optional_point("up", &T::up),
        optional_number("fov", &T::fov, 0.01, 179),
        optional_number("height", &T::height, 1e-30, huge),
        optional_number("near", &T::near, 1e-30, huge),
        optional_number("far", &T::far, 0, huge),
        object("orbit", &T::orbit, orbit_table()),
    };
}

// The value of one of the picture's choices.
using Choices = RenderChoices;
template <class E>
Outcome read_value(const Json& value, const std::string& pointer, E Choices::*member, Named,
                   Choices& out) {
    return schema::read_named(value, pointer, out.*member);
}
template <class Number>
Outcome read_value(const Json& value, const std::string& pointer, Number Choices::*member,
                   const Range& range, Choices& out) {
    double read = 0;
    if (Outcome problem = schema::read_number(value, pointer, range.least, range.greatest, read))
        return problem;
    if (std::is_integral_v<Number> && read != std::floor(read))
        return Problem{pointer, "expected a whole number, found " + value.dump()};
    out.*member = static_cast<Number>(read);
    return {};
}
Outcome read_value(const Json& value, const std::string& pointer, float Choices::*member,
                   const RangeOrAuto& range, Choices& out) {
    if (value == "auto") {
        out.*member = 0;
        return {};
    }
    return read_value(value, pointer, member, Range{range.least, range.greatest}, out);
}
Outcome read_value(const Json& value, const std::string& pointer, int Choices::*member,
                   const OneOf& offered, Choices& out) {
    std::string list;
    for (const int n : offered.values) {
        if (value.is_number() && value == n) {
            out.*member = n;
            return {};
        }
        list += (list.empty()                 ? ""
                 : n == offered.values.back() ? " or "
                                              : ", ") +
                std::to_string(n);
    }
    return Problem{pointer, "expected " + list + ", found " + value.dump()};
}
Outcome read_value(const Json& value, const std::string& pointer, glm::vec3 Choices::*member,
                   Linear, Choices& out) {
    return read_color(value, pointer, 1e6, out.*member);
}
using ExtentMember = std::uint32_t Choices::*;
Outcome read_value(const Json& value, const std::string& pointer,
                   std::pair<ExtentMember, ExtentMember> member, Pixels pixels, Choices& out) {
    double read[2];
    if (Outcome problem = schema::read_numbers(value, pointer, 2, 1, pixels.greatest, read))
        return problem;
    if (read[0] != std::floor(read[0]) || read[1] != std::floor(read[1]))
        return Problem{pointer, "expected whole numbers, found " + value.dump()};
    out.*member.first = static_cast<std::uint32_t>(read[0]);
    out.*member.second = static_cast<std::uint32_t>(read[1]);
    return {};
}

Table<RenderWishes> picture_table() {
    Table<RenderWishes> table;
    for_each_render_choice([&](std::string_view key, auto member, auto values, const char*) {
        table.push_back(
            {std::string(key),
             [=](const Json& value, const std::string& pointer, RenderWishes& out) -> Outcome {
                 out.given.insert(key);
                 return read_value(value, pointer, member, values, out.choices);
             }});
    });
    return table;
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
