// The limit surface as users see it: cage faces and their parameters, points, normals, grids.
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "limit_surface/channel_surface.h"
#include "limit_surface/face_varying.h"
#include "prep/subdivide.h"

namespace prep {

using namespace detail;

class LimitSurface::Implementation {
  public:
    ChannelSurface surface;
    std::vector<std::uint32_t> face_offsets, corner_vertices;
    bool normals = true;
    int threads = 0;
    SimdLevel simd = SimdLevel::automatic;
    std::unique_ptr<GridTables> tables;  // for the usual rates

    bool triangles() const { return surface.has_triangles(); }
    std::span<const std::uint32_t> corners(std::uint32_t face) const {
        return std::span(corner_vertices)
            .subspan(face_offsets[face], face_offsets[face + 1] - face_offsets[face]);
    }

    // The root that has (u, v), and its own parameters of that point.
    struct Place {
        std::uint32_t root;
        double u, v, scale;
    };
    Place place(const SurfaceLocation& at) const {
        const std::uint32_t first = surface.tree.face_roots[at.face];
        const std::uint32_t size = face_offsets[at.face + 1] - face_offsets[at.face];
        if (triangles()) {
            const double u = std::clamp(at.u, 0.0, 1.0);
            return {first, u, std::clamp(at.v, 0.0, 1.0 - u), 1};
        }
        if (size == 4) return {first, std::clamp(at.u, 0.0, 1.0), std::clamp(at.v, 0.0, 1.0), 1};
        const auto columns = 1 + std::uint32_t(std::sqrt(double(size - 1)));
        const auto tile = [](double t, std::uint32_t most) {
            return t > 0 ? std::uint32_t(std::min(t, double(most))) : 0;
        };
        const std::uint32_t y = tile(at.v, (size - 1) / columns);
        const std::uint32_t x = tile(at.u, columns - 1);
        const std::uint32_t corner = std::min(y * columns + x, size - 1);
        return {first + corner, std::clamp(2 * (at.u - corner % columns), 0.0, 1.0),
                std::clamp(2 * (at.v - corner / columns), 0.0, 1.0), 2};
    }

    void evaluate(const SurfaceLocation& at, PatchEvaluator& evaluator, SurfacePoint& out) const {
        out = {};
        if (!surface.cage.has_surface[at.face]) {
            out.has_limit = false;
            return;
        }
        const Place place = this->place(at);
        const PointTraits traits =
            evaluator.point(place.root, place.u, place.v, &out.position.x, &out.du.x, &out.dv.x);
        out.extraordinary = traits.ring != no_index;
        if (normals) {
            const PointNormal normal = point_normal(surface, evaluator, place.root, place.u,
                                                    place.v, out.du, out.dv, corners(at.face));
            out.normal = normal.normal;
            out.fallback_normal = normal.fallback;
        }
        out.du *= place.scale;
        out.dv *= place.scale;
    }
};

LimitSurface::LimitSurface(std::shared_ptr<const Implementation> implementation)
    : implementation_(std::move(implementation)) {}

LimitSurface LimitSurface::of(detail::ChannelSurface&& surface, const Mesh& cage,
                              const SubdivideOptions& options) {
    auto made = std::make_shared<Implementation>();
    made->surface = std::move(surface);
    made->surface.cage.forget_rules();
    made->normals = made->surface.rings.has_normals();
    made->tables =
        std::make_unique<GridTables>(5, made->surface.tree.sharpnesses, made->triangles());
    made->face_offsets = cage.face_offsets;
    made->corner_vertices = cage.corner_vertices;
    made->threads = options.threads;
    made->simd = options.simd;
    return LimitSurface(std::move(made));
}

Result<LimitSurface> LimitSurface::make(const Mesh& cage, const SubdivideOptions& options) {
    if (cage.face_offsets.empty()) {  // one that was moved from
        Mesh without_faces = cage;
        without_faces.face_offsets = {0};
        return make(without_faces, options);
    }
    const Result<SurfaceCage> positions = position_cage(cage, options);
    if (!positions) return positions.error();
    std::vector<double> numbers;
    numbers.reserve(3 * cage.vertex_count());
    for (const glm::vec3& p : cage.positions) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    Result<ChannelSurface> surface =
        ChannelSurface::make(*positions, numbers, 3, true, 6, options.threads);
    if (!surface) return surface.error();
    return of(std::move(*surface), cage, options);
}

Result<LimitSurface> LimitSurface::make_uv(const Mesh& cage, std::size_t uv_set,
                                           const SubdivideOptions& options) {
    const Error left_out{
        ErrorCode::invalid,
        "the UV set is not there, or not at every corner, or not finite: there is no surface",
        cage.name.empty() ? "" : "mesh '" + cage.name + "'"};
    if (uv_set >= cage.uvs.size() || cage.corner_count() == 0) return left_out;
    const auto& layer = cage.uvs[uv_set];
    const std::vector<std::uint32_t> values = corner_classes(layer.values, layer.indices);
    if (values.size() != cage.corner_count()) return left_out;
    const Result<SurfaceCage> positions = position_cage(cage, options);
    if (!positions) return positions.error();
    const Result<FaceVaryingRule> rule = face_varying_rule(cage, options);
    if (!rule) return rule.error();
    const Result<RefinedCage> refined = RefinedCage::make(*positions);
    if (!refined) return refined.error();
    const FaceVaryingCage channel = face_varying_cage(*positions, *refined, values, *rule);
    std::vector<double> numbers;
    for (const std::uint32_t corner : channel.first_corner) {
        const glm::vec2& uv = layer.values[layer.indices[corner]];
        numbers.insert(numbers.end(), {uv.x, uv.y, 0.0});
    }
    Result<ChannelSurface> surface =
        ChannelSurface::make(channel.cage, numbers, 3, false, 6, options.threads);
    if (!surface) return surface.error();
    LimitSurface made = of(std::move(*surface), cage, options);
    return made;
}

std::size_t LimitSurface::face_count() const {
    return implementation_->face_offsets.size() - 1;
}

bool LimitSurface::has_limit(std::uint32_t face) const {
    return implementation_->surface.cage.has_surface[face] != 0;
}

void LimitSurface::evaluate(std::span<const SurfaceLocation> locations,
                            std::span<SurfacePoint> points) const {
    assert(locations.size() == points.size());
    const Implementation& own = *implementation_;
    parallel_blocks(locations.size(), 512, own.threads, [&](std::size_t begin, std::size_t end) {
        PatchEvaluator evaluator(own.surface.pieces(), own.simd);
        for (std::size_t k = begin; k < end; ++k) {
            assert(locations[k].face < face_count());
            own.evaluate(locations[k], evaluator, points[k]);
        }
    });
}

std::size_t LimitSurface::grid_count() const {
    return implementation_->surface.tree.roots.size();
}

std::uint32_t LimitSurface::grid_face(std::size_t grid) const {
    return implementation_->surface.tree.roots[grid].cage_face;
}

std::size_t LimitSurface::grid_size(int rate) const {
    const std::size_t side = std::size_t(rate) + 1;
    return implementation_->triangles() ? side * (side + 1) / 2 : side * side;
}

void LimitSurface::evaluate_grids(int rate, std::size_t first_grid, std::size_t count,
                                  const Grids& out) const {
    assert(rate >= 1 && rate <= 1024 && (rate & (rate - 1)) == 0);
    const Implementation& own = *implementation_;
    const std::size_t size = grid_size(rate);
    assert(first_grid + count <= grid_count() && out.positions.size() == count * size);
    assert(out.du.size() == out.dv.size() &&
           (out.du.empty() || out.du.size() == out.positions.size()));
    std::unique_ptr<GridTables> finer;
    if (rate > 1 << own.tables->log2_most())
        finer = std::make_unique<GridTables>(std::countr_zero(unsigned(rate)),
                                             own.surface.tree.sharpnesses, own.triangles());
    const GridTables& tables = finer ? *finer : *own.tables;
    const bool derivatives = !out.du.empty() && !out.dv.empty();
    parallel_blocks(count, 16, own.threads, [&](std::size_t begin, std::size_t end) {
        PatchEvaluator evaluator(own.surface.pieces(), own.simd);
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t root = std::uint32_t(first_grid + k);
            GridOutput to;
            to.value = &out.positions[k * size].x;
            if (derivatives) to.du = &out.du[k * size].x, to.dv = &out.dv[k * size].x;
            to.stride = 3 * (std::size_t(rate) + 1);
            if (own.surface.cage.has_surface[own.surface.tree.roots[root].cage_face]) {
                evaluator.grid(root, std::uint32_t(rate), false, tables, to);
                continue;
            }
            std::fill_n(to.value, 3 * size, 0.0);
            if (derivatives) std::fill_n(to.du, 3 * size, 0.0), std::fill_n(to.dv, 3 * size, 0.0);
        }
    });
}

}  // namespace prep
