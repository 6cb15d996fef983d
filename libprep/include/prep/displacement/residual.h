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
// has the texel. Texels outside all charts are filled from those next to them. A texel that two
// charts share is the mean of what each has in its own frame, and one chart that has no sample of
// a texel reads there what others have: keep two texels between charts.
//
// A material has one map for all who use it: where a mesh uses it whose faces are not baked, it
// gets none. Maps that are unfinished at once, because several meshes share their materials, take
// 15 bytes a texel; more than max_residual_bytes are an error before any work is done.
#pragma once

#include <cstdint>

#include "prep/mesh.h"

namespace prep {

inline constexpr std::uint32_t max_residual_size = 8192;
inline constexpr std::uint64_t max_residual_bytes = std::uint64_t(8) << 30;

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
    // Of these: the surface faces away from the triangle. What no tangent-space normal says is the
    // nearest that one does; told in reports where there are any.
    std::uint64_t facing_away = 0;
    // Between the triangles' interpolated normals and the surface's: mean over samples, and the
    // largest of the means of a texel's samples in a triangle.
    double mean_degrees = 0, largest_degrees = 0;
};

}  // namespace prep
