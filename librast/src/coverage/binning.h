// From a run of one draw's triangles to lists of those that each tile has to draw.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "geometry/homogeneous_triangle.h"
#include "kernels/kernels.h"
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

// A run of one chunk's entries that reach one tile.
struct TileWork {
    std::uint32_t chunk = 0, begin = 0, end = 0;
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

// Rows of a window's tiles.
struct TileRows {
    std::uint32_t begin = 0, end = 0;
};

// What a thread keeps between chunks.
struct BinScratch {
    CullResult kept;
    std::vector<std::uint32_t> counts;  // per tile, all zero between chunks
    std::vector<std::uint32_t> touched;
    std::vector<std::uint64_t> row_bytes;  // per row of tiles, summed over chunks
};

// What a chunk's entries and slices take, with the work that slices become.
inline std::uint64_t list_bytes(std::uint64_t entries, std::uint64_t slices) {
    return entries * sizeof(std::uint16_t) + slices * (sizeof(TileSlice) + sizeof(TileWork));
}

// Leaves the triangles that may be seen in scratch.kept and returns how many; sets the chunk's
// crossing triangles and counters. `several_samples`: every pixel that is touched counts, not only
// those whose centre is covered.
std::uint32_t cull_chunk(const DrawGeometry& geometry, const Window& window, bool several_samples,
                         const Kernels& kernels, BinScratch& scratch, TriangleChunk& chunk);

// What the lists of all chunks take together; threads ask before they allocate.
struct ListMemory {
    std::uint64_t most = UINT64_MAX;
    std::atomic<std::uint64_t> taken{0};
    bool take(std::uint64_t bytes) { return taken.fetch_add(bytes) + bytes <= most; }
};

// Lists what cull_chunk() left by tile, as far as it lies in these rows. False, and nothing listed:
// there is no memory left for it.
bool list_chunk(const Window& window, const TileRows& rows, std::uint32_t kept, ListMemory& memory,
                BinScratch& scratch, TriangleChunk& chunk);

// Both for all tiles, whatever they take.
void set_up_chunk(const DrawGeometry& geometry, const Window& window, bool several_samples,
                  const Kernels& kernels, BinScratch& scratch, TriangleChunk& chunk);

// Adds what the lists of cull_chunk()'s triangles would take to scratch.row_bytes.
void add_list_bytes(const Window& window, std::uint32_t kept, BinScratch& scratch);

}  // namespace rast::detail
