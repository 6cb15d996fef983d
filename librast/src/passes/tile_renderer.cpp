#include "passes/tile_renderer.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "coverage/homogeneous_raster.h"

namespace rast::detail {
namespace {

class Tile {
  public:
    Tile(const TileInputs& in, std::uint32_t tile, TileScratch& scratch)
        : in_(in),
          s_(scratch),
          request_(in.plan->request),
          work_(in.work + in.work_begin[tile], in.work + in.work_begin[tile + 1]) {
        left_ = std::int32_t(tile) % in.window.tiles_x * tile_size;
        top_ = std::int32_t(tile) / in.window.tiles_x * tile_size;
        place_ = {in.window.first_x + left_ * subpixels,
                  in.window.first_y + top_ * subpixels,
                  std::min(tile_size, in.window.width - left_),
                  std::min(tile_size, in.window.height - top_),
                  in.window.grid,
                  request_.hierarchical_z};
    }

    TileCounts draw() {
        TileCounts counts;
        if (s_.clock != nullptr) s_.clock->start();
        if (work_.empty()) {
            clear_empty();
            lap(DrawingPart::clearing);
            return counts;
        }
        clear();
        // Colours come later, from areas.
        const bool areas = request_.coverage == Coverage::area;
        if (areas) fill(in_.frame->color, glm::vec4(request_.background, 0.0f));
        lap(DrawingPart::clearing);
        if (areas && !keeps_buffers(request_)) return counts;
        const bool one_sample = raster(counts);
        lap(DrawingPart::visibility);
        if (request_.keep_color && !areas) {
            if (one_sample) {
                collect_single(picture_rows());
                add_to(counts);
                lap(DrawingPart::sorting);
                shade_single();
                lap(DrawingPart(StageKind::color));
            } else {
                shade_several(counts);
            }
        }
        if (!keeps_buffers(request_)) return counts;
        write_buffers();
        write_attributes();
        lap(DrawingPart::buffers);
        return counts;
    }

  private:
    void lap(DrawingPart part) const {
        if (s_.clock != nullptr) s_.clock->lap(part);
    }
    std::size_t row_start(std::int32_t y) const {
        return std::size_t(top_ - in_.first_row + y) * in_.frame->width + std::size_t(left_);
    }
    std::size_t pixel_of(std::uint16_t p) const {
        return row_start(p / tile_size) + std::size_t(p % tile_size);
    }

    template <class T>
    void fill(std::vector<T>& buffer, const T& value) const {
        if (buffer.empty()) return;
        for (std::int32_t y = 0; y < place_.height; ++y)
            std::fill_n(buffer.begin() + std::ptrdiff_t(row_start(y)), place_.width, value);
    }

    // The picture's memory may hold an older picture.
    void clear() const {
        Frame& f = *in_.frame;
        fill(f.depth, 0.0f);
        fill(f.triangle, prep::no_index);
        fill(f.instance, prep::no_index);
        fill(f.normal, glm::vec3(0.0f));
        fill(f.uv, glm::vec2(0.0f));
        fill(f.barycentric, glm::vec3(0.0f));
        fill(f.position, glm::vec3(0.0f));
        if (!work_.empty()) return;
        fill(f.color, glm::vec4(request_.background, 0.0f));
        if (!f.bytes.empty())
            in_.kernels->fill(picture_rows(), place_.width, place_.height, background_bytes(),
                              in_.clear_past_caches);
    }

    // The first of several neighbours without triangles fills their rows at one go: memory takes
    // long runs faster than short ones.
    void clear_empty() {
        constexpr std::int32_t most = 8;
        const std::int32_t column = left_ / tile_size;
        const std::uint32_t* const begin = in_.work_begin + (top_ / tile_size) * in_.window.tiles_x;
        const auto is_empty = [&](std::int32_t x) { return begin[x] == begin[x + 1]; };
        if (column % most != 0 && is_empty(column - 1)) return;
        std::int32_t end = column + 1;
        while (end < in_.window.tiles_x && end % most != 0 && is_empty(end)) ++end;
        place_.width = std::min(end * tile_size, in_.window.width) - left_;
        clear();
    }

    PictureRows picture_rows() const {
        std::vector<std::uint32_t>& bytes = in_.frame->bytes;
        return bytes.empty() ? PictureRows{} : PictureRows{&bytes[row_start(0)], in_.frame->width};
    }

    std::uint32_t background_bytes() const {
        const glm::vec3& b = request_.background;
        std::uint32_t out = 0;
        in_.kernels->pack(&b.x, &b.y, &b.z, 1, &out);
        return out & 0x00ffffffu;
    }

    // Returns whether one sample a pixel was enough: the first one, whose depth is kept.
    bool raster(TileCounts& counts) {
        const bool inside = in_.plan->skips.inside_samples && is_inside_one();
        const std::size_t samples = inside ? 1 : in_.offsets->size();
        s_.samples.resize(in_.offsets->size());
        std::vector<TilePlace>& places = s_.places;
        places.assign(in_.offsets->size(), place_);
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (i < samples) s_.samples[i].clear();
            places[i].x += (*in_.offsets)[i].x;
            places[i].y += (*in_.offsets)[i].y;
        }
        count_ = 0;
        for (const TileWork& work : work_) {
            const TriangleChunk& chunk = (*in_.chunks)[work.chunk];
            const ShadeDraw& draw = (*in_.shade_draws)[chunk.draw];
            raster_slice(chunk, work.begin, work.end, count_, std::span(places).first(samples),
                         draw.masked ? &draw : nullptr, *in_.kernels,
                         std::span(s_.samples).first(samples));
            if (draw.masked) counts.masked_triangles += (work.end - work.begin) * samples;
            count_ += work.end - work.begin;
        }
        counts.sample_points += std::uint64_t(place_.width * place_.height) * samples;
        return samples == 1;
    }

    // Whether one triangle covers every sample of every pixel and no other one touches any: no edge
    // comes within half a pixel of them, and no corner is beyond a plane. (Lists go by boxes: the
    // other half of a wall is in them.)
    bool is_inside_one() const {
        constexpr std::uint32_t few = 8;
        std::uint32_t entries = 0, covering = 0;
        for (const TileWork& work : work_) entries += work.end - work.begin;
        if (entries > few) return false;
        for (const TileWork& work : work_) {
            const TriangleChunk& chunk = (*in_.chunks)[work.chunk];
            for (std::uint32_t i = work.begin; i < work.end; ++i)
                if ((chunk.order[i] & entry_crossing) != 0) return false;
            SetupBlock block;
            SetupTask task;
            task.records = chunk.records;
            task.indices = chunk.indices;
            task.first_id = chunk.first_id;
            task.entries = chunk.order.data() + work.begin;
            task.count = work.end - work.begin;
            in_.kernels->set_up(task, block);
            for (std::uint32_t t = 0; t < task.count; ++t) {
                const Reach reach = reach_of(block, t);
                if (reach == Reach::none) continue;
                if (reach == Reach::some || !(block.z_low[t] > 0)) return false;
                if ((*in_.shade_draws)[chunk.draw].masked || ++covering > 1) return false;
            }
        }
        return covering == 1;
    }

    // Of the tile's pixels, half a pixel more on all sides. Exact.
    enum class Reach : std::uint8_t { none, some, all };
    Reach reach_of(const SetupBlock& block, std::uint32_t t) const {
        constexpr std::int64_t half = subpixels / 2;
        const std::int64_t x[2] = {place_.x - half,
                                   place_.x + (place_.width - 1) * subpixels + half};
        const std::int64_t y[2] = {place_.y - half,
                                   place_.y + (place_.height - 1) * subpixels + half};
        bool all = true;
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;  // c: on the inner side
            const std::int64_t ax = block.x[a][t], ay = block.y[a][t];
            const std::int64_t dx = block.x[b][t] - ax, dy = block.y[b][t] - ay;
            const std::int64_t area = dx * (block.y[c][t] - ay) - dy * (block.x[c][t] - ax);
            int inside = 0, outside = 0;
            for (int corner = 0; corner < 4; ++corner) {
                const std::int64_t edge = dx * (y[corner / 2] - ay) - dy * (x[corner % 2] - ax);
                inside += area > 0 ? edge > 0 : edge < 0;
                outside += area > 0 ? edge < 0 : edge > 0;
            }
            if (outside == 4) return Reach::none;
            all = all && inside == 4;
        }
        return all ? Reach::all : Reach::some;
    }

    void add_to(TileCounts& counts) const {
        for (const TileScratch::Group& g : s_.groups)
            counts.add_points(*(*in_.shade_draws)[g.draw].color_stages, g.end - g.begin);
    }

    // One sample a pixel.
    // `ahead`: what is written next.
    void collect_single(const PictureRows& ahead) {
        s_.counts.assign(count_ + 1, 0);
        s_.runs.resize(tile_pixels);
        const std::size_t runs = in_.kernels->collect(s_.samples[0].id.data(), place_,
                                                      s_.counts.data(), s_.runs.data(), ahead);
        sort();
        in_.kernels->expand(s_.runs.data(), runs, s_.counts.data(), s_.pixel.data());
    }

    // The triangles of every pixel's samples, each once, with the samples that it covers.
    void collect_several() {
        const std::size_t samples = in_.offsets->size();
        s_.fragments.clear();
        for (std::int32_t y = 0; y < place_.height; ++y)
            for (std::int32_t x = 0; x < place_.width; ++x) {
                const std::size_t at = std::size_t(y) * tile_size + std::size_t(x);
                // Most pixels have one triangle, or none.
                const std::uint32_t one = s_.samples[0].id[at];
                std::size_t same = 1;
                while (same < samples && s_.samples[same].id[at] == one) ++same;
                if (same == samples) {
                    if (one != id_none)
                        s_.fragments.push_back(
                            {one, std::uint16_t(at), std::uint16_t((1u << samples) - 1)});
                    continue;
                }
                const std::size_t first = s_.fragments.size();
                for (std::size_t i = 0; i < samples; ++i) {
                    const std::uint32_t number = s_.samples[i].id[at];
                    if (number == id_none) continue;
                    std::size_t f = first;
                    while (f < s_.fragments.size() && s_.fragments[f].number != number) ++f;
                    if (f == s_.fragments.size())
                        s_.fragments.push_back({number, std::uint16_t(at), 0});
                    s_.fragments[f].samples |= std::uint16_t(1u << i);
                }
            }
    }

    // Fragments by where they are shaded, in their order: at a sample, or at the pixel's centre,
    // which is the last place.
    void sort_by_place(const std::vector<std::uint8_t>& places, std::size_t samples) {
        s_.place_begin.assign(samples + 2, 0);
        for (const std::uint8_t place : places) ++s_.place_begin[place + 1u];
        for (std::size_t p = 1; p < s_.place_begin.size(); ++p)
            s_.place_begin[p] += s_.place_begin[p - 1];
        s_.by_place.resize(places.size());
        std::vector<std::uint32_t>& next = s_.place_next;
        next = s_.place_begin;
        for (std::size_t f = 0; f < places.size(); ++f)
            s_.by_place[next[places[f]]++] = std::uint32_t(f);
    }

    // Those of one place. Returns whether there are any.
    bool gather(std::size_t place) {
        const std::span<const std::uint32_t> here(s_.by_place.begin() + s_.place_begin[place],
                                                  s_.by_place.begin() + s_.place_begin[place + 1]);
        if (here.empty()) return false;
        s_.counts.assign(count_ + 1, 0);
        for (const std::uint32_t f : here) ++s_.counts[s_.fragments[f].number];
        sort();
        s_.weight.resize(fragments_);
        for (const std::uint32_t f : here) {
            const std::uint32_t to = s_.counts[s_.fragments[f].number]++;
            s_.pixel[to] = s_.fragments[f].pixel;
            s_.weight[to] = std::uint16_t(std::popcount(s_.fragments[f].samples));
        }
        return true;
    }

    // From how many fragments a number has to where its first one goes: by number, in tile order
    // within each, which is the same order of sums wherever the tile lies.
    void sort() {
        std::size_t fragments = 0;
        for (const std::uint32_t n : s_.counts) fragments += n;
        // Kernels read and write whole vectors.
        s_.pixel.resize(fragments + tile_padding);
        fragments_ = fragments;
        s_.triangles.clear();
        s_.groups.clear();
        std::uint32_t begin = 0, number = 0;
        for (const TileWork& work : work_) {
            const TriangleChunk& chunk = (*in_.chunks)[work.chunk];
            const auto first_run = std::uint32_t(s_.triangles.size());
            const std::uint32_t group_begin = begin;
            for (std::uint32_t i = work.begin; i < work.end; ++i, ++number) {
                const std::uint32_t n = s_.counts[number];
                s_.counts[number] = begin;
                if (n == 0) continue;
                begin += n;
                s_.triangles.push_back({chunk.id_of(chunk.order[i]), begin});
            }
            if (begin == group_begin) continue;
            if (s_.groups.empty() || s_.groups.back().draw != chunk.draw)
                s_.groups.push_back({chunk.draw, group_begin, group_begin, first_run, 0});
            TileScratch::Group& group = s_.groups.back();
            group.end = begin;
            group.run_count = std::uint32_t(s_.triangles.size()) - group.first_run;
        }
    }

    template <class Task>
    Task task_of(const TileScratch::Group& g, const TilePlace& place) const {
        Task task;
        task.place = place;
        task.pixels = s_.pixel.data();
        task.runs = s_.triangles.data() + g.first_run;
        task.run_count = g.run_count;
        task.begin = g.begin;
        task.watch = in_.plan->watch != nullptr ? in_.plan->watch : s_.clock;
        return task;
    }

    void shade_to_planes(const TilePlace& place) {
        for (std::size_t c = 0; c < 3; ++c)
            if (s_.planes[c].size() < s_.pixel.size()) s_.planes[c].resize(s_.pixel.size());
        for (const TileScratch::Group& g : s_.groups) {
            ShadeTask task = task_of<ShadeTask>(g, place);
            for (std::size_t c = 0; c < 3; ++c) task.out[c] = s_.planes[c].data();
            in_.kernels->shade((*in_.shade_draws)[g.draw], *in_.shade_frame, task);
        }
    }
    glm::vec4 shaded(std::size_t k) const {
        return {s_.planes[0][k], s_.planes[1][k], s_.planes[2][k], 1.0f};
    }

    void shade_single() {
        Frame& f = *in_.frame;
        const bool whole = fragments_ == std::size_t(place_.width * place_.height);
        if (request_.pixels != PixelFormat::bytes) {
            if (!whole) fill(f.color, glm::vec4(request_.background, 0.0f));
            shade_to_planes(place_);
            for (std::size_t k = 0; k < fragments_; ++k) f.color[pixel_of(s_.pixel[k])] = shaded(k);
            return;
        }
        s_.bytes.resize(tile_pixels);
        if (!whole) std::fill(s_.bytes.begin(), s_.bytes.end(), background_bytes());
        for (const TileScratch::Group& g : s_.groups) {
            ShadeTask task = task_of<ShadeTask>(g, place_);
            task.bytes = s_.bytes.data();
            in_.kernels->shade((*in_.shade_draws)[g.draw], *in_.shade_frame, task);
        }
        for (std::int32_t y = 0; y < place_.height; ++y)
            std::copy_n(s_.bytes.begin() + y * tile_size, place_.width,
                        f.bytes.begin() + std::ptrdiff_t(row_start(y)));
    }

    // A triangle that covers all samples of a pixel is shaded at the pixel's centre, any other at
    // the covered sample nearest to it: nothing is ever shaded outside its triangle.
    void shade_several(TileCounts& counts) {
        const std::vector<SampleOffset>& offsets = *in_.offsets;
        const std::size_t samples = offsets.size();
        collect_several();
        std::vector<std::uint8_t>& places = s_.shaded_at;
        places.clear();
        for (const TileScratch::Fragment& f : s_.fragments) {
            std::size_t nearest = samples;
            if (std::size_t(std::popcount(f.samples)) != samples)
                for (std::size_t i = 0; i < samples; ++i)
                    if ((f.samples >> i & 1) != 0 &&
                        (nearest == samples || length2(offsets[i]) < length2(offsets[nearest])))
                        nearest = i;
            places.push_back(std::uint8_t(nearest));
        }
        sort_by_place(places, samples);
        const glm::vec4 background(request_.background, 0.0f);
        s_.colors.assign(tile_pixels, background);
        for (std::size_t sample = 0; sample <= samples; ++sample) {
            if (!gather(sample)) continue;
            add_to(counts);
            lap(DrawingPart::resolving);
            shade_to_planes(sample < samples ? s_.places[sample] : place_);
            for (std::size_t k = 0; k < fragments_; ++k) {
                glm::vec4& pixel = s_.colors[s_.pixel[k]];
                if (s_.weight[k] == samples)
                    pixel = shaded(k);
                else
                    pixel +=
                        (shaded(k) - background) * (float(s_.weight[k]) * (1.0f / float(samples)));
            }
        }
        write_colors();
        lap(DrawingPart::resolving);
    }
    static std::int32_t length2(const SampleOffset& o) { return o.x * o.x + o.y * o.y; }

    void write_colors() {
        Frame& f = *in_.frame;
        for (std::int32_t y = 0; y < place_.height; ++y)
            for (std::int32_t x = 0; x < place_.width; ++x) {
                const glm::vec4& c = s_.colors[std::size_t(y * tile_size + x)];
                const std::size_t pixel = row_start(y) + std::size_t(x);
                if (request_.pixels != PixelFormat::bytes) {
                    f.color[pixel] = c;
                    continue;
                }
                std::uint32_t& out = f.bytes[pixel];
                in_.kernels->pack(&c.x, &c.y, &c.z, 1, &out);
                out = (out & 0x00ffffffu) | std::uint32_t(c.w * 255.0f + 0.5f) << 24;
            }
    }

    void write_buffers() const {
        if (!request_.keep_depth && !request_.keep_ids) return;
        Frame& f = *in_.frame;
        const TileSamples& samples = s_.samples[0];
        for (std::int32_t y = 0; y < place_.height; ++y)
            for (std::int32_t x = 0; x < place_.width; ++x) {
                const std::size_t at = std::size_t(y * tile_size + x);
                std::uint32_t number = samples.id[at];
                if (number == id_none) continue;
                const std::size_t pixel = row_start(y) + std::size_t(x);
                if (request_.keep_depth) f.depth[pixel] = samples.depth[at];
                if (!request_.keep_ids) continue;
                const TileWork* work = work_.data();
                for (; number >= work->end - work->begin; ++work) number -= work->end - work->begin;
                const TriangleChunk& chunk = (*in_.chunks)[work->chunk];
                const std::uint32_t id = chunk.id_of(chunk.order[work->begin + number]);
                f.triangle[pixel] = (id & ~id_back_face) - chunk.first_id + chunk.first_triangle;
                f.instance[pixel] = (*in_.instances)[(*in_.draws)[chunk.draw].instance].node();
            }
    }

    // Normals, UVs, barycentrics and positions of the pixels' first samples.
    void write_attributes() {
        const RenderRequest& r = request_;
        if (!r.keep_normals && !r.keep_uvs && !r.keep_barycentrics && !r.keep_positions) return;
        collect_single({});
        for (std::vector<float>& plane : s_.planes) plane.resize(s_.pixel.size());
        for (const TileScratch::Group& g : s_.groups) {
            AttributeTask task = task_of<AttributeTask>(g, s_.places[0]);
            const prep::VertexMesh& mesh = (*in_.instances)[(*in_.draws)[g.draw].instance].mesh();
            if (!mesh.uvs.empty() && !mesh.uvs[0].empty()) task.uvs = &mesh.uvs[0][0].x;
            std::size_t plane = 0;
            const auto ask = [&](bool kept, float** out, int components) {
                for (int c = 0; c < components; ++c, ++plane)
                    out[c] = kept ? s_.planes[plane].data() : nullptr;
            };
            ask(r.keep_normals, task.normal, 3);
            ask(r.keep_uvs, task.uv, 2);
            ask(r.keep_barycentrics, task.barycentric, 3);
            ask(r.keep_positions, task.position, 3);
            in_.kernels->attributes((*in_.shade_draws)[g.draw], *in_.shade_frame, task);
            Frame& f = *in_.frame;
            for (std::uint32_t k = g.begin; k < g.end; ++k) {
                const std::size_t pixel = pixel_of(task.pixels[k]);
                const auto vec3 = [&](float* const from[3]) {
                    return glm::vec3(from[0][k], from[1][k], from[2][k]);
                };
                if (r.keep_normals) f.normal[pixel] = vec3(task.normal);
                if (r.keep_uvs) f.uv[pixel] = {task.uv[0][k], task.uv[1][k]};
                if (r.keep_barycentrics) f.barycentric[pixel] = vec3(task.barycentric);
                if (r.keep_positions) f.position[pixel] = vec3(task.position);
            }
        }
    }

    const TileInputs& in_;
    TileScratch& s_;
    const RenderRequest& request_;
    std::span<const TileWork> work_;
    TilePlace place_;
    std::int32_t left_ = 0, top_ = 0;
    std::uint32_t count_ = 0;  // of entries
    std::size_t fragments_ = 0;
};

}  // namespace

TileCounts& TileCounts::operator+=(const TileCounts& other) {
    shaded += other.shaded;
    texture_samples += other.texture_samples;
    light_points += other.light_points;
    highlight_points += other.highlight_points;
    normal_map_points += other.normal_map_points;
    masked_triangles += other.masked_triangles;
    sample_points += other.sample_points;
    for (std::size_t k = 0; k < stage_points.size(); ++k) stage_points[k] += other.stage_points[k];
    return *this;
}

void TileCounts::add_points(const StageList& stages, std::uint64_t points) {
    const auto times = [&](StageKind kind) { return stages.times[std::size_t(kind)]; };
    shaded += points;
    texture_samples += stages.map_count * points;
    light_points += (times(StageKind::light) + times(StageKind::matte_light)) * points;
    highlight_points += times(StageKind::exponents) * points;
    if (stages.normal_maps) normal_map_points += points;
    for (std::size_t k = 0; k < stage_points.size(); ++k)
        stage_points[k] += stages.times[k] * points;
}

bool keeps_buffers(const RenderRequest& r) {
    return r.keep_depth || r.keep_ids || r.keep_normals || r.keep_uvs || r.keep_barycentrics ||
           r.keep_positions;
}

void raster_slice(const TriangleChunk& chunk, std::uint32_t begin, std::uint32_t end,
                  std::uint32_t first_number, std::span<const TilePlace> places,
                  const ShadeDraw* masked, const Kernels& kernels, std::span<TileSamples> samples) {
    SetupBlock block;
    const auto crosses = [&](std::uint32_t i) { return (chunk.order[i] & entry_crossing) != 0; };
    std::uint32_t number = first_number;
    for (std::uint32_t i = begin, next = begin; i < end; number += next - i, i = next) {
        if (crosses(i)) {
            next = i + 1;
            for (std::size_t s = 0; s < places.size(); ++s)
                raster_crossing(samples[s].depth.data(), samples[s].id.data(), places[s],
                                chunk.crossing[chunk.order[i] & entry_number], number, masked,
                                kernels);
            continue;
        }
        next = std::min(end, i + std::uint32_t(SetupBlock::capacity));
        if (!chunk.crossing.empty())
            for (next = i + 1; next < end && next < i + SetupBlock::capacity && !crosses(next);)
                ++next;
        SetupTask task;
        task.records = chunk.records;
        task.indices = chunk.indices;
        task.first_id = chunk.first_id;
        task.entries = chunk.order.data() + i;
        task.count = next - i;
        kernels.set_up(task, block);
        for (std::size_t s = 0; s < places.size(); ++s)
            kernels.raster(samples[s].depth.data(), samples[s].id.data(), places[s], block,
                           task.count, number, masked);
    }
}

TileCounts draw_tile(const TileInputs& inputs, std::uint32_t tile, TileScratch& scratch) {
    return Tile(inputs, tile, scratch).draw();
}

}  // namespace rast::detail
