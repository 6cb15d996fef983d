// Textures made from functions of the unit square (u to the right, v down), as PNG bytes.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string>

namespace samples {

struct TextureSize {
    int width = 128, height = 128;            // texels
    double metres_wide = 1, metres_high = 1;  // what the texture covers on the surface
};

using HeightFunction = std::function<double(double u, double v)>;     // metres
using ColorFunction = std::function<glm::dvec3(double u, double v)>;  // 0…1, sRGB-encoded

// Tangent-space normals of a height function by central differences over one texel, x to the right
// and y up (glTF), 8 bits. The function is evaluated half a texel outside the square: it repeats or
// continues there.
std::string normal_map_png(const TextureSize& size, const HeightFunction& height);

std::string color_png(const TextureSize& size, const ColorFunction& color);

}  // namespace samples
