// Blinn-Phong (Blinn 1977) from ambient, directional, point and spot lights, in linear light.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rast/view.h"

namespace rast {

// Light with its place relative to the eye, in world axes, in float.
struct ShadingLight {
    prep::LightKind kind;
    glm::vec3 position, direction;  // direction: unit, the way the light travels
    glm::vec3 color;
    float inverse_range = 0;                // 0: no limit
    float cone_scale = 0, cone_offset = 0;  // spot: clamp(cos · scale + offset)²
};

std::vector<ShadingLight> shading_lights(std::span<const LightInstance> lights,
                                         const glm::dvec3& eye);

struct LightSum {
    glm::vec3 ambient{0.0f};   // arriving from everywhere
    glm::vec3 diffuse{0.0f};   // Σ colour · (n·l)
    glm::vec3 specular{0.0f};  // Σ colour · (n·h)^shininess
};

// `position` relative to the eye, `normal` and `to_eye` unit, same axes.
LightSum illuminate(std::span<const ShadingLight> lights, const glm::vec3& position,
                    const glm::vec3& normal, const glm::vec3& to_eye, float shininess);

// (n·h)^shininess from sin² = |n×h|²: near a highlight's centre 1 − (n·h)² would cancel. 0^0 is 1.
// Relative error below 1e-6 up to shininess 1e5 (SpecularPower.KeepsItsDigitsUpToSharpHighlights).
float specular_power(const glm::vec3& normal, const glm::vec3& half, float shininess);

}  // namespace rast
