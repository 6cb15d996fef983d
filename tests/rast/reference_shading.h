// What surfaces look like under lights, written anew from what is published: lights from the glTF
// extension KHR_lights_punctual, materials from glTF 2.0 and docs/conventions.md. All in double,
// none of it from the code under test.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "oracles.h"
#include "simd_levels.h"

namespace test {

struct Arriving {
    glm::dvec3 towards{0.0}, color{0.0};  // towards the light, unit
};

// KHR_lights_punctual: 1/r², the recommended window where there is a range, and its reference code
// for the falloff between the cones.
inline Arriving arriving(const LightInstance& light, const glm::dvec3& p) {
    const glm::dvec3 color(light.color);
    if (light.kind == LightKind::directional) return {-light.direction, color};
    const glm::dvec3 offset = light.position - p;
    const double r = glm::length(offset);
    const glm::dvec3 towards = offset / r;
    double attenuation = 1 / (r * r);
    if (light.range > 0)
        attenuation *= std::max(std::min(1 - std::pow(r / double(light.range), 4), 1.0), 0.0);
    if (light.kind == LightKind::spot) {
        const double inner = std::cos(double(light.inner_cone)),
                     outer = std::cos(double(light.outer_cone));
        const double scale = 1 / std::max(0x1p-20, inner - outer), offset_of_it = -outer * scale;
        const double cosine = glm::dot(light.direction, -towards);
        const double angular = std::clamp(cosine * scale + offset_of_it, 0.0, 1.0);
        attenuation *= angular * angular;
    }
    return {towards, color * attenuation};
}

// A surface at one place: what its material and its maps come to.
struct Surface {
    glm::dvec3 diffuse{0.0}, specular{0.0};
    glm::dvec3 ambient{0.0};  // what it makes of ambient light
    glm::dvec3 emissive{0.0};
    double shininess = 0;
};

// docs/conventions.md, "Blinn-Phong from metallic-roughness".
inline Surface from_metallic_roughness(const glm::dvec3& base, double metallic, double roughness) {
    const double alpha = roughness * roughness;
    Surface s;
    s.shininess = alpha > 0 ? std::min(2 / (alpha * alpha) - 2, 4998.0) : 4998.0;
    const glm::dvec3 reflectance = glm::dvec3(0.04) + (base - glm::dvec3(0.04)) * metallic;
    s.specular = reflectance * ((s.shininess + 2) / 8 + 1 / (2 * s.shininess + 4));
    s.diffuse = base * (1 - metallic);
    s.ambient = base;
    return s;
}
inline Surface from_factors(const prep::Material& m) {
    Surface s;
    s.diffuse = glm::dvec3(glm::vec3(m.diffuse));
    s.specular = glm::dvec3(m.specular);
    s.shininess = double(m.shininess);
    s.ambient = s.diffuse * glm::dvec3(m.ambient);
    s.emissive = glm::dvec3(m.emissive);
    return s;
}

// docs/conventions.md, "Colour and light". `normal` and `to_eye` are unit.
inline glm::dvec3 reflected(const Surface& s, const std::vector<LightInstance>& lights,
                            const glm::dvec3& p, const glm::dvec3& normal,
                            const glm::dvec3& to_eye) {
    glm::dvec3 sum = s.emissive;
    for (const LightInstance& light : lights) {
        if (light.kind == LightKind::ambient) {
            sum += glm::dvec3(light.color) * s.ambient;
            continue;
        }
        const Arriving in = arriving(light, p);
        const double facing = glm::dot(normal, in.towards);
        if (!(facing > 0)) continue;
        const double n_h = std::max(0.0, glm::dot(normal, glm::normalize(in.towards + to_eye)));
        sum += in.color * (s.diffuse * facing + s.specular * std::pow(n_h, s.shininess));
    }
    return sum;
}

// IEC 61966-2-1.
inline double decoded_srgb(double x) {
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}
inline glm::dvec3 decoded_srgb(const glm::dvec3& c) {
    return {decoded_srgb(c.x), decoded_srgb(c.y), decoded_srgb(c.z)};
}

// Where the ray through a pixel's centre meets the plane z = 0.
struct Floor {
    glm::dvec3 position{0.0}, to_eye{0.0};
};
inline Floor floor_at(const rast::RenderRequest& request, std::uint32_t x, std::uint32_t y) {
    const Ray ray = ray_at(*request.view, request.width, request.height, x + 0.5, y + 0.5);
    return {ray.from - ray.direction * (ray.from.z / ray.direction.z),
            -glm::normalize(ray.direction)};
}

// [−extent, extent]² in z = 0, facing +z, UVs from 0 to 1, v downwards.
inline prep::VertexMesh floor_of(float extent) {
    prep::VertexMesh mesh = square();
    for (glm::vec3& p : mesh.positions) p *= extent;
    mesh.uvs = {{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
    return mesh;
}

// Draws on every instruction set and holds all pixels that are drawn against expected(x, y), which
// may be nothing where rounding decides. Returns how many pixels were compared on each.
template <class Expected>
std::size_t expect_pixels(const prep::PreparedScene& scene, rast::RenderRequest request,
                          double bound, const Expected& expected) {
    std::vector<std::optional<glm::dvec3>> wanted;
    for (std::uint32_t y = 0; y < request.height; ++y)
        for (std::uint32_t x = 0; x < request.width; ++x) wanted.push_back(expected(x, y));
    std::size_t compared = 0;
    for (const prep::SimdLevel level : every_level()) {
        request.simd = level;
        const rast::Frame frame = draw(scene, request);
        compared = 0;
        std::size_t wrong = 0;
        for (std::uint32_t y = 0; y < request.height; ++y)
            for (std::uint32_t x = 0; x < request.width; ++x) {
                const auto& e = wanted[std::size_t(y) * request.width + x];
                if (!e || !drawn(frame, x, y)) continue;
                ++compared;
                if (distance(pixel(frame, x, y), *e) <= bound) continue;  // NaN is not
                if (wrong++ > 0) continue;
                const glm::dvec3 c = pixel(frame, x, y);
                ADD_FAILURE() << prep::to_string(level) << ", pixel " << x << " " << y << ": "
                              << c.x << " " << c.y << " " << c.z << " instead of " << e->x << " "
                              << e->y << " " << e->z;
            }
        EXPECT_EQ(wrong, 0u) << "of " << compared << " pixels on " << prep::to_string(level);
    }
    return compared;
}

}  // namespace test
