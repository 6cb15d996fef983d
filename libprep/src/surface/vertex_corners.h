// Corners sorted by vertex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/unfilled_vector.h"
#include "prep/mesh.h"

namespace prep::detail {

struct VertexCorners {
    std::vector<std::uint32_t> offsets;  // vertices + 1
    std::vector<std::uint32_t> corners;  // ascending within each vertex
};

// Counting sort; O(corners + vertices). The same for any thread count.
VertexCorners corners_by_vertex(std::span<const std::uint32_t> corner_vertices,
                                std::size_t vertices, int threads);

// Whether neighbouring faces mostly use neighbouring vertices, as in files that modellers and
// optimisers write; also where all fits a cache in any order. Tells speed alone, from a sample.
bool neighbours_are_near(std::span<const std::uint32_t> corner_vertices);

// Per corner its point: its vertex, or what that is welded to.
class CornerPoints {
  public:
    // `welded`: weld_exact(), or empty. Both outlive this object.
    CornerPoints(const MeshView& mesh, std::span<const std::uint32_t> welded, int threads);
    CornerPoints(const CornerPoints&) = delete;
    CornerPoints& operator=(const CornerPoints&) = delete;
    std::span<const std::uint32_t> of_corners() const { return of_corners_; }

  private:
    UnfilledVector<std::uint32_t> own_;
    std::span<const std::uint32_t> of_corners_;
};

}  // namespace prep::detail
