// How much a light adds to a picture at most: what lets faint ones be left out.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "prep/material.h"
#include "rast/view.h"

namespace rast::detail {

// Of the texels that are read of a map. 1 is among them: a mesh that lacks the map takes that.
struct TexelRange {
    glm::dvec3 low{1.0}, high{1.0};
};
struct MaterialRanges {
    TexelRange diffuse, specular, metallic_roughness;
    glm::dvec3 colors{1.0};  // of vertices, the largest
};

// Bounds, by channel, what is seen of a point under white light of strength 1: the diffuse part and
// the highlight, each at its greatest. Infinite where a figure of the material is out of the way.
glm::dvec3 greatest_reflection(const prep::Material& material, const MaterialRanges& ranges);

// Of a light's strength from this distance on; infinite at 0. A spot's cone only takes from it.
double greatest_strength(const LightInstance& light, double distance);

// Which of the values, the smallest first, add up to no more than `allowed`. The largest stays.
std::vector<bool> smallest_within(const std::vector<double>& values, double allowed);

}  // namespace rast::detail
