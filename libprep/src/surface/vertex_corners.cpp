#include "surface/vertex_corners.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "base/scratch_buffer.h"
#include "surface/block_places.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Below this many corners a plain counting sort is done before threads have started.
constexpr std::size_t serial_limit = 1 << 17;
// Buckets of neighbouring vertices: their cursors fit the first-level cache.
constexpr std::size_t bucket_limit = 256;
constexpr std::size_t corner_grain = 1 << 18;

void sort_serially(std::span<const Index> corner_vertices, VertexCorners& result) {
    for (const Index v : corner_vertices) ++result.offsets[v + 1];
    for (std::size_t v = 0; v + 1 < result.offsets.size(); ++v)
        result.offsets[v + 1] += result.offsets[v];
    std::vector<Index> cursor(result.offsets.begin(), result.offsets.end() - 1);
    for (std::size_t c = 0; c < corner_vertices.size(); ++c)
        result.corners[cursor[corner_vertices[c]]++] = Index(c);
}

// For meshes that are local: blocks of corners use ranges of vertices that hardly overlap, and
// count in lists of their own.
class LocalSort {
  public:
    LocalSort(std::span<const Index> corner_vertices, int threads)
        : vertices_(corner_vertices),
          threads_(threads),
          blocks_((corner_vertices.size() + corner_grain - 1) / corner_grain) {}

    // False: the ranges are too large. result.offsets are zeros.
    bool run(VertexCorners& result) {
        by_block([&](Block& block, std::size_t begin, std::size_t end) {
            Index low = vertices_[begin], high = low;
            for (std::size_t c = begin; c < end; ++c) {
                low = std::min(low, vertices_[c]);
                high = std::max(high, vertices_[c]);
            }
            block.first = low;
            block.last = high + 1;
        });
        std::size_t ranges = 0;
        for (const Block& block : blocks_) ranges += block.last - block.first;
        // A closed surface comes back to its first vertices: one range may be all of them.
        if (ranges > 4 * result.offsets.size()) return false;
        // One array for all blocks' lists: large enough for large pages where each alone is not.
        ScratchBuffer<Index> all_counts(ranges);
        std::size_t counts_before = 0;
        for (Block& block : blocks_) {
            block.counts = {all_counts.data() + counts_before, block.last - block.first};
            counts_before += block.counts.size();
        }
        by_block([&](Block& block, std::size_t begin, std::size_t end) {
            std::fill(block.counts.begin(), block.counts.end(), 0);
            Index* const counts = block.counts.data();
            const Index first = block.first;
            for (std::size_t c = begin; c < end; ++c) ++counts[vertices_[c] - first];
        });
        for (const Block& block : blocks_) {
            Index* const offsets = result.offsets.data() + block.first + 1;
            for (std::size_t i = 0; i < block.counts.size(); ++i) offsets[i] += block.counts[i];
        }
        for (std::size_t v = 0; v + 1 < result.offsets.size(); ++v)
            result.offsets[v + 1] += result.offsets[v];
        // From counts to the place of each block's first corner at a vertex.
        std::vector<Index> places(result.offsets.begin(), result.offsets.end() - 1);
        for (const Block& block : blocks_)
            for (std::size_t i = 0; i < block.counts.size(); ++i) {
                const Index count = block.counts[i];
                block.counts[i] = places[block.first + i];
                places[block.first + i] += count;
            }
        by_block([&](Block& block, std::size_t begin, std::size_t end) {
            Index* const cursors = block.counts.data();
            const Index first = block.first;
            for (std::size_t c = begin; c < end; ++c)
                result.corners[cursors[vertices_[c] - first]++] = Index(c);
        });
        return true;
    }

  private:
    struct Block {
        Index first = 0, last = 0;  // vertices
        std::span<Index> counts;
    };
    template <class Body>
    void by_block(const Body& body) {
        parallel_blocks(vertices_.size(), corner_grain, threads_,
                        [&](std::size_t begin, std::size_t end) {
                            body(blocks_[begin / corner_grain], begin, end);
                        });
    }

    std::span<const Index> vertices_;
    int threads_;
    std::vector<Block> blocks_;
};

}  // namespace

bool neighbours_are_near(std::span<const Index> corner_vertices) {
    if (corner_vertices.size() <= serial_limit) return true;
    constexpr std::size_t samples = 1024, near = 4096;
    const std::size_t step = corner_vertices.size() / samples;
    std::size_t far = 0;
    for (std::size_t i = 0; i + 1 < samples; ++i) {
        const Index a = corner_vertices[i * step], b = corner_vertices[i * step + 3];
        far += (a < b ? b - a : a - b) > near;
    }
    return far < samples / 4;
}

VertexCorners corners_by_vertex(std::span<const Index> corner_vertices, std::size_t vertices,
                                int threads) {
    const std::size_t corners = corner_vertices.size();
    VertexCorners result;
    result.offsets.assign(vertices + 1, 0);
    result.corners.resize(corners);
    if (corners <= serial_limit || threads == 1) {
        sort_serially(corner_vertices, result);
        return result;
    }
    // The counters then stay in the cache by themselves: 8 ms of processor time a million
    // triangles, where sorting by bucket takes 22 (25 against 42 where faces are shuffled).
    if (neighbours_are_near(corner_vertices)) {
        if (!LocalSort(corner_vertices, threads).run(result))
            sort_serially(corner_vertices, result);
        return result;
    }

    // First by bucket (blocks of corners keep their order), then by vertex within each bucket.
    const int shift =
        std::max(0, int(std::bit_width(vertices)) - int(std::bit_width(bucket_limit)) + 1);
    const std::size_t buckets = ((vertices - 1) >> shift) + 1;
    std::vector<std::size_t> places = block_places(corner_vertices, shift, buckets,
                                                   even_range_ends(corners, corner_grain), threads);
    // The first range's places are the buckets' own.
    std::vector<std::size_t> bucket_starts(places.begin(),
                                           places.begin() + std::ptrdiff_t(buckets));
    bucket_starts.push_back(corners);
    std::vector<Index> bucketed(corners);
    parallel_blocks(corners, corner_grain, threads, [&](std::size_t begin, std::size_t end) {
        std::size_t* const cursors = places.data() + begin / corner_grain * buckets;
        for (std::size_t c = begin; c < end; ++c)
            bucketed[cursors[corner_vertices[c] >> shift]++] = Index(c);
    });
    parallel_blocks(buckets, 1, threads, [&](std::size_t bucket, std::size_t) {
        const std::span<const Index> mine(bucketed.data() + bucket_starts[bucket],
                                          bucket_starts[bucket + 1] - bucket_starts[bucket]);
        const std::size_t first = bucket << shift;
        const std::size_t last = std::min(vertices, (bucket + 1) << shift);
        std::vector<Index> cursor(last - first, 0);
        for (const Index c : mine) ++cursor[corner_vertices[c] - first];
        auto at = Index(bucket_starts[bucket]);
        for (std::size_t v = first; v < last; ++v) {
            const Index count = cursor[v - first];
            cursor[v - first] = at;
            at += count;
            result.offsets[v + 1] = at;
        }
        for (const Index c : mine) result.corners[cursor[corner_vertices[c] - first]++] = c;
    });
    return result;
}

CornerPoints::CornerPoints(const MeshView& mesh, std::span<const Index> welded, int threads)
    : own_(welded.empty() ? 0 : mesh.corner_count()), of_corners_(mesh.corner_vertices) {
    if (welded.empty()) return;
    parallel_blocks(own_.size(), corner_grain, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) own_[c] = welded[mesh.corner_vertices[c]];
    });
    of_corners_ = own_;
}

}  // namespace prep::detail
