// The inner loops of the rasterizer as a table of functions, one table per instruction set. The
// scalar table is the reference; every other table gives the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "geometry/tile.h"
#include "plan/draw_choice.h"
#include "plan/shade_stages.h"
#include "prep/material.h"
#include "prep/scene.h"
#include "prep/simd.h"
#include "shading/texture.h"

namespace rast::detail {

class VertexSource;

// Vertices `begin` … `end` through the rows of a homogeneous matrix (x·w, y·w in pixels from the
// centre, depth·w, w).
struct TransformTask {
    const float* positions = nullptr;
    double rows[4][4] = {};
    VertexRecord* out = nullptr;
};

// Which triangles of a run are worth drawing.
struct CullTask {
    const VertexRecord* records = nullptr;
    const std::uint32_t* indices = nullptr;  // three per triangle
    std::uint32_t count = 0;                 // at most chunk_triangles
    bool mirrored = false, drop_back = false, drop_front = false;
    bool every_touched_pixel = false;  // more than one sample per pixel
    Window window;
};
struct CullCounts {
    std::uint32_t non_finite = 0, degenerate = 0, facing_away = 0, outside = 0, between_samples = 0;
    std::uint32_t crossing = 0;  // kept, with a corner that is not snapped
};
// Those that are left, in order.
struct CullResult {
    static constexpr std::size_t capacity = chunk_triangles + tile_padding;
    std::int32_t entries[capacity];  // as TriangleChunk::order; crossing ones: their own number
    // The one tile that the box of the triangle reaches, or several_tiles; nothing for crossing
    // ones. Its columns and rows: the first one and above it, from bit 16 on, the last one.
    static constexpr std::int32_t several_tiles = -1;
    std::int32_t tile[capacity], columns[capacity], rows[capacity];
};

// Entries of a chunk to be set up, none of them crossing.
struct SetupTask {
    const VertexRecord* records = nullptr;
    const std::uint32_t* indices = nullptr;  // of the chunk's first triangle on
    std::uint32_t first_id = 0;              // of that
    const std::uint16_t* entries = nullptr;
    std::uint32_t count = 0;  // at most SetupBlock::capacity
};

// Where maps are read: the UV layer, and uv' = offset + matrix · uv.
struct MapPlace {
    const float* uv = nullptr;       // two per vertex
    float matrix[4] = {1, 0, 0, 1};  // row by row
    float offset[2] = {0, 0};
    friend bool operator==(const MapPlace&, const MapPlace&) = default;
};

// A texture map of a draw.
struct BoundMap {
    const MipTexture* texture = nullptr;  // null: no map
    std::uint8_t place = 0;               // of ShadeDraw::places
    // The same texels, with the same weights, are read of the map before it in ShadeDraw::used.
    bool same_texels = false;
    float strength = 1;
    TextureFilter filter = TextureFilter::trilinear;
    int most = 8;  // anisotropy
    explicit operator bool() const { return texture != nullptr; }
};

// Those of a draw, by kind.
struct BoundMaps {
    BoundMap of[drawn_maps];
    BoundMap& operator[](MapKind kind) { return of[std::size_t(kind)]; }
    const BoundMap& operator[](MapKind kind) const { return of[std::size_t(kind)]; }
};

struct ShadeLight {
    prep::LightKind kind = prep::LightKind::directional;
    float to_light[3] = {};  // directional and spot: unit, against the way it shines
    float position[3] = {};  // point, spot: from the eye, world axes
    float color[3] = {};
    float inv_range = 0;                    // 0: no limit
    float cone_scale = 0, cone_offset = 1;  // spot: attenuation = clamp(cos · scale + offset)²
};

// What all draws of a picture share.
struct ShadeFrame {
    // From a surface towards the eye, not normalised: at[0] + x · at[1] + y · at[2], world axes,
    // x and y in pixels from the picture's centre.
    float to_eye[3][3] = {};
    bool perspective = true;
    float ambient[3] = {};
    const ShadeLight* lights = nullptr;
    std::size_t light_count = 0;
};

// Floats per vertex of Gouraud light: diffuse and specular, on the front, then on the back.
inline constexpr std::size_t vertex_light_floats = 12;

// What the pixels of one draw need.
struct ShadeDraw {
    const VertexSource* source_vertices = nullptr;
    const std::uint32_t* indices = nullptr;  // of the mesh
    const VertexRecord* records = nullptr;
    const float* positions = nullptr;
    const float* normals = nullptr;
    const float* tangents = nullptr;
    const float* colors = nullptr;
    const float* vertex_light = nullptr;  // Gouraud
    std::uint32_t first_id = 0, first_triangle = 0, triangle_count = 0;
    NormalSource source = NormalSource::interpolated;
    bool masked = false, unlit = false, metallic_roughness = false;
    bool highlights = true;  // false: their colour is 0 everywhere
    bool glows = false;      // by its emissive factor
    float metallic = 0, roughness = 1, reflectance[3] = {};
    float normal_matrix[9] = {};  // row by row
    bool world_normals = false;   // that is the identity
    float from_eye[3][4] = {};    // rows: mesh position → position from the eye, world axes
    float ambient[3] = {}, diffuse[4] = {}, specular[3] = {}, emissive[3] = {};
    float shininess = 0, alpha_cutoff = 0;
    bool flip_green = false;
    BoundMaps maps;
    MapPlace places[drawn_maps];
    MapKind used[drawn_maps] = {};  // the kinds of its maps, those on the same texels together
    std::uint8_t used_count = 0, place_count = 0;
    // What is done at its points for colours and for what is kept beside them.
    const StageList* color_stages = nullptr;
    const StageList* attribute_stages = nullptr;
};

// Where bytes of a tile, or of neighbours in a row, go.
struct PictureRows {
    std::uint32_t* first = nullptr;  // of the first pixel; null: nowhere
    std::size_t stride = 0;          // from row to row
};

// Pixels of a row that show the same triangle.
struct PixelRun {
    std::uint32_t number = 0;
    std::uint16_t pixel = 0, length = 0;
};

// Points of one triangle, which follow each other in a list.
struct TriangleRun {
    std::uint32_t id = 0, end = 0;  // one past its last point
};

// Is told when a stage has gone over a portion of points, by its number in the list, and where
// their planes lie: `planes`, so many floats apart.
struct StageWatch {
    void (*after)(StageWatch& self, const StageList& list, std::size_t stage, float* planes,
                  std::size_t stride) = nullptr;
};

// Points of one draw by triangle.
struct ShadeTask {
    TilePlace place;
    const std::uint16_t* pixels = nullptr;  // of the tile, row by row; readable to the lane count
                                            // past the end
    const TriangleRun* runs = nullptr;
    std::size_t run_count = 0;
    std::size_t begin = 0;  // of the first run
    float* out[3] = {};     // red, green, blue of point 0; writable to the lane count past the
                            // end; or
    std::uint32_t* bytes = nullptr;  // of the tile, row by row, as `pack` makes them
    StageWatch* watch = nullptr;     // null: nobody is told
};

// What can be asked of a point beside its colour; three, two, three and three planes, each as
// ShadeTask::out; null where not asked for.
struct AttributeTask {
    TilePlace place;
    const std::uint16_t* pixels = nullptr;  // as ShadeTask's
    const TriangleRun* runs = nullptr;
    std::size_t run_count = 0;
    std::size_t begin = 0;
    const float* uvs = nullptr;  // of the mesh, two per vertex; null: none
    float* normal[3] = {};
    float* uv[2] = {};
    float* barycentric[3] = {};
    float* position[3] = {};
    StageWatch* watch = nullptr;
};

struct Kernels {
    void (*transform)(const TransformTask& task, std::size_t begin, std::size_t end);
    std::uint32_t (*cull)(const CullTask& task, CullResult& result, CullCounts& counts);
    void (*set_up)(const SetupTask& task, SetupBlock& block);
    // Draws the block's first `count` triangles into a tile, numbered from `first_number` on; of
    // equal depths the lower number wins. Whatever is there already has a lower one. `masked` is
    // null or the draw whose alpha decides.
    void (*raster)(float* depth, std::uint32_t* number, const TilePlace& place,
                   const SetupBlock& block, std::size_t count, std::uint32_t first_number,
                   const ShadeDraw* masked);
    // The runs of a tile's numbers, row by row; returns how many. `counts`: pixels per number,
    // added to. `runs` has room for every pixel. The picture's rows are asked for: when they are
    // written, they have come.
    std::size_t (*collect)(const std::uint32_t* numbers, const TilePlace& place,
                           std::uint32_t* counts, PixelRun* runs, const PictureRows& picture);
    // The runs' pixels, each number's from counts[number] on, which is moved past them. Readable
    // and writable up to tile_padding past the last one; what is beside a run stays.
    void (*expand)(const PixelRun* runs, std::size_t count, std::uint32_t* counts,
                   std::uint16_t* pixels);
    void (*shade)(const ShadeDraw& draw, const ShadeFrame& frame, const ShadeTask& task);
    void (*attributes)(const ShadeDraw& draw, const ShadeFrame& frame, const AttributeTask& task);
    // Gouraud: the listed vertices; out has vertex_light_floats for every vertex of the mesh.
    void (*light_vertices)(const ShadeDraw& draw, const ShadeFrame& frame,
                           const std::uint32_t* vertices, std::size_t count, float* out);
    // Whether the alpha mask lets one point stand.
    bool (*covers)(const ShadeDraw& draw, std::int32_t x, std::int32_t y, std::uint32_t id);
    // Colours to bytes, red lowest, the highest byte 255; writable up to the lane count past the
    // end, and readable but for a count of 1.
    void (*pack)(const float* red, const float* green, const float* blue, std::size_t count,
                 std::uint32_t* out);
    // Writes `value` to all pixels; past the caches, what is in them stays.
    void (*fill)(const PictureRows& picture, std::int32_t width, std::int32_t height,
                 std::uint32_t value, bool past_caches);
    // out = (cos)^shininess for angles given by their squared sine and cosine; for tests.
    void (*specular_powers)(const float* sine2, const float* cosine2, float shininess,
                            std::size_t count, float* out);
};

const Kernels& scalar_kernels();
// Those of the level, or the best that this machine and this build have below it.
const Kernels& kernels_for(prep::SimdLevel level);

}  // namespace rast::detail
