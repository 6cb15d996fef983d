#include "rast/render.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "color.h"
#include "coverage_resolve.h"
#include "parallel_tiles.h"
#include "samples.h"
#include "setup.h"
#include "shading_inputs.h"
#include "supersample.h"

namespace rast {

using namespace detail;

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

void add(Counters& to, const Counters& from) {
    to.triangles += from.triangles;
    to.non_finite += from.non_finite;
    to.degenerate += from.degenerate;
    to.facing_away += from.facing_away;
    to.outside += from.outside;
    to.between_samples += from.between_samples;
    to.crossing += from.crossing;
    to.pixels_shaded += from.pixels_shaded;
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

Crop picture_part(const RenderPlan& plan) {
    return plan.request.crop.value_or(Crop{0, 0, plan.request.width, plan.request.height});
}

// A run of one chunk's entries that reach one tile.
struct TileWork {
    std::uint32_t chunk = 0, begin = 0, end = 0;
};

// A point to be shaded, and how much of its pixel it stands for.
struct Fragment {
    std::uint32_t id = 0;
    std::uint16_t pixel = 0, samples = 0;
};

// What one thread keeps while it goes from tile to tile.
struct TileScratch {
    std::vector<TileSamples> samples;
    std::vector<Fragment> fragments, sorted;
    std::vector<std::uint32_t> draw_counts;  // per draw, all zero between tiles
    std::vector<std::uint32_t> draws;        // those of this tile
    std::vector<std::int32_t> x, y;
    std::vector<std::uint32_t> ids;
    std::array<std::vector<float>, 11> planes;  // results of the kernels
};

class Renderer {
  public:
    Renderer(const prep::PreparedScene& prepared, const RenderPlan& plan)
        : prepared_(prepared),
          plan_(plan),
          kernels_(kernels_for(plan.request.simd)),
          threads_(plan.request.threads),
          offsets_(sample_offsets(plan.request.samples)) {
        const Clock::time_point start = Clock::now();
        load_textures();
        transform();
        make_draws();
        shared_ms_ = milliseconds_since(start);
    }

    const std::vector<std::string>& warnings() const { return warnings_; }

    // The part of the picture, which may be drawn in parts of any order.
    Frame draw(const Crop& crop) {
        const Clock::time_point start = Clock::now();
        look_at(crop);
        set_up();
        frame_.geometry_ms = shared_ms_ + milliseconds_since(start);
        shared_ms_ = 0;
        const Clock::time_point raster_start = Clock::now();
        allocate();
        std::vector<std::uint64_t> shaded(window_.tile_count(), 0);
        parallel_items(window_.tile_count(), threads_, [&](std::size_t tile) {
            shaded[tile] = draw_tile(std::uint32_t(tile), scratch_.local());
        });
        if (plan_.request.coverage == Coverage::area) {
            shaded.assign(1, resolve_areas());
        }
        for (const TriangleChunk& chunk : chunks_) add(frame_.counters, chunk.counters);
        for (const std::uint64_t n : shaded) frame_.counters.pixels_shaded += n;
        frame_.raster_ms = milliseconds_since(raster_start);
        return std::move(frame_);
    }

  private:
    void look_at(const Crop& crop) {
        frame_ = {};
        frame_.width = crop.width;
        frame_.height = crop.height;
        window_.width = std::int32_t(crop.width);
        window_.height = std::int32_t(crop.height);
        const auto first = [](std::uint32_t at, std::uint32_t extent) {
            return (1 - std::int32_t(extent)) * (subpixels / 2) + std::int32_t(at) * subpixels;
        };
        window_.first_x = first(crop.x, plan_.request.width);
        window_.first_y = first(crop.y, plan_.request.height);
        window_.tiles_x = (window_.width + tile_size - 1) / tile_size;
        window_.tiles_y = (window_.height + tile_size - 1) / tile_size;
        window_.grid = depth_grid(plan_.request.depth_format);
    }

    void load_textures() {
        const prep::Scene& scene = prepared_.scene;
        textures_.resize(scene.textures.size());
        for (std::size_t t = 0; t < scene.textures.size(); ++t) {
            const prep::Texture& texture = scene.textures[t];
            if (!plan_.textures_used[t] || texture.image >= scene.images.size()) continue;
            auto image = prep::load_image(scene.images[texture.image]);
            if (!image) {
                warnings_.push_back("texture left out: " + prep::to_string(image.error()));
                continue;
            }
            textures_[t] = std::make_unique<MipTexture>(*image, texture, plan_.colour_textures[t],
                                                        levels_for(plan_.request.filter));
        }
    }

    void transform() {
        const std::vector<glm::dmat4> world = prep::world_transforms(prepared_.scene);
        for (std::uint32_t n = 0; n < prepared_.scene.nodes.size(); ++n) {
            const std::uint32_t m = prepared_.scene.nodes[n].mesh;
            if (m == prep::no_index || prepared_.meshes[m].triangle_count() == 0) continue;
            instances_.emplace_back(prepared_.meshes[m], n, world[n], plan_.view,
                                    plan_.request.width, plan_.request.height);
        }
        struct Block {
            std::size_t instance, begin, end;
        };
        std::vector<Block> blocks;
        for (std::size_t i = 0; i < instances_.size(); ++i)
            for (std::size_t v = 0, n = instances_[i].mesh().vertex_count(); v < n;
                 v += vertex_grain)
                blocks.push_back({i, v, std::min(n, v + vertex_grain)});
        parallel_items(blocks.size(), threads_, [&](std::size_t b) {
            instances_[blocks[b].instance].transform(kernels_, blocks[b].begin, blocks[b].end);
        });
    }

    void make_draws() {
        set_up_frame(plan_, inputs_);
        std::uint32_t id = 0;
        for (std::uint32_t i = 0; i < instances_.size(); ++i)
            for (const prep::VertexMesh::Range& range : instances_[i].mesh().ranges) {
                if (range.triangle_count == 0) continue;
                draws_.push_back({i, range.material, range.first_triangle, range.triangle_count});
                shade_draws_.push_back(
                    shade_draw(plan_, prepared_, draws_.back(), instances_[i], textures_));
                shade_draws_.back().first_id = id;
                for (std::uint32_t t = 0; t < range.triangle_count; t += chunk_triangles) {
                    TriangleChunk& chunk = chunks_.emplace_back();
                    chunk.draw = std::uint32_t(draws_.size() - 1);
                    chunk.first_triangle = range.first_triangle + t;
                    chunk.count = std::min(chunk_triangles, range.triangle_count - t);
                    chunk.first_id = id + t;
                }
                id += range.triangle_count;
            }
        if (plan_.request.shading == Shading::gouraud)
            for (std::size_t d = 0; d < draws_.size(); ++d) light_vertices(d);
    }

    void light_vertices(std::size_t d) {
        ShadeDraw& draw = shade_draws_[d];
        RenderInstance& instance = instances_[draws_[d].instance];
        if (draw.normals == nullptr || draw.unlit) return;
        instance.vertex_light.resize(instance.mesh().vertex_count() * vertex_light_floats);
        std::vector<std::uint32_t> vertices(
            draw.indices + std::size_t(draw.first_triangle) * 3,
            draw.indices + (std::size_t(draw.first_triangle) + draw.triangle_count) * 3);
        std::sort(vertices.begin(), vertices.end());
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
        const std::size_t blocks = (vertices.size() + vertex_grain - 1) / vertex_grain;
        parallel_items(blocks, threads_, [&](std::size_t b) {
            const std::size_t begin = b * vertex_grain;
            kernels_.light_vertices(draw, inputs_.frame, vertices.data() + begin,
                                    std::min(vertex_grain, vertices.size() - begin),
                                    instance.vertex_light.data());
        });
        draw.vertex_light = instance.vertex_light.data();
    }

    void set_up() {
        parallel_items(chunks_.size(), threads_, [&](std::size_t c) {
            TriangleChunk& chunk = chunks_[c];
            const Draw& draw = draws_[chunk.draw];
            const RenderInstance& instance = instances_[draw.instance];
            const DrawGeometry geometry{&instance, instance.records.data(),
                                        instance.mesh().indices.data(), instance.mirrored(),
                                        cull_side(plan_, prepared_, draw.material)};
            set_up_chunk(geometry, window_, offsets_.size() > 1, kernels_, bin_scratch_.local(),
                         chunk);
        });
        tile_work_.assign(window_.tile_count(), {});
        for (std::uint32_t c = 0; c < chunks_.size(); ++c)
            for (const TileSlice& slice : chunks_[c].slices)
                tile_work_[slice.tile].push_back({c, slice.begin, slice.end});
    }

    std::uint64_t resolve_areas() {
        CoverageScene scene{&plan_,        &kernels_,      &instances_, &draws_,
                            &shade_draws_, &inputs_.frame, {}};
        for (const Draw& draw : draws_)
            scene.cull.push_back(cull_side(plan_, prepared_, draw.material));
        return resolve_coverage(scene, window_, threads_, frame_);
    }

    void allocate() {
        const std::size_t pixels = std::size_t(frame_.width) * frame_.height;
        frame_.color.assign(pixels, glm::vec4(plan_.request.background, 0.0f));
        if (plan_.request.keep_depth) frame_.depth.assign(pixels, 0.0f);
        if (plan_.request.keep_ids) {
            frame_.triangle.assign(pixels, prep::no_index);
            frame_.instance.assign(pixels, prep::no_index);
        }
        if (plan_.request.keep_normals) frame_.normal.assign(pixels, glm::vec3(0.0f));
        if (plan_.request.keep_uvs) frame_.uv.assign(pixels, glm::vec2(0.0f));
        if (plan_.request.keep_barycentrics) frame_.barycentric.assign(pixels, glm::vec3(0.0f));
        if (plan_.request.keep_positions) frame_.position.assign(pixels, glm::vec3(0.0f));
    }

    TilePlace place_of(std::uint32_t tile) const {
        const std::int32_t x = std::int32_t(tile) % window_.tiles_x * tile_size;
        const std::int32_t y = std::int32_t(tile) / window_.tiles_x * tile_size;
        return {window_.first_x + x * subpixels, window_.first_y + y * subpixels,
                std::min(tile_size, window_.width - x), std::min(tile_size, window_.height - y),
                window_.grid};
    }

    void raster(std::uint32_t tile, const TilePlace& centre, TileScratch& scratch) const {
        scratch.samples.resize(offsets_.size());
        for (std::size_t s = 0; s < offsets_.size(); ++s) {
            TileSamples& samples = scratch.samples[s];
            samples.clear();
            TilePlace place = centre;
            place.x += offsets_[s].x;
            place.y += offsets_[s].y;
            for (const TileWork& work : tile_work_[tile]) {
                const TriangleChunk& chunk = chunks_[work.chunk];
                const ShadeDraw& draw = shade_draws_[chunk.draw];
                const ShadeDraw* masked = draw.masked ? &draw : nullptr;
                for (std::uint32_t i = work.begin; i < work.end;) {
                    std::uint32_t end = i;
                    while (end < work.end && !(chunk.order[end] & order_crossing)) ++end;
                    kernels_.raster(samples.depth.data(), samples.id.data(), place,
                                    chunk.triangles.data(), chunk.order.data() + i, end - i,
                                    masked);
                    for (i = end; i < work.end && (chunk.order[i] & order_crossing); ++i)
                        raster_crossing(samples.depth.data(), samples.id.data(), place,
                                        chunk.crossing[chunk.order[i] & ~order_crossing], masked,
                                        kernels_);
                }
            }
        }
    }

    std::uint32_t draw_of(std::uint32_t id) const {
        const std::uint32_t number = id & ~id_back_face;
        const auto after =
            std::upper_bound(shade_draws_.begin(), shade_draws_.end(), number,
                             [](std::uint32_t n, const ShadeDraw& d) { return n < d.first_id; });
        return std::uint32_t(after - shade_draws_.begin()) - 1;
    }

    // The triangles of every pixel's first `count` samples, each once, in the order of the samples.
    void collect(const TilePlace& place, std::size_t count, TileScratch& scratch) const {
        scratch.fragments.clear();
        for (std::int32_t y = 0; y < place.height; ++y)
            for (std::int32_t x = 0; x < place.width; ++x) {
                const std::size_t at = std::size_t(y) * tile_size + std::size_t(x);
                const std::size_t first = scratch.fragments.size();
                for (std::size_t s = 0; s < count; ++s) {
                    const std::uint32_t id = scratch.samples[s].id[at];
                    if (id == id_none) continue;
                    std::size_t f = first;
                    while (f < scratch.fragments.size() && scratch.fragments[f].id != id) ++f;
                    if (f == scratch.fragments.size())
                        scratch.fragments.push_back({id, std::uint16_t(at), 0});
                    ++scratch.fragments[f].samples;
                }
            }
    }

    // Fragments by draw, in tile order within each.
    void sort_by_draw(TileScratch& scratch) const {
        scratch.draws.clear();
        scratch.draw_counts.resize(shade_draws_.size(), 0);
        for (const Fragment& f : scratch.fragments) {
            const std::uint32_t d = draw_of(f.id);
            if (scratch.draw_counts[d]++ == 0) scratch.draws.push_back(d);
        }
        // In an order that does not depend on where the tile lies: it decides the order of sums.
        std::sort(scratch.draws.begin(), scratch.draws.end());
        scratch.sorted.resize(scratch.fragments.size());
        std::uint32_t begin = 0;
        for (const std::uint32_t d : scratch.draws) {
            const std::uint32_t count = scratch.draw_counts[d];
            scratch.draw_counts[d] = begin;
            begin += count;
        }
        for (const Fragment& f : scratch.fragments)
            scratch.sorted[scratch.draw_counts[draw_of(f.id)]++] = f;
    }

    // Calls visit(draw, first fragment, count) for each draw of the tile, with the points laid out
    // for the kernels.
    template <class Visit>
    void each_draw(const TilePlace& place, TileScratch& scratch, const Visit& visit) const {
        sort_by_draw(scratch);
        std::uint32_t begin = 0;
        for (const std::uint32_t d : scratch.draws) {
            const std::uint32_t end = scratch.draw_counts[d], count = end - begin;
            scratch.draw_counts[d] = 0;
            // Lanes past the end repeat the last point.
            const std::size_t padded = count + std::size_t(tile_padding);
            scratch.x.resize(padded);
            scratch.y.resize(padded);
            scratch.ids.resize(padded);
            for (std::vector<float>& plane : scratch.planes) plane.resize(padded);
            for (std::size_t k = 0; k < padded; ++k) {
                const Fragment& f = scratch.sorted[begin + std::min<std::size_t>(k, count - 1)];
                scratch.x[k] = place.x + f.pixel % tile_size * subpixels;
                scratch.y[k] = place.y + f.pixel / tile_size * subpixels;
                scratch.ids[k] = f.id;
            }
            visit(d, begin, count);
            begin = end;
        }
    }

    std::size_t pixel_of(const TilePlace& place, const Fragment& f) const {
        const std::size_t left = std::size_t((place.x - window_.first_x) >> subpixel_bits);
        const std::size_t top = std::size_t((place.y - window_.first_y) >> subpixel_bits);
        return (top + f.pixel / tile_size) * frame_.width + left + f.pixel % tile_size;
    }

    void shade(const TilePlace& place, TileScratch& scratch) const {
        each_draw(place, scratch, [&](std::uint32_t d, std::uint32_t begin, std::uint32_t count) {
            ShadeTask task{scratch.x.data(), scratch.y.data(), scratch.ids.data(), count, {}};
            for (int c = 0; c < 3; ++c) task.out[c] = scratch.planes[c].data();
            kernels_.shade(shade_draws_[d], inputs_.frame, task);
            blend(place, scratch, begin, count);
        });
    }

    // Normals, UVs, barycentrics and positions of the pixels' first samples.
    void write_attributes(const TilePlace& place, TileScratch& scratch) const {
        const RenderRequest& r = plan_.request;
        if (!r.keep_normals && !r.keep_uvs && !r.keep_barycentrics && !r.keep_positions) return;
        collect(place, 1, scratch);
        each_draw(place, scratch, [&](std::uint32_t d, std::uint32_t begin, std::uint32_t count) {
            AttributeTask task;
            task.x = scratch.x.data();
            task.y = scratch.y.data();
            task.ids = scratch.ids.data();
            task.count = count;
            const prep::VertexMesh& mesh = instances_[draws_[d].instance].mesh();
            if (!mesh.uvs.empty() && !mesh.uvs[0].empty()) task.uvs = &mesh.uvs[0][0].x;
            std::size_t plane = 0;
            const auto ask = [&](bool kept, float** out, int components) {
                for (int c = 0; c < components; ++c, ++plane)
                    out[c] = kept ? scratch.planes[plane].data() : nullptr;
            };
            ask(r.keep_normals, task.normal, 3);
            ask(r.keep_uvs, task.uv, 2);
            ask(r.keep_barycentrics, task.barycentric, 3);
            ask(r.keep_positions, task.position, 3);
            kernels_.attributes(shade_draws_[d], inputs_.frame, task);
            for (std::uint32_t k = 0; k < count; ++k) {
                const std::size_t pixel = pixel_of(place, scratch.sorted[begin + k]);
                const auto vec3 = [&](float* const from[3]) {
                    return glm::vec3(from[0][k], from[1][k], from[2][k]);
                };
                if (r.keep_normals) frame_.normal[pixel] = vec3(task.normal);
                if (r.keep_uvs) frame_.uv[pixel] = {task.uv[0][k], task.uv[1][k]};
                if (r.keep_barycentrics) frame_.barycentric[pixel] = vec3(task.barycentric);
                if (r.keep_positions) frame_.position[pixel] = vec3(task.position);
            }
        });
    }

    // Adds the fragments of one draw to their pixels, weighed by their samples.
    void blend(const TilePlace& place, const TileScratch& scratch, std::uint32_t begin,
               std::uint32_t count) const {
        const float share = 1.0f / float(offsets_.size());
        for (std::uint32_t k = 0; k < count; ++k) {
            const Fragment& f = scratch.sorted[begin + k];
            const glm::vec4 color(scratch.planes[0][k], scratch.planes[1][k], scratch.planes[2][k],
                                  1.0f);
            glm::vec4& pixel = frame_.color[pixel_of(place, f)];
            if (f.samples == offsets_.size()) {
                pixel = color;
                continue;
            }
            const float weight = float(f.samples) * share;
            const glm::vec4 background(plan_.request.background, 0.0f);
            pixel += (color - background) * weight;
        }
    }

    void write_buffers(const TilePlace& place, const TileScratch& scratch) const {
        if (!plan_.request.keep_depth && !plan_.request.keep_ids) return;
        const std::size_t left = std::size_t((place.x - window_.first_x) >> subpixel_bits);
        const std::size_t top = std::size_t((place.y - window_.first_y) >> subpixel_bits);
        const TileSamples& samples = scratch.samples[0];
        for (std::int32_t y = 0; y < place.height; ++y)
            for (std::int32_t x = 0; x < place.width; ++x) {
                const std::size_t at = std::size_t(y) * tile_size + std::size_t(x);
                const std::uint32_t id = samples.id[at];
                if (id == id_none) continue;
                const std::size_t pixel =
                    (top + std::size_t(y)) * frame_.width + left + std::size_t(x);
                if (plan_.request.keep_depth) frame_.depth[pixel] = samples.depth[at];
                if (!plan_.request.keep_ids) continue;
                const std::uint32_t d = draw_of(id);
                frame_.triangle[pixel] = (id & ~id_back_face) - shade_draws_[d].first_id +
                                         shade_draws_[d].first_triangle;
                frame_.instance[pixel] = instances_[draws_[d].instance].node();
            }
    }

    std::uint64_t draw_tile(std::uint32_t tile, TileScratch& scratch) const {
        if (tile_work_[tile].empty()) return 0;
        const TilePlace place = place_of(tile);
        raster(tile, place, scratch);
        collect(place, offsets_.size(), scratch);
        shade(place, scratch);
        const std::size_t shaded = scratch.fragments.size();
        write_buffers(place, scratch);
        write_attributes(place, scratch);
        return shaded;
    }

    const prep::PreparedScene& prepared_;
    const RenderPlan& plan_;
    const Kernels& kernels_;
    int threads_;
    std::vector<SampleOffset> offsets_;
    Window window_;
    mutable Frame frame_;   // tiles write to pixels of their own
    double shared_ms_ = 0;  // spent on what all parts share, until a part has told it
    std::vector<std::string> warnings_;
    TextureSet textures_;
    FrameInputs inputs_;
    std::vector<RenderInstance> instances_;
    std::vector<Draw> draws_;
    std::vector<ShadeDraw> shade_draws_;
    std::vector<TriangleChunk> chunks_;
    std::vector<std::vector<TileWork>> tile_work_;
    tbb::enumerable_thread_specific<BinScratch> bin_scratch_;
    tbb::enumerable_thread_specific<TileScratch> scratch_;
};

}  // namespace

namespace {

// Parts of a picture, supersampled where the plan says so.
class Painter {
  public:
    Painter(const prep::PreparedScene& scene, const RenderPlan& plan) : plan_(plan) {
        const RenderRequest& r = plan.request;
        if (r.supersample == 1 || keeps_buffers(r)) plain_.emplace(scene, plan_);
        if (r.supersample == 1) return;
        fine_plan_ = finer_plan(plan);
        fine_.emplace(scene, fine_plan_);
    }
    Painter(const Painter&) = delete;
    Painter& operator=(const Painter&) = delete;

    Frame draw(const Crop& part) {
        if (!fine_) return plain_->draw(part);
        Frame frame;
        if (plain_) frame = plain_->draw(part);
        frame.width = part.width;
        frame.height = part.height;
        frame.color.resize(std::size_t(part.width) * part.height);
        frame.counters = {};
        const auto factor = std::uint32_t(plan_.request.supersample);
        const std::uint32_t step = (std::uint32_t(tile_size) + factor - 1) / factor;
        for (std::uint32_t row = 0; row < part.height; row += step) {
            const std::uint32_t rows = std::min(step, part.height - row);
            const Frame fine = fine_->draw(
                {part.x * factor, (part.y + row) * factor, part.width * factor, rows * factor});
            reduce(fine, factor, row, frame);
            add(frame.counters, fine.counters);
            frame.geometry_ms += fine.geometry_ms;
            frame.raster_ms += fine.raster_ms;
        }
        return frame;
    }

    std::vector<std::string> warnings() const {
        std::vector<std::string> all = plan_.warnings;
        const std::vector<std::string>& more = (fine_ ? fine_ : plain_)->warnings();
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }

  private:
    static bool keeps_buffers(const RenderRequest& r) {
        return r.keep_depth || r.keep_ids || r.keep_normals || r.keep_uvs || r.keep_barycentrics ||
               r.keep_positions;
    }

    const RenderPlan& plan_;
    RenderPlan fine_plan_;
    std::optional<Renderer> plain_, fine_;
};

}  // namespace

prep::Result<Frame> render(const prep::PreparedScene& scene, const RenderPlan& plan) {
    Painter painter(scene, plan);
    Frame frame = painter.draw(picture_part(plan));
    frame.warnings = painter.warnings();
    return frame;
}

prep::Result<Frame> render_bands(const prep::PreparedScene& scene, const RenderPlan& plan,
                                 const BandSink& take) {
    Painter painter(scene, plan);
    const Crop part = picture_part(plan);
    Frame all;
    all.width = part.width;
    all.height = part.height;
    for (std::uint32_t row = 0; row < part.height;) {
        const std::uint32_t rows = std::min(std::max(plan.band_rows, 1u), part.height - row);
        const Frame band = painter.draw({part.x, part.y + row, part.width, rows});
        add(all.counters, band.counters);
        all.geometry_ms += band.geometry_ms;
        all.raster_ms += band.raster_ms;
        if (prep::Result<void> taken = take(band, row); !taken) return taken.error();
        row += rows;
    }
    all.warnings = painter.warnings();
    return all;
}

prep::Image to_srgb(const Frame& frame, const ToneOptions& options) {
    prep::Image image;
    image.width = frame.width;
    image.height = frame.height;
    image.channels = 3;
    image.srgb = true;
    image.pixels.resize(frame.color.size() * 3);
    for (std::size_t i = 0; i < frame.color.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            float x = frame.color[i][k] * options.exposure;
            if (options.tone_map && x > 0) x = x / (1 + x);
            image.pixels[3 * i + k] = linear_to_srgb(x);
        }
    return image;
}

}  // namespace rast
