// Pictures as they should be, by plain loops over samples or by exact areas. Pixel (0, 0) is the
// top left one; y runs down.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cost/measure/metrics.h"

namespace cost {

using Point2 = glm::vec<2, Real>;
using Triangle2 = std::array<Point2, 3>;  // in pixels

// How much of each pixel triangles cover that do not overlap: areas of the pieces (Sutherland and
// Hodgman 1974), in long double. One channel.
Pixels exact_coverage(std::span<const Triangle2> triangles, std::uint32_t width,
                      std::uint32_t height);

// How much of each pixel the union of triangles covers: `side` × `side` samples a pixel. One
// channel.
Pixels sampled_coverage(std::span<const Triangle2> triangles, std::uint32_t width,
                        std::uint32_t height, int side = 32);

// The same at these places of each pixel, from its top left corner on.
Pixels coverage_at(std::span<const Triangle2> triangles, std::uint32_t width, std::uint32_t height,
                   std::span<const Point2> places);

// Places of 1, 2, 4, 8 and 16 samples as graphics interfaces state them ("standard sample
// locations", Vulkan 1.3; the same in Direct3D 11.3).
std::vector<Point2> standard_places(int samples);

// The means of `factor` × `factor` pixels each, in long double; sizes are multiples of it.
Pixels box_means(const Pixels& fine, std::uint32_t factor);

// A unit sphere at the origin, seen along −z without perspective from y = −half to half over the
// picture's height; ambient light and one light from `towards` (unit), Blinn and Phong's reflection
// without 1/π. One channel, black around it, the mean of `side` × `side` samples a pixel.
struct LitSphere {
    double half = 1.15, ambient = 0.1, light = 1;
    Vector towards{0, 0, 1};
    double diffuse = 0.5, specular = 0.4, shininess = 60;
};
Pixels lit_sphere(const LitSphere& scene, std::uint32_t width, std::uint32_t height, int side);

// The plane y = 0 without end, seen from (0, height, 0) under `pitch` degrees downwards along −z;
// its texture repeats every unit of x and z (u = x, v = z), texel centres at (i + ½) / size,
// interpolated linearly between them. One channel: texels 0 … 1 of linear light. The mean of `side`
// × `side` samples a pixel; where its height spans more than side / 2 texels, of as many more rows
// of samples (16 times at most). Every ray must meet the plane.
struct TexturedPlane {
    double height = 1, pitch = 25, yfov = 0.7;  // degrees; radians
    std::uint32_t size = 0;
    std::vector<double> texels;  // rows from v = 0 on
};
Pixels textured_plane(const TexturedPlane& scene, std::uint32_t width, std::uint32_t height,
                      int side = 32);

}  // namespace cost
