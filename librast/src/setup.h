// From a run of one draw's triangles to records ready to be rasterized, sorted by tile.
#pragma once

#include <array>
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
    std::vector<SetupTriangle> triangles;
    std::vector<CrossingTriangle> crossing;
    std::vector<std::uint32_t> order;  // by tile, then in submission order
    std::vector<TileSlice> slices;     // tiles that something of this chunk reaches
    Counters counters;
    // Triangle number and side of an entry of `order`.
    std::uint32_t id_of(std::uint32_t entry) const {
        return entry & order_crossing ? crossing[entry & ~order_crossing].id : triangles[entry].id;
    }
};

// What a thread keeps between chunks.
struct BinScratch {
    std::vector<std::uint32_t> counts;  // per tile, all zero between chunks
    std::vector<std::uint32_t> touched;
    std::vector<TileBox> boxes;          // of what is in `entries`
    std::vector<std::uint32_t> entries;  // as TriangleChunk::order, in submission order
    std::array<std::uint16_t, chunk_triangles> survivors;
    std::vector<std::uint16_t> snapped;  // of them, where others are crossing
};

// `several_samples`: every pixel that is touched counts, not only those whose centre is covered.
void set_up_chunk(const DrawGeometry& geometry, const Window& window, bool several_samples,
                  const Kernels& kernels, BinScratch& scratch, TriangleChunk& chunk);

}  // namespace rast::detail
