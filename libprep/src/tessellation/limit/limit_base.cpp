#include "tessellation/limit/limit_base.h"

namespace prep::detail {
namespace {

// Levels of rings that are kept: deeper ones are refined where they are met.
constexpr int ring_levels = 12;

constexpr std::array<glm::dvec2, 4> square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
constexpr std::array<glm::dvec2, 3> triangle{
    {{0, 0}, {triangle_root_side, 0}, {0, triangle_root_side}}};
constexpr glm::dvec2 triangle_centre(triangle_root_side / 3);

}  // namespace

Result<LimitBase> LimitBase::make(const Mesh& mesh, const SubdivideOptions& options,
                                  bool has_heights) {
    const Result<SurfaceCage> cage = position_cage(mesh, options);
    if (!cage) return cage.error();
    std::vector<double> numbers;
    numbers.reserve(3 * mesh.vertex_count());
    for (const glm::vec3& p : mesh.positions)
        for (int k = 0; k < 3; ++k) numbers.push_back(double(p[k]));
    Result<ChannelSurface> surface =
        ChannelSurface::make(*cage, numbers, 3, true, ring_levels, options.threads);
    if (!surface) return surface.error();
    LimitBase base;
    base.mesh_ = &mesh;
    base.surface_ = std::make_unique<ChannelSurface>(std::move(*surface));
    base.surface_->cage.forget_rules();
    base.left_out_.resize(mesh.face_count());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        base.left_out_[f] = !base.surface_->cage.has_surface[f];
    if (has_heights) base.cones_ = std::make_unique<RingCones>(*base.surface_, options.threads);
    base.cells_ = std::make_unique<CellBounds>(*base.surface_, has_heights);
    return base;
}

// Only a root that is not halved is.
bool LimitBase::is_in_two_halves(std::uint32_t root,
                                 const std::array<glm::dvec3, 3>& weights) const {
    if (weights[0].x != 1 || weights[1].y != 1 || has_triangles()) return false;
    const std::uint32_t f = domain_->roots[root].face;
    return mesh_->face_offsets[f + 1] - mesh_->face_offsets[f] != 4;
}

LimitBase::Chart LimitBase::chart(std::uint32_t root, bool towards_a) const {
    const DomainRoot& at = domain_->roots[root];
    const std::uint32_t first = mesh_->face_offsets[at.face];
    const std::uint32_t count = mesh_->face_offsets[at.face + 1] - first;
    const std::uint32_t a = at.corners[0] - first, b = at.corners[1] - first;
    const std::uint32_t tree_root = surface_->tree.face_roots[at.face];
    if (has_triangles())
        return {tree_root, {triangle[a], triangle[b], triangle_centre}, triangle_root_side};
    if (count == 4) return {tree_root, {square[a], square[b], glm::dvec2(0.5)}};
    if (towards_a) return {tree_root + a, {{{0, 0}, {2, 0}, {1, 1}}}};
    return {tree_root + b, {{{0, 2}, {0, 0}, {1, 1}}}};
}

LimitBase::Chart LimitBase::chart(std::uint32_t root,
                                  const std::array<glm::dvec3, 3>& weights) const {
    const double side = (weights[0].x - weights[0].y) + (weights[1].x - weights[1].y) +
                        (weights[2].x - weights[2].y);
    return chart(root, side > 0);
}

LimitBase::Point LimitBase::point(PatchEvaluator& evaluator, std::uint32_t root,
                                  std::uint32_t tree_root, const glm::dvec2& uv,
                                  SecondSteps* second) const {
    const std::uint32_t face = domain_->roots[root].face;
    const std::uint32_t first = mesh_->face_offsets[face];
    Point p{};
    SecondDerivatives to;
    if (second) to = {&second->uu.x, &second->uv.x, &second->vv.x};
    const PointTraits traits = evaluator.point(tree_root, uv.x, uv.y, &p.position.x, &p.du.x,
                                               &p.dv.x, second ? &to : nullptr);
    p.extraordinary = traits.ring != no_index;
    if (p.extraordinary) {
        const RingNormal& normal = surface_->rings.normal(traits.ring);
        p.normal = normal.normal;
        p.fallback = normal.nearby;
        if (p.normal != glm::dvec3(0.0)) return p;
    }
    const PointNormal normal = point_normal(
        *surface_, evaluator, tree_root, uv.x, uv.y, p.du, p.dv,
        std::span(mesh_->corner_vertices).subspan(first, mesh_->face_offsets[face + 1] - first));
    p.normal = normal.normal;
    p.fallback = normal.fallback;
    return p;
}

void LimitBase::evaluate(std::span<const RootPoint> at, std::span<BasePoint> points) const {
    PatchEvaluator evaluator(surface_->pieces(), SimdLevel::automatic);
    for (std::size_t k = 0; k < at.size(); ++k) {
        const Chart chart = this->chart(at[k].root, at[k].weights.x >= at[k].weights.y);
        const Point p =
            point(evaluator, at[k].root, chart.tree_root, chart.parameters(at[k].weights));
        points[k] = {p.position, p.normal};
    }
}

glm::dvec3 LimitBase::turn_by_differences(PatchEvaluator& evaluator, std::uint32_t root,
                                          std::uint32_t tree_root, const glm::dvec2& uv,
                                          glm::length_t axis) const {
    constexpr double step = 0x1p-10;
    const auto moved = [&](double by) {
        glm::dvec2 to = uv;
        to[axis] += by;
        return point(evaluator, root, tree_root, to).normal;
    };
    return (moved(step) - moved(-step)) / (2 * step);
}

// Of directions nearly parallel, or one that is nearly none, the normal's derivative is noise.
bool LimitBase::tells_turn(const Point& p) {
    const double lengths = glm::length(p.du) + glm::length(p.dv);
    return !p.fallback && glm::length(glm::cross(p.du, p.dv)) > 0x1p-20 * lengths * lengths;
}

void LimitBase::frames(std::span<const RootPoint> at, std::span<BaseFrame> frames) const {
    PatchEvaluator evaluator(surface_->pieces(), SimdLevel::automatic);
    for (std::size_t k = 0; k < at.size(); ++k) {
        const std::uint32_t root = at[k].root;
        const Chart chart = this->chart(root, at[k].weights.x >= at[k].weights.y);
        glm::dvec2 uv = chart.parameters(at[k].weights);
        SecondSteps second;
        Point p = point(evaluator, root, chart.tree_root, uv, &second);
        BaseFrame& frame = frames[k];
        frame.point = {p.position, p.normal};
        frame.normal = p.normal;
        const glm::dvec2 nearby = uv + 0x1p-7 * (glm::dvec2(has_triangles() ? 1.0 / 3 : 0.5) - uv);
        // Derivatives at an extraordinary vertex are none by (u, v): those nearby.
        if (p.extraordinary) {
            uv = nearby;
            p = point(evaluator, root, chart.tree_root, uv, &second);
        }
        const glm::dvec3 du = p.du, dv = p.dv;
        // Beside a collapsed edge the normal turns by a rounding error over next to nothing.
        if (!tells_turn(p)) {
            uv = nearby;
            p = point(evaluator, root, chart.tree_root, uv, &second);
        }
        const bool by_differences = !tells_turn(p);
        // n = N/|N|, N = S_u × S_v: its derivative is that of N, across n, by |N|.
        const double length = glm::length(glm::cross(p.du, p.dv));
        const std::array<glm::dvec3, 2> rises{
            glm::cross(second.uu, p.dv) + glm::cross(p.du, second.uv),
            glm::cross(second.uv, p.dv) + glm::cross(p.du, second.vv)};
        std::array<glm::dvec3, 2> turns;
        for (glm::length_t axis = 0; axis < 2; ++axis) {
            const glm::dvec3& rise = rises[std::size_t(axis)];
            const glm::dvec3 turn =
                by_differences ? turn_by_differences(evaluator, root, chart.tree_root, uv, axis)
                               : (rise - glm::dot(rise, p.normal) * p.normal) / length;
            turns[std::size_t(axis)] = turn - glm::dot(turn, frame.normal) * frame.normal;
        }
        for (std::size_t s = 0; s < 2; ++s) {
            const glm::dvec2 by = (chart.corners[s + 1] - chart.corners[0]) / chart.side;
            frame.position_steps[s] = by.x * du + by.y * dv;
            frame.direction_steps[s] = by.x * turns[0] + by.y * turns[1];
        }
    }
}

BaseDeviation LimitBase::deviation(std::uint32_t root, const std::array<glm::dvec3, 3>& weights,
                                   const std::array<BasePoint, 3>& corners) const {
    const auto part = [&](const std::array<glm::dvec3, 3>& w, const std::array<BasePoint, 3>& p) {
        const Chart chart = this->chart(root, w);
        LimitTriangle triangle;
        triangle.root = chart.tree_root;
        for (std::size_t k = 0; k < 3; ++k) {
            triangle.parameters[k] = chart.at(w[k]);
            triangle.positions[k] = p[k].position;
            triangle.normals[k] = p[k].direction;
        }
        return limit_deviation(*surface_, cones_.get(), triangle);
    };
    if (!is_in_two_halves(root, weights)) return part(weights, corners);
    const RootPoint at{root, 0.5 * (weights[0] + weights[1])};
    BasePoint middle;
    evaluate({&at, 1}, {&middle, 1});
    const BaseDeviation one =
        part({weights[2], weights[0], at.weights}, {corners[2], corners[0], middle});
    const BaseDeviation other =
        part({weights[1], weights[2], at.weights}, {corners[1], corners[2], middle});
    const auto bent = [](const glm::dvec3& m, const glm::dvec3& a, const glm::dvec3& b) {
        return glm::length(m - 0.5 * (a + b));
    };
    BaseDeviation most;
    most.position = std::max(one.position, other.position) +
                    bent(middle.position, corners[0].position, corners[1].position);
    if (cones_)
        most.direction = std::max(one.direction, other.direction) +
                         bent(middle.direction, corners[0].direction, corners[1].direction);
    return most;
}

std::optional<BaseDeviation> LimitBase::coarse_deviation(
    std::uint32_t root, const std::array<glm::dvec3, 3>& weights) const {
    if (is_in_two_halves(root, weights)) return std::nullopt;
    const Chart chart = this->chart(root, weights);
    return cells_->deviation(chart.tree_root,
                             {chart.at(weights[0]), chart.at(weights[1]), chart.at(weights[2])});
}

}  // namespace prep::detail
