#include "vertices/source_corners.h"

#include <atomic>

#include "base/parallel.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr std::size_t grain_of_vertices = 65536, grain_of_corners = 196608;

}  // namespace

SourceCorners::SourceCorners(std::span<const Index> corner_vertices, std::size_t vertices,
                             const VertexCorners* around, int threads)
    : corner_vertices_(corner_vertices), threads_(threads), around_(around), firsts_(vertices) {
    parallel_blocks(vertices, grain_of_vertices, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            firsts_[v] = around && around->offsets[v] < around->offsets[v + 1]
                             ? around->corners[around->offsets[v]]
                             : no_index;
    });
    if (!around) find_firsts();
}

// The least of each vertex, whichever block comes first. Within a block corners ascend: all but the
// first look at a vertex and go on.
void SourceCorners::find_firsts() {
    parallel_blocks(corner_vertices_.size(), grain_of_corners, threads_,
                    [&](std::size_t begin, std::size_t end) {
                        for (Index c = Index(begin); c < end; ++c) {
                            const std::atomic_ref<Index> first(firsts_[corner_vertices_[c]]);
                            Index known = first.load(std::memory_order_relaxed);
                            while (c < known && !first.compare_exchange_weak(
                                                    known, c, std::memory_order_relaxed)) {
                            }
                        }
                    });
}

void SourceCorners::make_lists(std::span<const std::uint8_t> wanted) {
    if (around_) return;
    Index count = 0;
    for (const std::uint8_t w : wanted) count += w != 0;
    if (count == 0) return;
    places_ = ScratchBuffer<Index>(wanted.size());
    Index place = 0;
    for (std::size_t v = 0; v < wanted.size(); ++v)
        if (wanted[v] != 0) places_[v] = place++;
    const std::size_t blocks = (corner_vertices_.size() + grain_of_corners - 1) / grain_of_corners;
    std::vector<std::vector<Index>> found(blocks);
    parallel_blocks(corner_vertices_.size(), grain_of_corners, threads_,
                    [&](std::size_t begin, std::size_t end) {
                        std::vector<Index>& mine = found[begin / grain_of_corners];
                        for (std::size_t c = begin; c < end; ++c)
                            if (wanted[corner_vertices_[c]] != 0) mine.push_back(Index(c));
                    });
    std::vector<Index> corners, places;
    for (std::vector<Index>& mine : found) {
        corners.insert(corners.end(), mine.begin(), mine.end());
        release(mine);
    }
    places.reserve(corners.size());
    for (const Index c : corners) places.push_back(places_[corner_vertices_[c]]);
    listed_ = corners_by_vertex(places, count, threads_);
    for (Index& c : listed_.corners) c = corners[c];
}

std::span<const Index> SourceCorners::of(std::size_t vertex) const {
    const VertexCorners& lists = around_ ? *around_ : listed_;
    const std::size_t i = around_ ? vertex : places_[vertex];
    return {lists.corners.data() + lists.offsets[i],
            std::size_t(lists.offsets[i + 1] - lists.offsets[i])};
}

}  // namespace prep::detail
