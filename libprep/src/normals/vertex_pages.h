// Which pages of vertices which ranges of triangles use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace prep::detail {

// Triangles of a range: their sums fit a second-level cache where neighbours in the mesh are near
// in number. Of a block: what the kernels get at once.
inline constexpr std::size_t range_triangles = 32768, block_triangles = 64;

struct PageUse {
    struct Extent {
        std::uint32_t first, last;  // vertices, both of them
    };
    static constexpr std::uint32_t unused = ~std::uint32_t(0), shared = unused - 1;

    std::vector<Extent> blocks;                      // of triangles
    std::vector<std::vector<std::uint32_t>> ranges;  // the pages of each, ascending
    std::vector<std::uint32_t> owners;  // per page: the range that alone uses it, shared, unused
    std::uint32_t last_vertex = 0;      // the greatest of all
    // Neither order nor neighbours to speak of, so that sums by ranges would take more memory or
    // time than corners sorted by vertex. Of the rest only last_vertex is meant then.
    bool scattered = false;
};

// Of a range, and with it the memory that its sums take: twice as many vertices as corners.
inline constexpr std::size_t most_pages_of_range = 2 * 3 * range_triangles / 64;
// Pages of several ranges are kept by each of them: at most 3/8 as many vertices as corners, which
// take about what corners sorted by vertex do, their faces' areas included.
constexpr std::size_t most_copied_vertices(std::size_t corners) {
    return corners / 8 * 3;
}

// `vertices`: three per triangle; where last_vertex is not below `count`, it alone is meant. The
// same for any number of threads. O(triangles + count).
PageUse find_page_use(std::span<const std::uint32_t> vertices, std::size_t count, int threads);

}  // namespace prep::detail
