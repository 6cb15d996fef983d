// What a walk around points reads of their faces, put in the order of the points first: where
// triangles are in random order, their areas and corners lie anywhere in memory.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "base/scratch_buffer.h"
#include "surface/vertex_corners.h"

namespace prep::detail {

// Of a triangle's corner.
struct CornerTerm {
    glm::dvec3 area;               // of the triangle
    std::uint32_t next, previous;  // the points that the edges from here lead to
};

// Terms lie by blocks of points (block_places.h), in the order of their triangles: each block is
// then put in the order of the points within a cache.
class GatheredTerms {
  public:
    static constexpr int block_shift = 12;
    static constexpr std::size_t block_points = std::size_t(1) << block_shift;

    // Whether it pays: by a sample of the triangles, and what memory they would take (34 bytes a
    // corner).
    static bool pays(std::span<const std::uint32_t> corner_points);

    // `around`: corners by point. O(corners).
    GatheredTerms(std::span<const std::uint32_t> corner_points, const VertexCorners& around,
                  std::span<const glm::dvec3> area_vectors, int threads);

    // Those of the points first … first + block_points − 1, `first` a multiple of block_points, in
    // the order of around.corners; `terms` has room for each.
    void put_in_order(std::size_t first, const VertexCorners& around,
                      std::span<CornerTerm> terms) const;

  private:
    ScratchBuffer<CornerTerm> terms_;
    ScratchBuffer<std::uint16_t> points_;  // of terms_, counted within their block
};

}  // namespace prep::detail
