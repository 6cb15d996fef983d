// Scenes, rays and lights that the tests of whole pictures share; all in double, none of it from
// the code under test.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "builders.h"
#include "prep/image.h"

namespace test {

using prep::LightKind;
using rast::LightInstance;
using rast::Shading;

inline LightInstance directional(const glm::dvec3& towards_light, const glm::vec3& color) {
    LightInstance light;
    light.direction = -glm::normalize(towards_light);
    light.color = color;
    return light;
}

inline LightInstance ambient(const glm::vec3& color) {
    LightInstance light;
    light.kind = LightKind::ambient;
    light.color = color;
    return light;
}

inline LightInstance point_light(const glm::dvec3& position, const glm::vec3& color) {
    LightInstance light;
    light.kind = LightKind::point;
    light.position = position;
    light.color = color;
    return light;
}

// Red from +x, green from +y, blue from +z: with a white, purely diffuse material the colour of a
// surface is its normal, where that has no negative component.
inline std::vector<LightInstance> normals_as_colours() {
    return {directional({1, 0, 0}, {1, 0, 0}), directional({0, 1, 0}, {0, 1, 0}),
            directional({0, 0, 1}, {0, 0, 1})};
}

inline prep::Material white() {
    prep::Material material;
    material.diffuse = glm::vec4(1.0f);
    material.specular = glm::vec3(0.0f);
    return material;
}

// The ray through a pixel's centre, in world space; the view is rigid.
struct Ray {
    glm::dvec3 from, direction;  // direction · forward = 1 for perspective
};
inline Ray ray_at(const rast::View& view, std::uint32_t width, std::uint32_t height, double x,
                  double y) {
    const glm::dmat3 to_world = glm::transpose(glm::dmat3(view.world_to_view));
    const double aspect = view.aspect > 0 ? view.aspect : double(width) / height;
    const double nx = 2 * x / width - 1, ny = 1 - 2 * y / height;
    if (view.perspective) {
        const double t = std::tan(view.yfov / 2);
        return {view.eye(), to_world * glm::dvec3(nx * t * aspect, ny * t, -1)};
    }
    const double h = view.half_height;
    return {view.eye() + to_world * glm::dvec3(nx * h * aspect, ny * h, 0), view.forward()};
}

// Blinn-Phong as the material's fields define it.
inline glm::dvec3 lit(const prep::Material& material, const std::vector<LightInstance>& lights,
                      const glm::dvec3& position, const glm::dvec3& normal,
                      const glm::dvec3& to_eye) {
    const glm::dvec3 diffuse(glm::vec3(material.diffuse));
    glm::dvec3 sum(0.0);
    for (const LightInstance& light : lights) {
        glm::dvec3 color(light.color);
        if (light.kind == LightKind::ambient) {
            sum += color * diffuse * glm::dvec3(material.ambient);
            continue;
        }
        glm::dvec3 l = -light.direction;
        if (light.kind == LightKind::point) {
            const glm::dvec3 offset = light.position - position;
            color /= glm::dot(offset, offset);
            l = glm::normalize(offset);
        }
        const double facing = glm::dot(normal, l);
        if (facing <= 0) continue;
        const double highlight = std::max(0.0, glm::dot(normal, glm::normalize(l + to_eye)));
        sum += color * (diffuse * facing + glm::dvec3(material.specular) *
                                               std::pow(highlight, double(material.shininess)));
    }
    return sum;
}

inline glm::dvec3 pixel(const rast::Frame& frame, std::uint32_t x, std::uint32_t y) {
    return glm::dvec3(glm::vec3(frame.color[std::size_t(y) * frame.width + x]));
}

inline bool drawn(const rast::Frame& frame, std::uint32_t x, std::uint32_t y) {
    return frame.color[std::size_t(y) * frame.width + x].a > 0;
}

inline double distance(const glm::dvec3& a, const glm::dvec3& b) {
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

inline prep::VertexMesh triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    prep::VertexMesh mesh;
    mesh.positions = {a, b, c};
    mesh.indices = {0, 1, 2};
    return mesh;
}

// [−1, 1]² in z = 0, facing +z.
inline prep::VertexMesh square() {
    prep::VertexMesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.tangents.assign(4, {1, 0, 0, 1});
    mesh.uvs = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

// Where a pixel's ray meets a triangle's plane: weights of the corners, in double.
inline glm::dvec3 weights_at(const Ray& ray, const glm::dvec3 p[3]) {
    const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
    const glm::dvec3 hit =
        ray.from + ray.direction * (glm::dot(p[0] - ray.from, n) / glm::dot(ray.direction, n));
    const double area = glm::dot(n, n);
    return {glm::dot(glm::cross(p[2] - p[1], hit - p[1]), n) / area,
            glm::dot(glm::cross(p[0] - p[2], hit - p[2]), n) / area,
            glm::dot(glm::cross(p[1] - p[0], hit - p[0]), n) / area};
}

// A texture of one colour, as a file would bring it: 16 bits keep the encoding error at 8e-6.
inline prep::ImageRef image_of(const glm::vec3& color, std::uint32_t extent = 1) {
    prep::Image image{extent, extent, 3, std::vector<float>(std::size_t{extent} * extent * 3)};
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = color[static_cast<int>(i % 3)];
    prep::ImageRef ref;
    ref.name = "memory.png";
    ref.bytes = *prep::encode_png(image, prep::PixelType::u16);
    return ref;
}

}  // namespace test
