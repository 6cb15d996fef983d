// The corners at each vertex of a mesh, as splitting asks for them: the first one of every vertex,
// and all of them where they differ, which is at few vertices mostly.
#pragma once

#include <cstdint>
#include <span>

#include "base/scratch_buffer.h"
#include "surface/vertex_corners.h"

namespace prep::detail {

class SourceCorners {
  public:
    // `around`: the corners by vertex where they are known, else null. All must outlive this.
    SourceCorners(std::span<const std::uint32_t> corner_vertices, std::size_t vertices,
                  const VertexCorners* around, int threads);

    bool is_used(std::size_t vertex) const { return firsts_[vertex] != no_index; }
    // Its lowest corner, or no_index.
    std::uint32_t first(std::size_t vertex) const { return firsts_[vertex]; }

    // Once: for the vertices whose entry is not 0. O(corners).
    void make_lists(std::span<const std::uint8_t> wanted);
    // All corners of a vertex that has a list, ascending.
    std::span<const std::uint32_t> of(std::size_t vertex) const;

  private:
    void find_firsts();

    std::span<const std::uint32_t> corner_vertices_;
    int threads_;
    const VertexCorners* around_;
    ScratchBuffer<std::uint32_t> firsts_;
    ScratchBuffer<std::uint32_t> places_;  // by vertex: its list in `listed_`, where it has one
    VertexCorners listed_;
};

}  // namespace prep::detail
