#include "shade.h"

#include <algorithm>
#include <cmath>

namespace rast {
namespace {

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
    // In double: lengths of 1e-30 and 1e30 have squares beyond float.
    const glm::dvec3 d(v);
    const double squared = glm::dot(d, d);
    if (!(squared > 0) || !std::isfinite(squared)) return otherwise;
    return glm::vec3(d / std::sqrt(squared));
}

// a0·b0 + a1·b1 + a2·b2 anchored at a0: a constant attribute stays bit-constant.
template <class T>
T mix3(const T& a0, const T& a1, const T& a2, const glm::vec3& b) {
    return a0 + (a1 - a0) * b.y + (a2 - a0) * b.z;
}

// UV through KHR_texture_transform: scale, then rotation, then offset.
glm::vec2 transformed(const prep::TextureRef& ref, const glm::vec2& uv, bool direction) {
    glm::vec2 p = uv * ref.scale;
    if (ref.rotation != 0) {
        const float c = std::cos(ref.rotation), s = std::sin(ref.rotation);
        p = {c * p.x + s * p.y, -s * p.x + c * p.y};
    }
    return direction ? p : p + ref.offset;
}

}  // namespace

struct Shader::Point {
    const Instance& instance;
    const SetupTriangle& triangle;
    const prep::Material& material;
    Barycentrics b;
    glm::vec3 position{0.0f}, to_eye{0.0f};
};

Shader::Shader(const prep::PreparedScene& scene, const RenderPlan& plan, const Textures& textures)
    : scene_(scene),
      plan_(plan),
      textures_(textures),
      lights_(shading_lights(plan.lights, plan.view.eye())),
      perspective_(plan.view.perspective),
      backward_(-plan.view.forward()) {}

const prep::Material& Shader::material_of(const Instance& instance, const SetupTriangle& t) const {
    const std::uint32_t m = instance.mesh->ranges[instance.range_of[t.triangle]].material;
    return m < scene_.scene.materials.size() ? scene_.scene.materials[m] : default_material_;
}

glm::vec4 Shader::sample(const prep::TextureRef& ref, const Point& point,
                         const glm::vec4& otherwise) const {
    if (!ref || !plan_.request.textures || ref.texture >= textures_.by_index.size())
        return otherwise;
    const MipTexture* texture = textures_.by_index[ref.texture].get();
    const prep::VertexMesh& mesh = *point.instance.mesh;
    if (!texture || ref.uv_set >= mesh.uvs.size() || mesh.uvs[ref.uv_set].empty()) return otherwise;
    const std::vector<glm::vec2>& uvs = mesh.uvs[ref.uv_set];
    const glm::vec2 a = uvs[point.triangle.vertices[0]], b = uvs[point.triangle.vertices[1]],
                    c = uvs[point.triangle.vertices[2]];
    const glm::vec2 uv = mix3(a, b, c, point.b.value);
    Footprint footprint;
    footprint.dx = transformed(ref, (b - a) * point.b.dx.y + (c - a) * point.b.dx.z, true);
    footprint.dy = transformed(ref, (b - a) * point.b.dy.y + (c - a) * point.b.dy.z, true);
    return texture->sample(transformed(ref, uv, false), footprint, plan_.request.filter);
}

void Shader::light_vertices(Instance& instance, bool two_sided) const {
    const std::size_t n = instance.positions.size();
    instance.lit.assign(n, {});
    if (two_sided) instance.lit_behind.assign(n, {});
    if (instance.normals.empty()) return;
    // A vertex can carry materials of different shininess only if parts were not split; prepare()
    // splits them, so the first triangle's material speaks for the vertex.
    std::vector<float> shininess(n, default_material_.shininess);
    for (std::size_t t = 0; t < instance.mesh->triangle_count(); ++t) {
        const std::uint32_t m = instance.mesh->ranges[instance.range_of[t]].material;
        if (m >= scene_.scene.materials.size()) continue;
        const prep::Material& material = scene_.scene.materials[m];
        const float s =
            material.metallic_roughness
                ? prep::blinn_phong(glm::vec3(0.0f), material.metallic, material.roughness)
                      .shininess
                : material.shininess;
        for (int k = 0; k < 3; ++k) shininess[instance.mesh->indices[3 * t + k]] = s;
    }
    for (std::size_t v = 0; v < n; ++v) {
        const glm::vec3 p = instance.positions[v];
        const glm::vec3 to_eye = perspective_ ? unit_or(-p, backward_) : backward_;
        instance.lit[v] = illuminate(lights_, p, instance.normals[v], to_eye, shininess[v]);
        if (two_sided)
            instance.lit_behind[v] =
                illuminate(lights_, p, -instance.normals[v], to_eye, shininess[v]);
    }
}

glm::vec3 Shader::normal_at(const Point& point) const {
    const Instance& in = point.instance;
    const auto& v = point.triangle.vertices;
    const glm::vec3 p0 = in.positions[v[0]];
    // The vertices are ordered to run clockwise on the screen: against the side that is seen.
    glm::vec3 geometric = unit_or(glm::vec3(glm::cross(glm::dvec3(in.positions[v[2]] - p0),
                                                       glm::dvec3(in.positions[v[1]] - p0))),
                                  point.to_eye);
    if (plan_.request.shading == Shading::flat || in.normals.empty()) return geometric;
    const glm::vec3 sum = mix3(in.normals[v[0]], in.normals[v[1]], in.normals[v[2]], point.b.value);
    // Seen from behind, a surface is lit on the side that is seen.
    const glm::vec3 facing = point.triangle.back ? -sum : sum;
    // Opposite normals pass through zero: the geometric normal takes over.
    const glm::vec3 interpolated = unit_or(facing, geometric);
    if (plan_.request.shading != Shading::normal_mapped || !point.material.normal_map)
        return interpolated;
    return mapped_normal(point, geometric, sum);
}

glm::vec3 Shader::mapped_normal(const Point& point, const glm::vec3& geometric,
                                const glm::vec3& sum) const {
    const Instance& in = point.instance;
    const prep::TextureRef& map = point.material.normal_map;
    const glm::vec3 plain = unit_or(point.triangle.back ? -sum : sum, geometric);
    const bool object_space = point.material.normal_map_space == prep::NormalMapSpace::object;
    if (!object_space && in.tangents.empty()) return plain;
    // A flat map where there is none to read.
    const glm::vec4 texel = sample(map, point, glm::vec4(0.5f, 0.5f, 1.0f, 1.0f));
    glm::vec3 m = glm::vec3(texel) * 2.0f - 1.0f;
    if (point.material.normal_map_flip_green) m.y = -m.y;
    glm::vec3 world;
    if (object_space) {
        world = in.normal_matrix * m;
    } else {
        m.x *= map.strength;
        m.y *= map.strength;
        // Interpolated and not normalised, as MikkTSpace's bakers do.
        const auto& v = point.triangle.vertices;
        const glm::vec3 n = sum;
        const glm::vec3 t = mix3(glm::vec3(in.tangents[v[0]]), glm::vec3(in.tangents[v[1]]),
                                 glm::vec3(in.tangents[v[2]]), point.b.value);
        const glm::vec3 b = in.tangents[v[0]].w * in.handedness * glm::cross(n, t);
        world = m.x * t + m.y * b + m.z * n;
    }
    if (point.triangle.back) world = -world;
    return unit_or(world, plain);
}

bool Shader::masked(const Instance& instance, const SetupTriangle& triangle) const {
    return material_of(instance, triangle).alpha_mode == prep::AlphaMode::mask;
}

bool Shader::covered(const Instance& instance, const SetupTriangle& triangle, std::int32_t x,
                     std::int32_t y) const {
    Point point{instance, triangle, material_of(instance, triangle),
                barycentrics(instance.screen, triangle, x, y)};
    const float alpha =
        point.material.diffuse.a * sample(point.material.diffuse_map, point, glm::vec4(1.0f)).a;
    return alpha >= point.material.alpha_cutoff;
}

glm::vec4 Shader::shade(const Instance& instance, const SetupTriangle& triangle, std::int32_t x,
                        std::int32_t y) const {
    const prep::Material& material = material_of(instance, triangle);
    Point point{instance, triangle, material, barycentrics(instance.screen, triangle, x, y)};
    const auto& v = triangle.vertices;
    glm::vec4 base = material.diffuse * sample(material.diffuse_map, point, glm::vec4(1.0f));
    if (!instance.mesh->colors.empty()) {
        const std::vector<glm::vec4>& colors = instance.mesh->colors[0];
        base *= mix3(colors[v[0]], colors[v[1]], colors[v[2]], point.b.value);
    }
    const glm::vec3 emissive =
        material.emissive * glm::vec3(sample(material.emissive_map, point, glm::vec4(1.0f)));
    if (material.unlit) return {glm::vec3(base) + emissive, 1.0f};

    prep::BlinnPhong lobe{glm::vec3(base), material.specular, material.shininess};
    if (material.metallic_roughness) {
        const glm::vec4 mr = sample(material.metallic_roughness_map, point, glm::vec4(1.0f));
        lobe =
            prep::blinn_phong(glm::vec3(base), material.metallic * mr.b, material.roughness * mr.g);
    } else {
        lobe.specular *= glm::vec3(sample(material.specular_map, point, glm::vec4(1.0f)));
    }
    float open = 1;
    if (material.occlusion_map) {
        const float r = sample(material.occlusion_map, point, glm::vec4(1.0f)).r;
        open = 1 + material.occlusion_map.strength * (r - 1);
    }

    LightSum light;
    if (plan_.request.shading == Shading::gouraud && !instance.lit.empty() &&
        !instance.normals.empty()) {
        const std::vector<LightSum>& lit = triangle.back ? instance.lit_behind : instance.lit;
        const LightSum &l0 = lit[v[0]], &l1 = lit[v[1]], &l2 = lit[v[2]];
        light.ambient = l0.ambient;
        light.diffuse = mix3(l0.diffuse, l1.diffuse, l2.diffuse, point.b.value);
        light.specular = mix3(l0.specular, l1.specular, l2.specular, point.b.value);
    } else {
        point.position = mix3(instance.positions[v[0]], instance.positions[v[1]],
                              instance.positions[v[2]], point.b.value);
        point.to_eye = perspective_ ? unit_or(-point.position, backward_) : backward_;
        light = illuminate(lights_, point.position, normal_at(point), point.to_eye, lobe.shininess);
    }
    const glm::vec3 color = emissive + light.ambient * material.ambient * glm::vec3(base) * open +
                            light.diffuse * lobe.diffuse + light.specular * lobe.specular;
    return {color, 1.0f};
}

}  // namespace rast
