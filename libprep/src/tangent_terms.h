// What each triangle gives to the tangents of its three corners: steps 3, 4 and the summands of 7.
#pragma once

#include <cstddef>
#include <cstdint>

#include "scratch_buffer.h"
#include "tangent_triangles.h"

namespace prep::detail {

// The summand of one triangle at one corner: its S on the plane of the normal, unit, times the
// corner's angle. −0 in all three where the triangle adds nothing (−0 is neutral in sums).
struct alignas(16) CornerTerm {
    float x, y, z;
    std::uint32_t code;  // bits of TermCode
};

// Directions of the projected S and T: bit k is set where component k is above 5 % of the length,
// bit k + 3 where it is below −5 %. Vectors that share a bit are less than 180° apart by a margin
// (cosine ≥ −0.995) that no rounding reaches; triangles that group with anything share all.
enum TermCode : std::uint32_t {
    s_directions = 0x03f,
    t_directions = 0xfc0,
    orientation_preserving = 1u << 12,  // these and the following are the same at all three corners
    group_with_anything = 1u << 13,     // no frame of its own: joins whatever group reaches it
    degenerate_triangle = 1u << 14,     // two equal positions: takes no part
    quad_first = 1u << 15,
    quad_second = 1u << 16,
    half_degenerate_quad = 1u << 17,  // the other half of its quad is degenerate
};

struct TermCounts {
    std::uint64_t mirrored = 0, anything = 0, degenerate = 0;  // disjoint
    bool nan = false;  // set where a position, normal or UV is NaN (also for some infinite ones)
};

// Inputs of up to `size` triangles, component by component: [corner][component][triangle].
struct TermBlock {
    static constexpr std::size_t size = 128;
    alignas(64) float p[3][3][size];
    alignas(64) float n[3][3][size];
    alignas(64) float uv[3][2][size];
};

struct TermBlockResult {
    TermCounts counts;
    bool far_from_unit =
        false;  // a normal is more than 0.1 % off: nothing else is meant to be used
};

// Writes `count` terms (up to TermBlock::size, the rest undefined) to each plane. Kernels may read
// and write the whole block. check_unit: look for normals far from unit.
using TermKernel = TermBlockResult (*)(const TermBlock& block, std::size_t count, bool check_unit,
                                       CornerTerm* const planes[3]);

TermBlockResult terms_scalar(const TermBlock& block, std::size_t count, bool check_unit,
                             CornerTerm* const planes[3]);
TermKernel term_kernel(SimdLevel level);  // in simd/

struct Terms {
    ScratchBuffer<CornerTerm> planes[3];  // corner k of triangle t: planes[k][t]
    TermCounts counts;
    const CornerTerm& at(std::size_t triangle, std::size_t k) const { return planes[k][triangle]; }
    std::uint32_t flags(std::size_t triangle) const { return planes[0][triangle].code; }
};

Terms compute_terms(const CornerReader& read, const TangentTriangles& triangles,
                    const TangentOptions& options);

// A triangle's own frame, as step 4 gives it (for vertices that need more than sums).
struct TriangleFrame {
    glm::vec3 s{0.0f}, t{0.0f};        // unit where the triangle is healthy
    float s_length = 0, t_length = 0;  // |dP/du|, |dP/dv|
    bool preserving = false, healthy = false;
};
TriangleFrame triangle_frame(const glm::vec3 p[3], const glm::vec2 uv[3]);
TriangleFrame triangle_frame(const CornerReader& read, const TangentTriangles& triangles,
                             std::size_t triangle);

}  // namespace prep::detail
