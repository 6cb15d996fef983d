#include "frame/renderer.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>
#include <utility>

#include "base/scratch_buffer.h"
#include "passes/area_resolve.h"
#include "passes/parallel_tiles.h"
#include "plan/draw_choice.h"
#include "shading/slopes.h"

namespace rast::detail {
namespace {

using Clock = std::chrono::steady_clock;

// Vertices that one task takes: large enough to hide the cost of a task.
constexpr std::size_t vertex_grain = 16384;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

CullSide cull_side(const RenderPlan& plan, const prep::PreparedScene& prepared,
                   std::uint32_t material) {
    switch (plan.request.cull) {
        case Cull::none:
            return CullSide::none;
        case Cull::back:
            return CullSide::back;
        case Cull::front:
            return CullSide::front;
        case Cull::by_material:
            break;
    }
    const bool double_sided = material < prepared.scene.materials.size() &&
                              prepared.scene.materials[material].double_sided;
    return double_sided ? CullSide::none : CullSide::back;
}

DepthGrid depth_grid(DepthFormat format) {
    switch (format) {
        case DepthFormat::fixed16:
            return fixed16_grid;
        case DepthFormat::fixed24:
            return fixed24_grid;
        case DepthFormat::float32:
            break;
    }
    return {};
}

}  // namespace

std::uint64_t buffer_bytes(const Frame& f) {
    const auto size = [](const auto& buffer) { return buffer.size() * sizeof(buffer[0]); };
    return size(f.color) + size(f.bytes) + size(f.depth) + size(f.triangle) + size(f.instance) +
           size(f.normal) + size(f.uv) + size(f.barycentric) + size(f.position);
}

void add_counters(Counters& to, const Counters& from) {
    to.triangles += from.triangles;
    to.non_finite += from.non_finite;
    to.degenerate += from.degenerate;
    to.facing_away += from.facing_away;
    to.outside += from.outside;
    to.between_samples += from.between_samples;
    to.crossing += from.crossing;
    to.vertices_lit += from.vertices_lit;
    to.pixels_shaded += from.pixels_shaded;
    to.texture_samples += from.texture_samples;
    to.light_points += from.light_points;
    to.highlight_points += from.highlight_points;
    to.normal_map_points += from.normal_map_points;
    to.masked_triangles += from.masked_triangles;
    to.sample_points += from.sample_points;
    for (std::size_t k = 0; k < shade_stages; ++k) to.stage_points[k] += from.stage_points[k];
    // Held by all parts, or by one at a time.
    to.textures_read = std::max(to.textures_read, from.textures_read);
    to.texture_levels = std::max(to.texture_levels, from.texture_levels);
    to.buffer_bytes = std::max(to.buffer_bytes, from.buffer_bytes);
    to.list_bytes = std::max(to.list_bytes, from.list_bytes);
}

void Renderer::begin(const RenderPlan& plan) {
    const Clock::time_point start = Clock::now();
    plan_ = &plan;
    kernels_ = &kernels_for(plan.request.simd);
    threads_ = plan.request.threads;
    offsets_ = sample_offsets(plan.request.samples);
    shared_counters_ = {};
    clocks_.clear();
    if (plan.request.timed) clock_reading_ = PartClock::reading();
    load_textures();
    transform();
    make_draws();
    shared_ms_ = milliseconds_since(start);
}

void Renderer::place(const Crop& part) {
    const Clock::time_point start = Clock::now();
    const auto first = [](std::uint32_t at, std::uint32_t extent) {
        return (1 - std::int32_t(extent)) * (subpixels / 2) + std::int32_t(at) * subpixels;
    };
    window_.width = std::int32_t(part.width);
    window_.height = std::int32_t(part.height);
    window_.first_x = first(part.x, plan_->request.width);
    window_.first_y = first(part.y, plan_->request.height);
    window_.tiles_x = (window_.width + tile_size - 1) / tile_size;
    window_.tiles_y = (window_.height + tile_size - 1) / tile_size;
    window_.grid = depth_grid(plan_->request.depth_format);
    const TileRows all{0, std::uint32_t(window_.tiles_y)};
    groups_.assign(1, all);
    listed_ = 0;
    const bool listed = list_rows(all, list_limit());
    for (std::size_t c = 0; c < chunk_count_; ++c)
        add_counters(shared_counters_, chunks_[c].counters);
    if (!listed) group_rows();
    shared_ms_ += milliseconds_since(start);
}

void Renderer::draw_rows(std::uint32_t first, std::uint32_t rows, Frame& frame) {
    frame.geometry_ms = shared_ms_;
    shared_ms_ = 0;
    const Clock::time_point start = Clock::now();
    frame.width = std::uint32_t(window_.width);
    frame.height = rows;
    {
        const PartTimer timer(clock(), DrawingPart::clearing);
        size_buffers(frame);
    }
    TileInputs inputs;
    inputs.plan = plan_;
    inputs.kernels = kernels_;
    inputs.offsets = &offsets_;
    inputs.instances = &instances_;
    inputs.draws = &draws_;
    inputs.shade_draws = &shade_draws_;
    inputs.chunks = &chunks_;
    inputs.shade_frame = &inputs_.frame;
    // Measured: it pays where several threads want their texels to stay in the caches.
    inputs.clear_past_caches =
        threads_ != 1 && std::any_of(textures_.begin(), textures_.end(),
                                     [](const auto& texture) { return texture != nullptr; });
    inputs.window = window_;
    inputs.first_row = std::int32_t(first);
    for (TileScratch& scratch : tile_scratch_) scratch.done = {};
    const std::uint32_t begin = first / tile_size, end = (first + rows + tile_size - 1) / tile_size;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const TileRows part{std::max(begin, groups_[g].begin), std::min(end, groups_[g].end)};
        if (part.begin >= part.end) continue;
        if (g != listed_) list_rows(groups_[g], UINT64_MAX);
        listed_ = g;
        draw_tiles(part, inputs, frame);
    }
    TileCounts counts;
    for (const TileScratch& scratch : tile_scratch_) counts += scratch.done;
    if (plan_->request.coverage == Coverage::area && plan_->request.keep_color) {
        Window part = window_;
        part.first_y += std::int32_t(first) * subpixels;
        part.height = std::int32_t(rows);
        part.tiles_y = (part.height + tile_size - 1) / tile_size;
        counts += resolve_areas(part, frame);
    }
    frame.counters = shared_counters_;
    shared_counters_ = {};
    frame.counters.pixels_shaded += counts.shaded;
    frame.counters.texture_samples += counts.texture_samples;
    frame.counters.light_points += counts.light_points;
    frame.counters.highlight_points += counts.highlight_points;
    frame.counters.normal_map_points += counts.normal_map_points;
    frame.counters.masked_triangles += counts.masked_triangles;
    frame.counters.sample_points += counts.sample_points;
    for (std::size_t k = 0; k < shade_stages; ++k)
        frame.counters.stage_points[k] += counts.stage_points[k];
    frame.counters.textures_read = textures_read_;
    frame.counters.texture_levels = texture_levels();
    frame.counters.buffer_bytes = buffer_bytes(frame);
    frame.part_ms = part_times();
    frame.raster_ms = milliseconds_since(start);
}

PartClock* Renderer::clock() {
    return plan_->request.timed ? &clocks_.local() : nullptr;
}

PartTimes Renderer::part_times() {
    PartTimes times{};
    if (!plan_->request.timed) return times;
    for (PartClock& clock : clocks_) clock.tell(clock_reading_, times);
    for (std::size_t slot = 0; slot < kept_.size(); ++slot) {
        if (!plan_->textures_read[slot]) continue;
        times[std::size_t(DrawingPart::textures)] += kept_[slot].read_ms;
        times[std::size_t(DrawingPart::levels)] += kept_[slot].levels_ms;
    }
    return times;
}

namespace {

// What is drawn in place of a colour map that cannot be decoded: nobody takes it for the picture.
prep::Image checker() {
    constexpr std::uint32_t extent = 64, square = 8;
    prep::Image image;
    image.width = image.height = extent;
    image.channels = 3;
    image.srgb = true;
    for (std::uint32_t y = 0; y < extent; ++y)
        for (std::uint32_t x = 0; x < extent; ++x) {
            const bool odd = (x / square + y / square) % 2 != 0;
            for (const float value : {odd ? 0.9f : 0.35f, odd ? 0.1f : 0.35f, odd ? 0.9f : 0.35f})
                image.pixels.push_back(value);
        }
    return image;
}

}  // namespace

// Unless it is there.
void Renderer::load_texture(std::size_t slot) {
    const prep::Scene& scene = prepared_.scene;
    const std::size_t textures = scene.textures.size();
    const bool colour = slot < textures, bump = slot >= (texture_uses - 1) * textures;
    const prep::Texture& texture = scene.textures[slot % textures];
    KeptTexture& kept = kept_[slot];
    const TextureLevels levels =
        levels_for(filter_for(plan_->request.filter, texture), texture.mip);
    if (kept.tried && kept.levels == levels) return;
    kept = {true, levels, nullptr, {}, 0, 0, {}, {}};
    const Clock::time_point reading = Clock::now();
    auto image = prep::load_image(scene.images[texture.image]);
    if (!image) {
        // A picture of a kind that is known and not read is no reason for a bare surface.
        const bool known = image.error().code == prep::ErrorCode::unsupported;
        kept.warning = (known ? "texture drawn as a checker: " : "texture left out: ") +
                       prep::to_string(image.error());
        if (known && colour) image = checker();
    }
    kept.read_ms = milliseconds_since(reading);
    const Clock::time_point making = Clock::now();
    if (image && bump) {
        const Slopes slopes = slopes_of(*image, texture);
        kept.texture =
            std::make_shared<MipTexture>(slopes.image, slopes.sampler, false, levels, slopes.units);
    } else if (image) {
        kept.texture =
            std::make_shared<MipTexture>(*image, texture, colour && !image->floating, levels);
    }
    kept.levels_ms = milliseconds_since(making);
}

std::vector<TexelFacts> Renderer::texel_facts(const RenderPlan& plan) {
    plan_ = &plan;
    const prep::Scene& scene = prepared_.scene;
    const std::size_t textures = scene.textures.size();
    kept_.resize(texture_uses * textures);
    std::vector<TexelFacts> facts(plan.texel_questions.size());
    for (std::size_t slot = 0; slot < facts.size(); ++slot) {
        const TexelQuestions& asked = plan.texel_questions[slot];
        if (!asked || scene.textures[slot % textures].image >= scene.images.size()) continue;
        load_texture(slot);
        KeptTexture& kept = kept_[slot];
        if (kept.texture && kept.asked != asked) {
            kept.asked = asked;
            kept.facts = kept.texture->facts(asked, plan.request.threads);
        }
        facts[slot] = kept.facts;
    }
    return facts;
}

void Renderer::load_textures() {
    const prep::Scene& scene = prepared_.scene;
    const std::size_t textures = scene.textures.size();
    kept_.resize(texture_uses * textures);
    textures_.assign(texture_uses * textures, nullptr);
    textures_read_ = 0;
    warnings_.clear();
    for (std::size_t t = 0; t < textures; ++t) {
        if (scene.textures[t].image >= scene.images.size()) continue;
        bool told = false;  // or counted
        for (std::size_t use = 0; use < texture_uses; ++use) {
            const std::size_t slot = use * textures + t;
            if (!plan_->textures_read[slot]) continue;
            load_texture(slot);
            const KeptTexture& kept = kept_[slot];
            textures_[slot] = kept.texture;
            if (std::exchange(told, true)) continue;
            if (kept.warning.empty())
                ++textures_read_;
            else
                warnings_.push_back(kept.warning);
        }
    }
    pair_textures();
    if (plan_->request.prune) return;
    for (const auto& texture : textures_)
        if (texture) texture->make_all_levels();
    add_neutral_maps(textures_, levels_for(filter_for(plan_->request.filter, {})));
}

// Maps of one material that are read at the same places.
void Renderer::pair_textures() {
    const auto loaded = [&](MapKind kind, const prep::TextureRef& ref) -> MipTexture* {
        const std::size_t slot = texture_slot(prepared_.scene.textures.size(), kind, ref);
        return slot < kept_.size() && textures_[slot] ? kept_[slot].texture.get() : nullptr;
    };
    const auto same_place = [](const prep::TextureRef& a, const prep::TextureRef& b) {
        return a.uv_set == b.uv_set && a.offset == b.offset && a.scale == b.scale &&
               a.rotation == b.rotation;
    };
    for (const prep::Material& m : prepared_.scene.materials) {
        // In the order in which two at a time are read.
        for (std::size_t i = 0; i < drawn_maps; ++i)
            for (std::size_t j = i + 1; j < drawn_maps; ++j) {
                const prep::TextureRef& first = m.*prep::material_maps[i].ref;
                const prep::TextureRef& second = m.*prep::material_maps[j].ref;
                MipTexture* const a = loaded(MapKind(i), first);
                MipTexture* const b = loaded(MapKind(j), second);
                if (a != nullptr && b != nullptr && same_place(first, second) &&
                    MipTexture::put_together(*a, *b))
                    break;
            }
    }
}

void Renderer::transform() {
    const std::vector<glm::dmat4> world = prep::world_transforms(prepared_.scene);
    record_pool_.resize(std::max(record_pool_.size(), instances_.size()));
    for (std::size_t i = 0; i < instances_.size(); ++i)
        record_pool_[i] = std::move(instances_[i].records);
    instances_.clear();
    for (std::uint32_t n = 0; n < prepared_.scene.nodes.size(); ++n) {
        const std::uint32_t m = prepared_.scene.nodes[n].mesh;
        if (m == prep::no_index || prepared_.meshes[m].triangle_count() == 0) continue;
        const std::size_t i = instances_.size();
        instances_.emplace_back(
            prepared_.meshes[m], n, world[n], plan_->view, plan_->request.width,
            plan_->request.height,
            i < record_pool_.size() ? std::move(record_pool_[i]) : std::vector<VertexRecord>());
    }
    struct Block {
        std::size_t instance, begin, end;
    };
    std::vector<Block> blocks;
    for (std::size_t i = 0; i < instances_.size(); ++i)
        for (std::size_t v = 0, n = instances_[i].mesh().vertex_count(); v < n; v += vertex_grain)
            blocks.push_back({i, v, std::min(n, v + vertex_grain)});
    parallel_items(blocks.size(), threads_, [&](std::size_t b) {
        const PartTimer timer(clock(), DrawingPart::vertices);
        instances_[blocks[b].instance].transform(*kernels_, blocks[b].begin, blocks[b].end);
    });
}

void Renderer::make_draws() {
    set_up_frame(*plan_, inputs_);
    draws_.clear();
    shade_draws_.clear();
    chunk_count_ = 0;
    std::uint32_t id = 0;
    for (std::uint32_t i = 0; i < instances_.size(); ++i)
        for (const prep::VertexMesh::Range& range : instances_[i].mesh().ranges) {
            if (range.triangle_count == 0) continue;
            draws_.push_back({i, range.material, range.first_triangle, range.triangle_count});
            shade_draws_.push_back(
                shade_draw(*plan_, prepared_, draws_.back(), instances_[i], textures_));
            shade_draws_.back().first_id = id;
            for (std::uint32_t t = 0; t < range.triangle_count; t += chunk_triangles) {
                if (chunk_count_ == chunks_.size()) chunks_.emplace_back();
                TriangleChunk& chunk = chunks_[chunk_count_++];
                chunk.draw = std::uint32_t(draws_.size() - 1);
                chunk.first_triangle = range.first_triangle + t;
                chunk.count = std::min(chunk_triangles, range.triangle_count - t);
                chunk.first_id = id + t;
            }
            id += range.triangle_count;
        }
    const bool colors = plan_->request.keep_color || !plan_->request.prune;
    if (plan_->request.shading == Shading::gouraud && colors)
        for (std::size_t d = 0; d < draws_.size(); ++d) light_vertices(d);
    stage_lists_.begin(*plan_, inputs_.frame);
    for (std::size_t d = 0; d < draws_.size(); ++d) {
        const prep::VertexMesh& mesh = instances_[draws_[d].instance].mesh();
        stage_lists_.bind(!mesh.uvs.empty() && !mesh.uvs[0].empty(), shade_draws_[d]);
    }
}

void Renderer::light_vertices(std::size_t d) {
    ShadeDraw& draw = shade_draws_[d];
    RenderInstance& instance = instances_[draws_[d].instance];
    if (draw.normals == nullptr || draw.unlit) return;
    instance.vertex_light.resize(instance.mesh().vertex_count() * vertex_light_floats);
    std::vector<std::uint32_t> vertices(
        draw.indices + std::size_t(draw.first_triangle) * 3,
        draw.indices + (std::size_t(draw.first_triangle) + draw.triangle_count) * 3);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    shared_counters_.vertices_lit += vertices.size();
    const std::size_t blocks = (vertices.size() + vertex_grain - 1) / vertex_grain;
    parallel_items(blocks, threads_, [&](std::size_t b) {
        const PartTimer timer(clock(), DrawingPart::vertex_light);
        const std::size_t begin = b * vertex_grain;
        kernels_->light_vertices(draw, inputs_.frame, vertices.data() + begin,
                                 std::min(vertex_grain, vertices.size() - begin),
                                 instance.vertex_light.data());
    });
    draw.vertex_light = instance.vertex_light.data();
}

void Renderer::draw_tiles(const TileRows& rows, const TileInputs& shared, Frame& frame) {
    TileInputs inputs = shared;
    inputs.work = tile_work_.data();
    inputs.work_begin = tile_begin_.data();
    inputs.frame = &frame;
    const std::size_t first = std::size_t(rows.begin) * std::size_t(window_.tiles_x);
    const std::size_t tiles = std::size_t(rows.end - rows.begin) * std::size_t(window_.tiles_x);
    parallel_items(tiles, threads_, [&](std::size_t tile) {
        TileScratch& scratch = tile_scratch_.local();
        scratch.clock = clock();
        scratch.done += draw_tile(inputs, std::uint32_t(first + tile), scratch);
    });
}

DrawGeometry Renderer::geometry_of(const TriangleChunk& chunk) const {
    const Draw& draw = draws_[chunk.draw];
    const RenderInstance& instance = instances_[draw.instance];
    return {&instance, instance.records.data(), instance.mesh().indices.data(), instance.mirrored(),
            cull_side(*plan_, prepared_, draw.material)};
}

// Beside what small triangles take, which grows with the mesh alone: two tiles each and, as far
// apart as they can be, a slice of its own for each.
std::uint64_t Renderer::list_limit() const {
    if (window_.tiles_y == 1) return UINT64_MAX;  // there is nothing smaller
    std::uint64_t triangles = 0;
    for (const Draw& draw : draws_) triangles += draw.triangle_count;
    const std::uint64_t more = list_bytes(2 * triangles, triangles);
    return more + std::min(plan_->request.band_bytes, UINT64_MAX - more);
}

// Groups whose lists stay within the limit; a row of tiles is the smallest.
void Renderer::group_rows() {
    for (BinScratch& scratch : bin_scratch_) scratch.row_bytes.clear();
    parallel_items(chunk_count_, threads_, [&](std::size_t c) {
        const PartTimer timer(clock(), DrawingPart::culling);
        BinScratch& scratch = bin_scratch_.local();
        const std::uint32_t kept = cull_chunk(geometry_of(chunks_[c]), window_, offsets_.size() > 1,
                                              *kernels_, scratch, chunks_[c]);
        add_list_bytes(window_, kept, scratch);
    });
    groups_.clear();
    listed_ = SIZE_MAX;
    std::uint64_t taken = 0;
    for (std::uint32_t row = 0; row < std::uint32_t(window_.tiles_y); ++row) {
        std::uint64_t bytes = 0;
        for (const BinScratch& scratch : bin_scratch_)
            if (row < scratch.row_bytes.size()) bytes += scratch.row_bytes[row];
        if (groups_.empty() || taken + bytes > list_limit()) {
            groups_.push_back({row, row});
            taken = 0;
        }
        groups_.back().end = row + 1;
        taken += bytes;
    }
}

// Lists these rows' triangles by tile. False: they would take more than max_bytes.
bool Renderer::list_rows(const TileRows& rows, std::uint64_t max_bytes) {
    // Chunks' lists grow and shrink from group to group: none keeps its largest.
    if (groups_.size() > 1) free_lists();
    ListMemory memory{max_bytes};
    std::atomic<bool> fits{true};
    parallel_items(chunk_count_, threads_, [&](std::size_t c) {
        const PartTimer timer(clock(), DrawingPart::culling);
        TriangleChunk& chunk = chunks_[c];
        BinScratch& scratch = bin_scratch_.local();
        const std::uint32_t kept =
            cull_chunk(geometry_of(chunk), window_, offsets_.size() > 1, *kernels_, scratch, chunk);
        if (!fits || !list_chunk(window_, rows, kept, memory, scratch, chunk)) fits = false;
    });
    if (!fits) {
        free_lists();
        return false;
    }
    shared_counters_.list_bytes = std::max(shared_counters_.list_bytes, memory.taken.load());
    sort_by_tile();
    return true;
}

void Renderer::free_lists() {
    for (TriangleChunk& chunk : chunks_) {
        chunk.order = {};
        chunk.slices = {};
    }
    tile_work_ = {};
}

void Renderer::sort_by_tile() {
    const PartTimer timer(clock(), DrawingPart::culling);
    tile_begin_.assign(window_.tile_count() + 1, 0);
    for (std::size_t c = 0; c < chunk_count_; ++c)
        for (const TileSlice& slice : chunks_[c].slices) ++tile_begin_[slice.tile + 1];
    std::partial_sum(tile_begin_.begin(), tile_begin_.end(), tile_begin_.begin());
    tile_work_.resize(tile_begin_.back());
    // Each tile's begin moves to its end, which is the next one's begin.
    for (std::uint32_t c = 0; c < chunk_count_; ++c)
        for (const TileSlice& slice : chunks_[c].slices)
            tile_work_[tile_begin_[slice.tile]++] = {c, slice.begin, slice.end};
    std::copy_backward(tile_begin_.begin(), tile_begin_.end() - 1, tile_begin_.end());
    tile_begin_[0] = 0;
}

TileCounts Renderer::resolve_areas(const Window& rows, Frame& frame) {
    CoverageScene scene{plan_, kernels_, &instances_, &draws_, &shade_draws_, &inputs_.frame, {}};
    for (const Draw& draw : draws_)
        scene.cull.push_back(cull_side(*plan_, prepared_, draw.material));
    scene.clock = [this] { return clock(); };
    return resolve_coverage(scene, rows, threads_, frame);
}

std::uint64_t Renderer::texture_levels() const {
    std::uint64_t made = 0;
    for (const auto& texture : textures_)
        if (texture) made += texture->levels_made();
    return made;
}

// Memory only: every tile writes all its pixels.
void Renderer::size_buffers(Frame& frame) const {
    const RenderRequest& r = plan_->request;
    const std::size_t pixels = std::size_t(frame.width) * frame.height;
    // Rows of a tile are a picture's width apart: with small pages, each is on a page of its own.
    const auto size = [&](auto& buffer, bool kept) {
        const std::size_t wanted = kept ? pixels : 0;
        if (wanted > buffer.capacity()) {
            prep::detail::release(buffer);
            buffer.reserve(wanted);
            prep::detail::advise_large_pages(buffer.data(), wanted * sizeof(buffer[0]));
        }
        buffer.resize(wanted);
    };
    size(frame.color, r.keep_color && r.pixels == PixelFormat::floats);
    size(frame.bytes, r.keep_color && r.pixels == PixelFormat::bytes);
    size(frame.depth, r.keep_depth);
    size(frame.triangle, r.keep_ids);
    size(frame.instance, r.keep_ids);
    size(frame.normal, r.keep_normals);
    size(frame.uv, r.keep_uvs);
    size(frame.barycentric, r.keep_barycentrics);
    size(frame.position, r.keep_positions);
}

}  // namespace rast::detail
