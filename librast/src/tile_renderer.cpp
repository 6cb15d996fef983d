#include "tile_renderer.h"

#include <algorithm>
#include <cstring>

namespace rast::detail {
namespace {

class Tile {
  public:
    Tile(const TileInputs& in, std::uint32_t tile, TileScratch& scratch)
        : in_(in), s_(scratch), request_(in.plan->request), work_((*in.work)[tile]) {
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
        clear();
        if (work_.empty()) return counts;
        raster();
        if (request_.keep_color) {
            if (in_.offsets->size() == 1)
                collect_single();
            else
                collect_several(in_.offsets->size());
            counts.shaded = fragments_;
            for (const TileScratch::Group& g : s_.groups)
                counts.texture_samples += (*in_.shade_draws)[g.draw].used_count * (g.end - g.begin);
            shade();
        }
        write_buffers();
        write_attributes();
        return counts;
    }

  private:
    std::size_t row_start(std::int32_t y) const {
        return std::size_t(top_ + y) * in_.frame->width + std::size_t(left_);
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
        fill(f.bytes, background_bytes());
    }

    std::uint32_t background_bytes() const {
        const glm::vec3& b = request_.background;
        std::uint32_t out = 0;
        in_.kernels->pack(&b.x, &b.y, &b.z, 1, &out);
        return out & 0x00ffffffu;
    }

    void raster() {
        s_.samples.resize(in_.offsets->size());
        std::vector<TilePlace>& places = s_.places;
        places.assign(in_.offsets->size(), place_);
        for (std::size_t i = 0; i < places.size(); ++i) {
            s_.samples[i].clear();
            places[i].x += (*in_.offsets)[i].x;
            places[i].y += (*in_.offsets)[i].y;
        }
        count_ = 0;
        for (const TileWork& work : work_) {
            const TriangleChunk& chunk = (*in_.chunks)[work.chunk];
            const ShadeDraw& draw = (*in_.shade_draws)[chunk.draw];
            raster_slice(chunk, work.begin, work.end, count_, places, draw.masked ? &draw : nullptr,
                         *in_.kernels, s_.samples);
            count_ += work.end - work.begin;
        }
    }

    void count(std::uint32_t number, std::size_t pixel, std::uint32_t weight) {
        s_.numbers.push_back(number);
        s_.pixels.push_back(std::uint16_t(pixel));
        s_.weights.push_back(std::uint16_t(weight));
        ++s_.counts[number];
    }

    void start_collecting() {
        s_.counts.assign(count_ + 1, 0);
        s_.numbers.clear();
        s_.pixels.clear();
        s_.weights.clear();
    }

    // One sample a pixel.
    void collect_single() {
        s_.counts.assign(count_ + 1, 0);
        s_.runs.resize(tile_pixels);
        const std::size_t runs =
            in_.kernels->collect(s_.samples[0].id.data(), place_, s_.counts.data(), s_.runs.data());
        sort();
        in_.kernels->expand(s_.runs.data(), runs, s_.counts.data(), s_.pixel.data());
    }

    // The triangles of every pixel's first `samples` samples, each once, with how many it covers.
    void collect_several(std::size_t samples) {
        start_collecting();
        for (std::int32_t y = 0; y < place_.height; ++y)
            for (std::int32_t x = 0; x < place_.width; ++x) {
                const std::size_t at = std::size_t(y) * tile_size + std::size_t(x);
                const std::size_t first = s_.numbers.size();
                for (std::size_t i = 0; i < samples; ++i) {
                    const std::uint32_t number = s_.samples[i].id[at];
                    if (number == id_none) continue;
                    std::size_t f = first;
                    while (f < s_.numbers.size() && s_.numbers[f] != number) ++f;
                    if (f == s_.numbers.size())
                        count(number, at, 1);
                    else
                        ++s_.weights[f];
                }
            }
        sort();
        const std::size_t fragments = s_.numbers.size();
        s_.weight.resize(fragments);
        for (std::size_t i = 0; i < fragments; ++i) {
            const std::uint32_t to = s_.counts[s_.numbers[i]]++;
            s_.pixel[to] = s_.pixels[i];
            s_.weight[to] = s_.weights[i];
        }
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
    Task task_of(const TileScratch::Group& g) const {
        Task task;
        task.place = place_;
        task.pixels = s_.pixel.data();
        task.runs = s_.triangles.data() + g.first_run;
        task.run_count = g.run_count;
        task.begin = g.begin;
        return task;
    }

    bool whole() const {
        return fragments_ == std::size_t(place_.width * place_.height) && in_.offsets->size() == 1;
    }

    void shade() {
        Frame& f = *in_.frame;
        const bool to_bytes = request_.pixels == PixelFormat::bytes && in_.offsets->size() == 1;
        if (to_bytes && !whole()) fill(f.bytes, background_bytes());
        for (std::size_t c = 0; !to_bytes && c < 3; ++c)
            if (s_.planes[c].size() < s_.pixel.size()) s_.planes[c].resize(s_.pixel.size());
        for (const TileScratch::Group& g : s_.groups) {
            ShadeTask task = task_of<ShadeTask>(g);
            if (to_bytes) {
                task.bytes = f.bytes.data() + row_start(0);
                task.stride = f.width;
            }
            for (std::size_t c = 0; !to_bytes && c < 3; ++c) task.out[c] = s_.planes[c].data();
            in_.kernels->shade((*in_.shade_draws)[g.draw], *in_.shade_frame, task);
        }
        if (to_bytes) return;
        if (request_.pixels == PixelFormat::bytes)
            average_samples();
        else
            write_floats();
    }

    void write_floats() {
        Frame& f = *in_.frame;
        const glm::vec4 background(request_.background, 0.0f);
        if (!whole()) fill(f.color, background);
        const float* const planes[3] = {s_.planes[0].data(), s_.planes[1].data(),
                                        s_.planes[2].data()};
        const std::size_t samples = in_.offsets->size();
        for (std::size_t k = 0; k < fragments_; ++k) {
            const glm::vec4 color(planes[0][k], planes[1][k], planes[2][k], 1.0f);
            glm::vec4& pixel = f.color[pixel_of(s_.pixel[k])];
            if (samples == 1 || s_.weight[k] == samples)
                pixel = color;
            else
                pixel += (color - background) * (float(s_.weight[k]) * (1.0f / float(samples)));
        }
    }

    // Several samples a pixel, to bytes: summed as floats first.
    void average_samples() {
        Frame& f = *in_.frame;
        const glm::vec4 background(request_.background, 0.0f);
        const float share = 1.0f / float(in_.offsets->size());
        s_.colors.assign(tile_pixels, background);
        for (std::size_t k = 0; k < fragments_; ++k) {
            const glm::vec4 color(s_.planes[0][k], s_.planes[1][k], s_.planes[2][k], 1.0f);
            glm::vec4& pixel = s_.colors[s_.pixel[k]];
            if (s_.weight[k] == in_.offsets->size())
                pixel = color;
            else
                pixel += (color - background) * (float(s_.weight[k]) * share);
        }
        for (std::int32_t y = 0; y < place_.height; ++y)
            for (std::int32_t x = 0; x < place_.width; ++x) {
                const glm::vec4& c = s_.colors[std::size_t(y * tile_size + x)];
                std::uint32_t& out = f.bytes[row_start(y) + std::size_t(x)];
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
        collect_single();
        for (std::vector<float>& plane : s_.planes) plane.resize(s_.pixel.size());
        for (const TileScratch::Group& g : s_.groups) {
            AttributeTask task = task_of<AttributeTask>(g);
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
    const std::vector<TileWork>& work_;
    TilePlace place_;
    std::int32_t left_ = 0, top_ = 0;
    std::uint32_t count_ = 0;  // of entries
    std::size_t fragments_ = 0;
};

}  // namespace

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
