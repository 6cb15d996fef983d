// Meshes whose triangles are in random order: all contributions are sorted by blocks of vertices
// first, then each block is accumulated by one thread.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>

#include "base/parallel.h"
#include "tangents/accumulate.h"
#include "tangents/corner_buckets.h"
#include "tangents/fan_writer.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// What a thread accumulates blocks in: a slot for each vertex of one.
class BlockAccumulation {
  public:
    BlockAccumulation(const CornerBuckets& buckets, std::size_t ranges, std::size_t vertices,
                      AddRecordsKernel add, FanWriter& writer)
        : buckets_(buckets),
          ranges_(ranges),
          vertices_(vertices),
          add_(add),
          writer_(writer),
          met_(std::min(buckets.block_size(), vertices)) {
        pool_.ensure(met_.size(), met_.size());
    }

    void run(std::size_t block) {
        std::fill(met_.begin(), met_.end(), std::uint8_t(0));
        pool_.free_count = 0;  // each has the slot of its number
        for (std::size_t r = 0; r < ranges_; ++r) add_all(buckets_.records(block, r));
        const std::size_t begin = block * buckets_.block_size();
        const std::size_t size = std::min(buckets_.block_size(), vertices_ - begin);
        Index vertices[ring_batch], words[ring_batch];
        std::size_t count = 0;
        for (std::size_t i = 0; i < size; ++i) {
            if (met_[i] == 0) continue;
            vertices[count] = Index(begin + i);
            words[count++] = Index(i) * VertexWord::slot_one + met_[i] * VertexWord::met_one;
            if (count < ring_batch) continue;
            writer_.finish(pool_, vertices, words);
            count = 0;
        }
        writer_.finish(pool_, {vertices, count}, words);
    }

  private:
    void add_all(std::span<const CornerRecord> records) {
        constexpr std::size_t most = std::size(AccumulateLists().different);
        VertexSum* const sums = pool_.sums.data();
        for (; !records.empty(); records = records.subspan(std::min(most, records.size()))) {
            add_(records.data(), std::min(most, records.size()), met_.data(), sums,
                 pool_.rings.data(), lists_);
            for (std::size_t i = 0; i < lists_.different_count; ++i) {
                const CornerRecord& record = records[lists_.different[i]];
                VertexSum& sum = sums[record.vertex()];
                sum.split |= !writer_.same_values(record.normal, record.uv, sum.normal, sum.uv);
            }
        }
    }

    const CornerBuckets& buckets_;
    std::size_t ranges_, vertices_;
    AddRecordsKernel add_;
    FanWriter& writer_;
    std::vector<std::uint8_t> met_;  // triangles, up to most_ring_members + 1
    VertexPool pool_;
    AccumulateLists lists_;
};

// Flags and counts of all triangles, and their contributions into buckets.
void fill_buckets(const AccumulateInput& input, const BlockContributions& contributions,
                  std::span<const Valences::Range> ranges, int threads, ContributionStore& store,
                  CornerBuckets& buckets) {
    std::vector<TriangleCounts> counts(ranges.size());
    std::uint8_t* const flags = store.triangle_flags.data();
    parallel_blocks(ranges.size(), 1, threads, [&](std::size_t r, std::size_t) {
        const auto scratch = std::make_unique<BlockContributions::Scratch>();
        const Contribution* const planes[3] = {scratch->planes[0], scratch->planes[1],
                                               scratch->planes[2]};
        const std::size_t end = ranges[r].end;
        for (std::size_t t = ranges[r].begin; t < end;) {
            // Of the next block, while this one's are computed.
            contributions.fetch_ahead(std::min(t + TriangleBlock::size, end), end);
            const std::uint64_t degenerate = counts[r].degenerate;
            const std::size_t n = contributions.run(t, end, *scratch, counts[r]);
            for (std::size_t i = 0; i < n; ++i)
                flags[t + i] = std::uint8_t(planes[0][i].code >> triangle_flags_shift);
            buckets.add(r, input, t, n, counts[r].degenerate != degenerate, planes);
            t += n;
        }
    });
    store.counts = {};
    for (const TriangleCounts& one : counts) store.counts.add(one);
}

// Is there a vertex that has degenerate triangles alone?
bool any_without(const ContributionStore& store, std::span<const Index> vertices,
                 const Valences& valences) {
    if (store.counts.degenerate == 0) return false;
    for (std::size_t i = 0; i < vertices.size(); ++i)
        if ((store.flags(i / 3) & degenerate_triangle) &&
            valences.states[vertices[i]] == unused_vertex)
            return true;
    return false;
}

// Values are at their vertices' numbers; where some are unused the others close up.
void close_up(Valences& valences, std::span<glm::vec4> values) {
    const std::size_t count = valences.states.size();
    valences.used = count - std::size_t(std::count(valences.states.data(),
                                                   valences.states.data() + count, unused_vertex));
    if (valences.used == count) return;
    valences.places = ScratchBuffer<Index>(count);
    for (std::size_t v = 0, place = 0; v < count; ++v) {
        valences.places[v] = Index(place);
        if (valences.states[v] == unused_vertex) continue;
        values[place++] = values[v];
    }
}

}  // namespace

bool accumulate_scattered(const CornerReader& read, const TangentTriangles& triangles,
                          std::span<const Index> vertices, const BlockContributions& contributions,
                          const FanOptions& fans, const TangentOptions& options, Valences& valences,
                          ContributionStore& store, std::span<glm::vec4> values) {
    const std::size_t count = valences.states.size(), ranges = valences.ranges.size();
    store.triangle_flags = ScratchBuffer<std::uint8_t>(triangles.count);
    store.complete = false;
    FanWriter writer(read, fans, options.simd, valences, values);
    {
        const std::size_t workers =
            options.threads == 1 ? 1 : std::size_t(parallel_width());  // 0 threads: all there are
        CornerBuckets buckets(vertices, valences.ranges, count, workers, options.threads);
        fill_buckets({vertices.data(), triangles.implicit() ? nullptr : triangles.corners.data(),
                      read.in.normals.indices.data(), read.in.uv.indices.data()},
                     contributions, valences.ranges, options.threads, store, buckets);
        if (store.counts.nan) return false;
        std::atomic<std::size_t> next_block = 0;
        parallel_tasks(workers, options.threads, [&](std::size_t) {
            BlockAccumulation accumulation(buckets, ranges, count, add_records_kernel(options.simd),
                                           writer);
            for (std::size_t block; (block = next_block++) < buckets.blocks();)
                accumulation.run(block);
        });
    }
    if (any_without(store, vertices, valences)) return false;
    close_up(valences, values);
    writer.list_neighbours(vertices, options.threads);
    return true;
}

}  // namespace prep::detail
