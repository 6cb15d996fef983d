// From a run of one draw's triangles to lists of those that each tile has to draw.
#pragma once

#include <cstdint>
#include <vector>

#include "crossing.h"
#include "rast/render.h"

namespace rast::detail {

enum class CullSide : std::uint8_t { none, back, front };

struct DrawGeometry {
    const VertexSource* source = nullptr;
    const VertexRecord* records = nullptr;
    const std::uint32_t* indices = nullptr;  // of the mesh, three per triangle
    bool mirrored = false;
    CullSide cull = CullSide::none;
};

struct TileSlice {
    std::uint32_t tile = 0, begin = 0, end = 0;  // of TriangleChunk::order
};

struct TriangleChunk {
    std::uint32_t draw = 0;
    std::uint32_t first_triangle = 0, count = 0;  // of the mesh; at most chunk_triangles
    std::uint32_t first_id = 0;                   // of its first triangle
    const VertexRecord* records = nullptr;
    const std::uint32_t* indices = nullptr;  // of its first triangle on
    std::vector<CrossingTriangle> crossing;
    std::vector<std::uint16_t> order;  // entries by tile, then in submission order
    std::vector<TileSlice> slices;     // tiles that something of this chunk reaches
    Counters counters;
    // Triangle number and side of an entry of `order`.
    std::uint32_t id_of(std::uint16_t entry) const {
        if (entry & entry_crossing) return crossing[entry & entry_number].id;
        return (first_id + (entry & entry_number)) | (entry & entry_back_face ? id_back_face : 0u);
    }
};

// What a thread keeps between chunks.
struct BinScratch {
    CullResult kept;
    std::vector<std::uint32_t> counts;  // per tile, all zero between chunks
    std::vector<std::uint32_t> touched;
};

// `several_samples`: every pixel that is touched counts, not only those whose centre is covered.
void set_up_chunk(const DrawGeometry& geometry, const Window& window, bool several_samples,
                  const Kernels& kernels, BinScratch& scratch, TriangleChunk& chunk);

}  // namespace rast::detail
