// Contributions sorted by blocks of vertices (block_places.h), for triangles in random order: each
// corner is a record, and blocks are small enough that what is accumulated at their vertices stays
// in a second-level cache. Records of a block are in the order of the triangles, so that sums have
// the same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/scratch_buffer.h"
#include "tangents/accumulate.h"

namespace prep::detail {

class CornerBuckets {
  public:
    // vertices: three per triangle, below `count`. workers: so many blocks are accumulated at a
    // time. Takes 96 bytes a triangle.
    CornerBuckets(std::span<const std::uint32_t> vertices, std::span<const Valences::Range> ranges,
                  std::size_t count, std::size_t workers, int threads);

    // The contributions of `count` triangles from `first` on, of range r; those of one range come
    // in order. Degenerate triangles, if there are any, are left out.
    void add(std::size_t r, const AccumulateInput& input, std::size_t first, std::size_t count,
             bool any_degenerate, const Contribution* const planes[3]);

    std::size_t blocks() const { return blocks_; }
    // All but the last have that many vertices.
    std::size_t block_size() const { return std::size_t(1) << shift_; }
    // Of range r: what a block has is the ranges' records, one after the other.
    std::span<const CornerRecord> records(std::size_t block, std::size_t r) const;

  private:
    int shift_;
    std::size_t blocks_;
    // Range by range: where each block's records begin, and where the next one goes.
    std::vector<std::size_t> starts_, cursors_;
    ScratchBuffer<CornerRecord> records_;
};

}  // namespace prep::detail
