// The fixed sizes of the pipeline and the records that pass between its stages.
//
// Screen coordinates are pixels from the picture's centre, x right, y down. Snapped ones have 8
// sub-pixel bits, at most guard_band pixels from the centre: 22 bits, which float holds exactly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rast::detail {

inline constexpr int subpixel_bits = 8;
inline constexpr std::int32_t subpixels = 1 << subpixel_bits;

// Twice this is the largest picture; differences of snapped coordinates stay below 2^23 and edge
// functions below 2^47: far inside 64 bits, and exact in double.
inline constexpr double guard_band = 16384;

inline constexpr std::int32_t tile_size = 64;
inline constexpr std::int32_t tile_pixels = tile_size * tile_size;
// The widest vector load may start at a tile's last pixel.
inline constexpr std::int32_t tile_padding = 16;

// Triangles that are culled and binned together.
inline constexpr std::uint32_t chunk_triangles = 4096;

// A vertex on the screen, as the kernels read it.
struct VertexRecord {
    std::int32_t x = 0, y = 0;  // snapped, in 1/256 pixels; or x is one of the marks below
    float w = 0;                // homogeneous
    float depth = 0;            // reversed: 1 at the near plane
};
// Behind the near plane or beyond the guard band: only edge equations from double help.
inline constexpr std::int32_t mark_unsnapped = INT32_MIN;
inline constexpr std::int32_t mark_non_finite = INT32_MIN + 1;
inline constexpr std::int32_t first_valid = -(1 << 30);  // every snapped coordinate is above

inline constexpr std::uint32_t id_back_face = 0x80000000u;
inline constexpr std::uint32_t id_none = 0xFFFFFFFFu;

// How a chunk's triangles are listed: the number within the chunk, with its side; or the number of
// one that is drawn through homogeneous edges (geometry/homogeneous_triangle.h).
inline constexpr std::uint16_t entry_back_face = 0x4000, entry_crossing = 0x8000;
inline constexpr std::uint16_t entry_number = chunk_triangles - 1;

// Triangles with area on the sub-pixel grid, side by side, turned so that their edge functions are
// positive inside. Few enough to stay in the first-level cache while a tile draws them.
struct SetupBlock {
    static constexpr std::size_t capacity = 128;
    std::int32_t x[3][capacity], y[3][capacity];         // in 1/256 pixels
    float z0[capacity], dzdx[capacity], dzdy[capacity];  // depth plane through the first corner,
                                                         // per pixel
    // The corners' range: depth never leaves it; below 0: beyond the far plane, not drawn.
    float z_low[capacity], z_high[capacity];
    std::int32_t id[capacity];  // triangle numbers, id_back_face set on back faces
};

// Fixed-point depth of n bits, kept as floats: k / 2^n for k = 0 … 2^n − 1, the nearest one (of
// two, the even). Exact without integers: adding a number whose float has the grid's step rounds to
// it. Above `half` a float of at most 1 lies on the grid already (24 bits are all that it has).
struct DepthGrid {
    float half = 0, shift = 0, top = 1;  // shift 0: depths stay as they are
    explicit operator bool() const { return shift > 0; }
    float operator()(float z) const {
        if (shift == 0 || !(z >= 0)) return z;
        const float low = z < half ? z : half;
        const float on = ((low + shift) - shift) + (z - low);
        return on < top ? on : top;
    }
};
inline constexpr DepthGrid fixed16_grid{2.0f, 192.0f, 1.0f - 0x1p-16f};
inline constexpr DepthGrid fixed24_grid{0.5f, 0.5f, 1.0f - 0x1p-24f};

// The part of the picture that is drawn.
struct Window {
    std::int32_t width = 0, height = 0;
    std::int32_t first_x = 0, first_y = 0;  // centre of its pixel (0, 0), in 1/256 pixels
    std::int32_t tiles_x = 0, tiles_y = 0;
    DepthGrid grid = {};
    std::uint32_t tile_count() const { return std::uint32_t(tiles_x) * std::uint32_t(tiles_y); }
};

// Where a tile's samples lie.
struct TilePlace {
    std::int32_t x = 0, y = 0;  // sample of its first pixel, in 1/256 pixels
    std::int32_t width = tile_size, height = tile_size;
    DepthGrid grid = {};
    bool skip_hidden = true;  // by blocks, before they are drawn; changes no bit
};

// Depth and triangle of one sample per pixel, row by row.
struct TileSamples {
    std::vector<float> depth;       // −1: nothing yet
    std::vector<std::uint32_t> id;  // id_none: nothing yet
    void clear();
};

}  // namespace rast::detail
