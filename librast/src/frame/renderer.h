// Everything between a plan and its frame; what pictures of one scene share is kept between them.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <memory>
#include <string>
#include <vector>

#include "draws/draw_stages.h"
#include "passes/tile_renderer.h"

namespace rast::detail {

// What the frame's pixels take.
std::uint64_t buffer_bytes(const Frame& frame);

void add_counters(Counters& to, const Counters& from);

class Renderer {
  public:
    explicit Renderer(const prep::PreparedScene& prepared) : prepared_(prepared) {}

    // Textures, vertices and draws for this plan, which must stay while it is drawn.
    void begin(const RenderPlan& plan);
    const std::vector<std::string>& warnings() const { return warnings_; }  // of begin()
    // Of the plan's texel_questions, whose textures are read and kept.
    std::vector<TexelFacts> texel_facts(const RenderPlan& plan);
    // A part of the picture: its triangles are culled and sorted by tile, once for all its rows or,
    // where their lists would take too much, for groups of rows when these are drawn.
    void place(const Crop& part);
    // Rows of that part, in any order: from a multiple of tile_size to another one, or to the
    // part's end. `frame` may hold an older picture, whose memory is used again. What is counted
    // once for the part is in the first rows' counters.
    void draw_rows(std::uint32_t first, std::uint32_t rows, Frame& frame);

  private:
    void load_texture(std::size_t slot);  // of the TextureSet
    void load_textures();
    void pair_textures();
    void transform();
    void make_draws();
    void light_vertices(std::size_t draw);
    DrawGeometry geometry_of(const TriangleChunk& chunk) const;
    std::uint64_t list_limit() const;
    void group_rows();
    bool list_rows(const TileRows& rows, std::uint64_t max_bytes);
    void free_lists();
    void sort_by_tile();
    void draw_tiles(const TileRows& rows, const TileInputs& inputs, Frame& frame);
    TileCounts resolve_areas(const Window& rows, Frame& frame);
    void size_buffers(Frame& frame) const;
    std::uint64_t texture_levels() const;
    PartClock* clock();  // of this thread; null: nothing is measured
    PartTimes part_times();

    const prep::PreparedScene& prepared_;
    const RenderPlan* plan_ = nullptr;
    const Kernels* kernels_ = nullptr;
    int threads_ = 0;
    std::vector<SampleOffset> offsets_;
    Window window_;
    // Spent and counted on what several pictures share, until one of them has told it.
    double shared_ms_ = 0;
    Counters shared_counters_;
    std::vector<std::string> warnings_;
    struct KeptTexture {
        bool tried = false;
        TextureLevels levels = TextureLevels::base;
        std::shared_ptr<MipTexture> texture;
        std::string warning;  // set: it cannot be read
        double read_ms = 0, levels_ms = 0;
        TexelQuestions asked;
        TexelFacts facts;
    };
    std::vector<KeptTexture> kept_;  // by slot of the TextureSet
    TextureSet textures_;
    FrameInputs inputs_;
    std::vector<RenderInstance> instances_;
    std::vector<std::vector<VertexRecord>> record_pool_;
    std::vector<Draw> draws_;
    std::vector<ShadeDraw> shade_draws_;
    StageLists stage_lists_;
    std::vector<TriangleChunk> chunks_;
    std::size_t chunk_count_ = 0;
    std::vector<TileRows> groups_;           // rows of tiles whose lists are made together
    std::size_t listed_ = 0;                 // the group whose lists these are:
    std::vector<TileWork> tile_work_;        // by tile
    std::vector<std::uint32_t> tile_begin_;  // in tile_work_, and one past the last one's end
    std::uint64_t textures_read_ = 0;        // those of the plan
    tbb::enumerable_thread_specific<BinScratch> bin_scratch_;
    tbb::enumerable_thread_specific<TileScratch> tile_scratch_;
    tbb::enumerable_thread_specific<PartClock> clocks_;
    double clock_reading_ = 0;  // nanoseconds
};

}  // namespace rast::detail
