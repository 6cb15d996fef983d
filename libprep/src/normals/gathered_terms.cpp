#include "normals/gathered_terms.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/parallel.h"
#include "surface/block_places.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Triangles that one thread goes through at a time. A table has a count for each block of points
// and each of these: few enough of them keep it small.
constexpr std::size_t least_chunk = std::size_t(1) << 16, most_chunks = 64;
constexpr std::size_t most_corners = std::size_t(1) << 26;

}  // namespace

bool GatheredTerms::pays(std::span<const Index> corner_points) {
    return corner_points.size() <= most_corners && !neighbours_are_near(corner_points);
}

GatheredTerms::GatheredTerms(std::span<const Index> corner_points, const VertexCorners& around,
                             std::span<const glm::dvec3> area_vectors, int threads)
    : terms_(corner_points.size()), points_(corner_points.size()) {
    const std::size_t triangles = corner_points.size() / 3;
    const std::size_t points = around.offsets.size() - 1;
    const std::size_t blocks = (points + block_points - 1) >> block_shift;
    const std::size_t chunk = std::max(least_chunk, (triangles + most_chunks - 1) / most_chunks);
    std::vector<std::size_t> places =
        block_places(corner_points, block_shift, blocks,
                     even_range_ends(corner_points.size(), 3 * chunk), threads);
    parallel_blocks(triangles, chunk, threads, [&](std::size_t begin, std::size_t end) {
        std::size_t* const at = places.data() + begin / chunk * blocks;
        for (std::size_t f = begin; f < end; ++f) {
            const std::array<Index, 3> p{corner_points[3 * f], corner_points[3 * f + 1],
                                         corner_points[3 * f + 2]};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t place = at[p[k] >> block_shift]++;
                terms_[place] = {area_vectors[f], p[(k + 1) % 3], p[(k + 2) % 3]};
                points_[place] = std::uint16_t(p[k] % block_points);
            }
        }
    });
}

void GatheredTerms::put_in_order(std::size_t first, const VertexCorners& around,
                                 std::span<CornerTerm> terms) const {
    const std::size_t last = std::min(first + block_points, around.offsets.size() - 1);
    const std::size_t begin = around.offsets[first], end = around.offsets[last];
    std::array<Index, block_points> next;
    for (std::size_t v = first; v < last; ++v) next[v - first] = Index(around.offsets[v] - begin);
    for (std::size_t i = begin; i < end; ++i) terms[next[points_[i]]++] = terms_[i];
}

}  // namespace prep::detail
