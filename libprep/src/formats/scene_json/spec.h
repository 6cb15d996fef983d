// What the JSON scene's keys are read into, and the tables that say which keys there are.
#pragma once

#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "prep/scene_json.h"
#include "text/json_schema.h"

namespace prep::detail {

struct TextureSpec {
    schema::Name file;
    Wrap wrap = Wrap::repeat;
    std::optional<Wrap> wrap_u, wrap_v;
    Filter mag = Filter::linear, min = Filter::linear;
    MipFilter mip = MipFilter::linear;
};

struct MapSpec {
    schema::Name texture;
    TextureRef ref;
    double rotate = 0;  // degrees
    std::optional<double> strength;
};

struct MaterialSpec {
    Material material;
    float opacity = 1;
    std::optional<MapSpec> maps[std::size(material_maps)];
};

enum class ShapeKind { plane, box, sphere, cylinder, torus };
constexpr auto names_of(ShapeKind) {
    return std::to_array<EnumName<ShapeKind>>({{"plane", ShapeKind::plane},
                                               {"box", ShapeKind::box},
                                               {"sphere", ShapeKind::sphere},
                                               {"cylinder", ShapeKind::cylinder},
                                               {"torus", ShapeKind::torus}});
}

struct ShapeSpec {
    ShapeKind kind = ShapeKind::sphere;
    glm::vec3 size{1};
    float radius = 1, height = 2, tube = 0.25f;
    std::uint32_t segments = 0, rings = 0;  // 0: by kind
};

struct MeshSpec {
    schema::Name file;
    std::optional<ShapeSpec> shape;
    schema::Name material;
    std::vector<std::pair<std::string, schema::Name>> replaced;  // the file's material → ours
};

struct TransformSpec {
    std::optional<glm::dvec3> translate, rotate, scale;  // rotate: degrees about X, Y, Z
    std::optional<glm::dmat4> matrix;
};

struct NodeSpec {
    schema::Name name, parent, mesh;
    TransformSpec transform;
};

struct LightSpec {
    schema::Name name;
    LightKind kind = LightKind::directional;
    glm::vec3 color{1};
    float intensity = 1, range = 0;
    std::optional<glm::dvec3> direction, position;
    std::optional<double> inner_cone, outer_cone;  // degrees
};

struct OrbitSpec {
    double azimuth = 30, elevation = 20, distance = 1;
};

struct CameraSpec {
    std::optional<glm::dvec3> position, target;
    std::optional<glm::dvec3> up;
    std::optional<double> fov;     // degrees, vertical
    std::optional<double> height;  // orthographic
    std::optional<double> near, far;
    std::optional<OrbitSpec> orbit;
};

struct SceneSpec {
    std::uint32_t version = 0;
    std::string name;
    std::vector<schema::Named<TextureSpec>> textures;
    std::vector<schema::Named<MaterialSpec>> materials;
    std::vector<schema::Named<MeshSpec>> meshes;
    std::vector<schema::Named<NodeSpec>> nodes;
    std::vector<schema::Named<LightSpec>> lights;
    std::optional<CameraSpec> camera;
    RenderWishes picture;
};

const schema::Table<SceneSpec>& scene_table();

}  // namespace prep::detail
