#include "rast/render.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "color.h"
#include "parallel.h"
#include "setup.h"
#include "shade.h"
#include "texture.h"

namespace rast {
namespace {

using Clock = std::chrono::steady_clock;
using prep::detail::parallel_blocks;

constexpr std::size_t vertex_grain = 8192;
// Sort-middle: triangles are set up and binned in chunks of this many; a tile replays the chunks in
// submission order, so that equal depths are decided alike on any number of threads.
constexpr std::size_t chunk_size = 4096;
constexpr std::int32_t tile_size =
    64;  // depth and triangle numbers of a tile: 32 KiB, one L1 cache

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Scaled so that its largest element is 1: squares and products then stay in float's range.
glm::dmat3 of_order_one(const glm::dmat3& m) {
    double largest = 0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) largest = std::max(largest, std::abs(m[c][r]));
    return largest > 0 && std::isfinite(largest) ? m / largest : m;
}

Instance transform(const prep::PreparedScene& prepared, const RenderPlan& plan, std::uint32_t node,
                   const glm::dmat4& world, const glm::dmat4& to_clip) {
    Instance in;
    in.node = node;
    in.mesh = &prepared.meshes[prepared.scene.nodes[node].mesh];
    const prep::VertexMesh& mesh = *in.mesh;
    const glm::dvec3 eye = plan.view.eye();
    const glm::dmat3 linear(world);
    // The mesh's origin and the world's offset meet the eye in double; only what is left is float.
    const glm::dvec3 offset = linear * mesh.origin + glm::dvec3(world[3]) - eye;
    const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                              glm::cross(linear[0], linear[1]));
    const double determinant = glm::dot(linear[0], cofactor[0]);
    in.handedness = determinant < 0 ? -1.0f : 1.0f;
    const glm::dmat3 normal_matrix = of_order_one(cofactor) * double(in.handedness);
    in.normal_matrix = glm::mat3(normal_matrix);
    const glm::dmat3 rotation(plan.view.world_to_view);

    const std::size_t n = mesh.vertex_count();
    in.screen.resize(n);
    in.positions.resize(n);
    const bool normals = plan.request.shading != Shading::flat && !mesh.normals.empty();
    const bool tangents = plan.request.shading == Shading::normal_mapped && !mesh.tangents.empty();
    if (normals) in.normals.resize(n);
    if (tangents) in.tangents.resize(n);
    const auto unit = [](const glm::dvec3& v) {
        const double length = glm::length(v);
        return length > 0 ? v / length : v;
    };
    parallel_blocks(n, vertex_grain, plan.request.threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            const glm::dvec3 relative = linear * glm::dvec3(mesh.positions[v]) + offset;
            in.screen[v] = screen_vertex(to_clip * glm::dvec4(rotation * relative, 1.0),
                                         plan.request.width, plan.request.height);
            in.positions[v] = glm::vec3(relative);
            // Cofactor form of the inverse transpose: defined for singular transforms too; the sign
            // undoes the flip that a mirror puts into cofactors.
            if (normals)
                in.normals[v] = glm::vec3(unit(normal_matrix * glm::dvec3(mesh.normals[v])));
            if (tangents)
                in.tangents[v] =
                    glm::vec4(glm::vec3(unit(linear * glm::dvec3(glm::vec3(mesh.tangents[v])))),
                              mesh.tangents[v].w);
        }
    });
    in.range_of.resize(mesh.triangle_count());
    for (std::uint32_t r = 0; r < mesh.ranges.size(); ++r)
        std::fill_n(in.range_of.begin() + mesh.ranges[r].first_triangle,
                    mesh.ranges[r].triangle_count, r);
    return in;
}

struct Chunk {
    std::vector<SetupTriangle> triangles;
    std::vector<std::uint32_t> tile_offsets;  // tiles + 1
    std::vector<std::uint32_t> tile_triangles;
    Counters counters;
};

struct Tiling {
    std::uint32_t across = 0, down = 0;
    std::size_t count() const { return std::size_t(across) * down; }
};

void bin(const Tiling& tiling, Chunk& chunk) {
    const auto each_tile = [&](const SetupTriangle& t, const auto& visit) {
        for (std::int32_t y = t.min_y / tile_size; y <= t.max_y / tile_size; ++y)
            for (std::int32_t x = t.min_x / tile_size; x <= t.max_x / tile_size; ++x)
                visit(std::size_t(y) * tiling.across + std::size_t(x));
    };
    chunk.tile_offsets.assign(tiling.count() + 1, 0);
    for (const SetupTriangle& t : chunk.triangles)
        each_tile(t, [&](std::size_t tile) { ++chunk.tile_offsets[tile + 1]; });
    for (std::size_t i = 0; i < tiling.count(); ++i)
        chunk.tile_offsets[i + 1] += chunk.tile_offsets[i];
    chunk.tile_triangles.resize(chunk.tile_offsets.back());
    std::vector<std::uint32_t> cursor(chunk.tile_offsets.begin(), chunk.tile_offsets.end() - 1);
    for (std::uint32_t i = 0; i < chunk.triangles.size(); ++i)
        each_tile(chunk.triangles[i],
                  [&](std::size_t tile) { chunk.tile_triangles[cursor[tile]++] = i; });
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

class Renderer {
  public:
    Renderer(const prep::PreparedScene& prepared, const RenderPlan& plan)
        : prepared_(prepared), plan_(plan) {
        frame_.width = plan.request.width;
        frame_.height = plan.request.height;
        tiling_.across = (frame_.width + tile_size - 1) / tile_size;
        tiling_.down = (frame_.height + tile_size - 1) / tile_size;
    }

    Frame run() {
        const Clock::time_point start = Clock::now();
        frame_.warnings = plan_.warnings;
        load_textures();
        const Shader shader(prepared_, plan_, textures_);
        geometry(shader);
        set_up();
        frame_.geometry_ms = milliseconds_since(start);
        const Clock::time_point raster_start = Clock::now();
        allocate();
        std::vector<std::uint64_t> shaded(tiling_.count(), 0);
        parallel_blocks(
            tiling_.count(), 1, plan_.request.threads,
            [&](std::size_t tile, std::size_t) { shaded[tile] = draw_tile(tile, shader); });
        for (const Chunk& chunk : chunks_) add(frame_.counters, chunk.counters);
        for (const std::uint64_t n : shaded) frame_.counters.pixels_shaded += n;
        frame_.raster_ms = milliseconds_since(raster_start);
        return std::move(frame_);
    }

  private:
    void load_textures() {
        const prep::Scene& scene = prepared_.scene;
        textures_.by_index.resize(scene.textures.size());
        for (std::size_t t = 0; t < scene.textures.size(); ++t) {
            const prep::Texture& texture = scene.textures[t];
            if (!plan_.textures_used[t] || texture.image >= scene.images.size()) continue;
            auto image = prep::load_image(scene.images[texture.image]);
            if (!image) {
                frame_.warnings.push_back("texture left out: " + prep::to_string(image.error()));
                continue;
            }
            textures_.by_index[t] =
                std::make_unique<MipTexture>(*image, texture, plan_.colour_textures[t],
                                             plan_.request.filter == TextureFilter::trilinear);
        }
    }

    void geometry(const Shader& shader) {
        const std::vector<glm::dmat4> world = prep::world_transforms(prepared_.scene);
        const glm::dmat4 to_clip = projection(plan_.view, plan_.view.aspect);
        for (std::uint32_t n = 0; n < prepared_.scene.nodes.size(); ++n) {
            const std::uint32_t m = prepared_.scene.nodes[n].mesh;
            if (m == prep::no_index || prepared_.meshes[m].triangle_count() == 0) continue;
            instances_.push_back(transform(prepared_, plan_, n, world[n], to_clip));
            if (plan_.request.shading == Shading::gouraud)
                shader.light_vertices(instances_.back(), back_faces_visible());
        }
    }

    bool back_faces_visible() const {
        const auto& materials = prepared_.scene.materials;
        return plan_.request.cull == Cull::none || plan_.request.cull == Cull::front ||
               (plan_.request.cull == Cull::by_material &&
                std::any_of(materials.begin(), materials.end(),
                            [](const prep::Material& m) { return m.double_sided; }));
    }

    void set_up() {
        struct Work {
            std::uint32_t instance;
            std::size_t begin, end;
        };
        std::vector<Work> work;
        for (std::uint32_t i = 0; i < instances_.size(); ++i)
            for (std::size_t t = 0; t < instances_[i].mesh->triangle_count(); t += chunk_size)
                work.push_back(
                    {i, t, std::min(t + chunk_size, instances_[i].mesh->triangle_count())});
        chunks_.resize(work.size());
        parallel_blocks(work.size(), 1, plan_.request.threads, [&](std::size_t w, std::size_t) {
            const Instance& in = instances_[work[w].instance];
            Chunk& chunk = chunks_[w];
            const SetupContext context{frame_.width, frame_.height, work[w].instance,
                                       in.handedness < 0};
            for (std::size_t t = work[w].begin; t < work[w].end; ++t) {
                const std::uint32_t* i = &in.mesh->indices[3 * t];
                const CullSide side =
                    cull_side(plan_, prepared_, in.mesh->ranges[in.range_of[t]].material);
                set_up_triangle(in.screen, {i[0], i[1], i[2]}, std::uint32_t(t), side, context,
                                chunk.triangles, chunk.counters);
            }
            bin(tiling_, chunk);
        });
    }

    void allocate() {
        const std::size_t pixels = std::size_t(frame_.width) * frame_.height;
        frame_.color.assign(pixels, glm::vec4(plan_.request.background, 0.0f));
        if (plan_.request.keep_depth) frame_.depth.assign(pixels, 0.0f);
        if (plan_.request.keep_ids) {
            frame_.triangle.assign(pixels, prep::no_index);
            frame_.instance.assign(pixels, prep::no_index);
        }
    }

    std::uint64_t draw_tile(std::size_t tile, const Shader& shader) {
        const std::int32_t x0 = std::int32_t(tile % tiling_.across) * tile_size;
        const std::int32_t y0 = std::int32_t(tile / tiling_.across) * tile_size;
        const std::int32_t x1 = std::min(x0 + tile_size, std::int32_t(frame_.width)) - 1;
        const std::int32_t y1 = std::min(y0 + tile_size, std::int32_t(frame_.height)) - 1;
        float depth[tile_size * tile_size];
        const SetupTriangle* visible[tile_size * tile_size];
        std::fill(std::begin(depth), std::end(depth), -1.0f);
        std::fill(std::begin(visible), std::end(visible), nullptr);
        for (const Chunk& chunk : chunks_) {
            for (std::uint32_t k = chunk.tile_offsets[tile]; k < chunk.tile_offsets[tile + 1];
                 ++k) {
                const SetupTriangle& t = chunk.triangles[chunk.tile_triangles[k]];
                const Instance& in = instances_[t.instance];
                const bool masked = shader.masked(in, t);
                visit_coverage(in.screen, t, x0, y0, x1, y1,
                               [&](std::int32_t x, std::int32_t y, float d) {
                                   const int at = (y - y0) * tile_size + (x - x0);
                                   if (!(d > depth[at])) return;
                                   if (masked && !shader.covered(in, t, x, y)) return;
                                   depth[at] = d;
                                   visible[at] = &t;
                               });
            }
        }
        std::uint64_t shaded = 0;
        for (std::int32_t y = y0; y <= y1; ++y)
            for (std::int32_t x = x0; x <= x1; ++x) {
                const int at = (y - y0) * tile_size + (x - x0);
                const SetupTriangle* t = visible[at];
                if (!t) continue;
                const std::size_t pixel = std::size_t(y) * frame_.width + std::size_t(x);
                frame_.color[pixel] = shader.shade(instances_[t->instance], *t, x, y);
                if (plan_.request.keep_depth) frame_.depth[pixel] = depth[at];
                if (plan_.request.keep_ids) {
                    frame_.triangle[pixel] = t->triangle;
                    frame_.instance[pixel] = instances_[t->instance].node;
                }
                ++shaded;
            }
        return shaded;
    }

    const prep::PreparedScene& prepared_;
    const RenderPlan& plan_;
    Frame frame_;
    Tiling tiling_;
    Textures textures_;
    std::vector<Instance> instances_;
    std::vector<Chunk> chunks_;
};

}  // namespace

prep::Result<Frame> render(const prep::PreparedScene& scene, const RenderPlan& plan) {
    return Renderer(scene, plan).run();
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
