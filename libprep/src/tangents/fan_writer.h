// What becomes of vertices that have met all their triangles: many at once are classified, fans
// get their tangents, and what lies beside split vertices is noted for the worklist.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/scratch_buffer.h"
#include "tangents/accumulate.h"

namespace prep::detail {

// Scratch for vertices that are not done with.
struct VertexPool {
    ScratchBuffer<VertexSum> sums;
    ScratchBuffer<VertexRing> rings;
    ScratchBuffer<std::uint32_t> free;  // as in AccumulateState
    std::size_t free_count = 0;
    std::unique_ptr<RingBatch> batch = std::make_unique<RingBatch>();

    // Makes that many slots free, where no more than `most` are ever in use; false where there are
    // too many.
    bool ensure(std::size_t wanted, std::size_t most) {
        if (free_count >= wanted) return true;
        const std::size_t old = sums.size();
        const std::size_t size = std::max(std::min(2 * old, most + wanted), old + wanted);
        if (size > VertexWord::most_slots) return false;
        enlarge(sums, size);
        enlarge(rings, size);
        enlarge(free, size);
        // The lowest on top: those are used again and again.
        for (std::size_t slot = size; slot-- > old;) {
            sums[slot] = VertexSum();
            free[free_count++] = std::uint32_t(slot) * VertexWord::slot_one;
        }
        return true;
    }

    template <class T>
    static void enlarge(ScratchBuffer<T>& buffer, std::size_t size) {
        ScratchBuffer<T> larger(size);
        std::copy_n(buffer.data(), buffer.size(), larger.data());
        buffer = std::move(larger);
    }
};

// May be called by several threads at once, for different vertices and pools.
class FanWriter {
  public:
    // Writes what became of vertices to valences.states, tangents to their places in `values`.
    FanWriter(const CornerReader& read, const FanOptions& fans, SimdLevel simd, Valences& valences,
              std::span<glm::vec4> values);

    // Up to ring_batch vertices that have met all their triangles, and their words (VertexWord):
    // their slots become free. False where one has met none.
    bool finish(VertexPool& pool, std::span<const std::uint32_t> vertices,
                const std::uint32_t* words);

    // Have corners of these indices one normal and one UV? Other indices may have the same values.
    bool same_values(std::uint32_t normal, std::uint32_t uv, std::uint32_t other_normal,
                     std::uint32_t other_uv) const;

    // A split vertex was met whose triangles are not known.
    void note_large_split() { large_split_ = true; }
    // Once all are done with: puts fans beside split vertices on the worklist. vertices: three per
    // triangle.
    void list_neighbours(std::span<const std::uint32_t> vertices, int threads);

  private:
    void write_fans(const VertexRing* rings, RingBatch& batch);
    void note_neighbours(const VertexRing& ring, std::size_t count);

    const CornerReader& read_;
    const FanKernel classify_;
    FanOptions fans_;
    Valences& valences_;
    std::span<glm::vec4> values_;
    // A bit for each vertex that shares a triangle with a split one, but for split ones of large
    // rings: is there any such?
    std::vector<std::uint64_t> split_neighbours_;
    std::atomic<bool> large_split_ = false;
};

}  // namespace prep::detail
