// One channel of a mesh (positions, a UV set, …) as a surface: its cage refined, its pieces, and
// its values on them.
#pragma once

#include "limit_surface/patch_evaluator.h"

namespace prep::detail {

inline constexpr std::size_t most_ring_numbers = std::size_t(1) << 28;  // 2 GB

struct ChannelSurface {
    RefinedCage cage;
    PatchTree tree;
    RefinedValues values;
    RingValues rings;

    // `numbers`: `width` to each vertex of the cage. With `normals` its first three are positions.
    // Rings are stored for grids of 2^ring_levels at least, memory permitting.
    static Result<ChannelSurface> make(const SurfaceCage& cage, std::span<const double> numbers,
                                       std::uint32_t width, bool normals, int ring_levels,
                                       int threads);
    SurfacePieces pieces() const {
        return {&cage, &tree, {values.numbers.data(), values.width, nullptr}, &rings};
    }
    std::uint32_t width() const { return values.width; }
    bool has_triangles() const { return cage.corners_per_face == 3; }
};

// The normal of a point that point() or grid() came to, and where it comes from when the
// derivatives do not give it: the rings' own at their vertices; else the mean of limit normals at
// four points nearby in the root (1/1024, 1/64, 1/8 of it away); else `face_normal`; else (0, 0,
// 1).
struct PointNormal {
    glm::dvec3 normal{0.0, 0.0, 1.0};
    bool fallback = false;
};
PointNormal point_normal(const ChannelSurface& surface, PatchEvaluator& evaluator,
                         std::uint32_t root, double u, double v, const glm::dvec3& du,
                         const glm::dvec3& dv, std::span<const std::uint32_t> face_corners);

// Newell's normal of a cage's face, or zero.
glm::dvec3 polygon_normal(std::span<const std::uint32_t> corners, std::span<const double> positions,
                          std::uint32_t width);

}  // namespace prep::detail
