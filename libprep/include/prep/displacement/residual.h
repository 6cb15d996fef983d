// Residual normal maps: what the triangles of a tessellation could not carry of their surface.
//
// A texel holds the surface's normal in the frame of the triangles as they are written, so that
// x·T + y·B + z·N, with N and T interpolated over the triangle and B = w·cross(N, T), is the normal
// of the displaced surface at the point of the same face and parameters (docs/conventions.md,
// tangents). Nothing is searched for: a texel's UV says which triangle it is in, and the triangle
// where it lies in its face. Texels that several points of the surface have, being larger than the
// detail, hold the mean of what those have.
//
// The picture covers 0 … 1 and repeats. Where triangles overlap there, the first one in the mesh
// has the texel. Texels outside all charts are filled from those next to them.
#pragma once

#include <cstdint>

#include "prep/mesh.h"

namespace prep {

inline constexpr std::uint32_t max_residual_size = 8192;

struct ResidualMapOptions {
    std::uint32_t size = 2048;  // texels along each side, 1 … 8192
    int bits = 16;              // of each channel: 8 or 16
};

struct ResidualMap {
    std::uint32_t material = no_index, image = no_index;  // of the scene
    std::uint32_t size = 0;
    int bits = 0;
    std::uint32_t uv_set = 0;
    std::uint64_t texels = 0;       // that lie in charts
    std::uint64_t overlapping = 0;  // of these: that triangles have which are not one surface
    std::uint64_t facing_away = 0;  // of these: their normal lies behind the triangle's
    double mean_degrees = 0, largest_degrees = 0;  // between the triangles' normals and the map's
};

}  // namespace prep
