// Corners sorted by vertex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace prep::detail {

struct VertexCorners {
    std::vector<std::uint32_t> offsets;  // vertices + 1
    std::vector<std::uint32_t> corners;  // ascending within each vertex
};

// Counting sort; O(corners + vertices). The same for any thread count.
VertexCorners corners_by_vertex(std::span<const std::uint32_t> corner_vertices,
                                std::size_t vertices, int threads);

}  // namespace prep::detail
