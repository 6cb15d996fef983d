#include "surface/vertex_corners.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Below this many corners a plain counting sort is done before threads have started.
constexpr std::size_t serial_limit = 1 << 17;
// Buckets of neighbouring vertices: their cursors fit the first-level cache.
constexpr std::size_t bucket_limit = 256;
constexpr std::size_t corner_grain = 1 << 18;

// Whether neighbouring faces mostly use neighbouring vertices, as in files that modellers and
// optimisers write. The counters then stay in the cache by themselves, and one thread is done in
// 8 ms a million triangles, where sorting by bucket takes 22 ms of processor time (25 against 42
// where faces are shuffled).
bool is_local(std::span<const Index> corner_vertices) {
    constexpr std::size_t samples = 1024, near = 4096;
    const std::size_t step = corner_vertices.size() / samples;
    std::size_t far = 0;
    for (std::size_t i = 0; i + 1 < samples; ++i) {
        const Index a = corner_vertices[i * step], b = corner_vertices[i * step + 3];
        far += (a < b ? b - a : a - b) > near;
    }
    return far < samples / 4;
}

void sort_serially(std::span<const Index> corner_vertices, VertexCorners& result) {
    for (const Index v : corner_vertices) ++result.offsets[v + 1];
    for (std::size_t v = 0; v + 1 < result.offsets.size(); ++v)
        result.offsets[v + 1] += result.offsets[v];
    std::vector<Index> cursor(result.offsets.begin(), result.offsets.end() - 1);
    for (std::size_t c = 0; c < corner_vertices.size(); ++c)
        result.corners[cursor[corner_vertices[c]]++] = Index(c);
}

}  // namespace

VertexCorners corners_by_vertex(std::span<const Index> corner_vertices, std::size_t vertices,
                                int threads) {
    const std::size_t corners = corner_vertices.size();
    VertexCorners result;
    result.offsets.assign(vertices + 1, 0);
    result.corners.resize(corners);
    if (corners <= serial_limit || threads == 1 || is_local(corner_vertices)) {
        sort_serially(corner_vertices, result);
        return result;
    }

    // First by bucket (blocks of corners keep their order), then by vertex within each bucket.
    const int shift =
        std::max(0, int(std::bit_width(vertices)) - int(std::bit_width(bucket_limit)) + 1);
    const std::size_t buckets = ((vertices - 1) >> shift) + 1;
    const std::size_t blocks = (corners + corner_grain - 1) / corner_grain;
    std::vector<Index> starts(blocks * buckets, 0);
    parallel_blocks(corners, corner_grain, threads, [&](std::size_t begin, std::size_t end) {
        Index* counts = starts.data() + begin / corner_grain * buckets;
        for (std::size_t c = begin; c < end; ++c) ++counts[corner_vertices[c] >> shift];
    });
    Index total = 0;
    std::vector<Index> bucket_starts(buckets + 1);
    for (std::size_t k = 0; k < buckets; ++k) {
        bucket_starts[k] = total;
        for (std::size_t b = 0; b < blocks; ++b) {
            const Index count = starts[b * buckets + k];
            starts[b * buckets + k] = total;
            total += count;
        }
    }
    bucket_starts[buckets] = total;
    std::vector<Index> bucketed(corners);
    parallel_blocks(corners, corner_grain, threads, [&](std::size_t begin, std::size_t end) {
        Index* cursors = starts.data() + begin / corner_grain * buckets;
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
        Index at = bucket_starts[bucket];
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

}  // namespace prep::detail
