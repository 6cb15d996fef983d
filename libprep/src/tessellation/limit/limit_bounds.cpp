#include "tessellation/limit/limit_bounds.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "tessellation/limit/cone_kernels.h"
#include "tessellation/polygon_surface.h"

namespace prep::detail {
namespace {

constexpr double no_bound = 2;  // no two unit vectors are further apart

// a² M₁ + 2ab M₂ + b² M₃.
double over_extent(const glm::dvec2& extent, double uu, double uv, double vv) {
    return extent.x * extent.x * uu + 2 * extent.x * extent.y * uv + extent.y * extent.y * vv;
}

// What a patch's derivatives are by, in units of extents.
glm::dvec2 unit_of(const BezierPatch& patch) {
    return patch.box.size();
}
glm::dvec2 unit_of(const QuarticPatch&) {
    return glm::dvec2(1.0);
}

// Suprema over all pieces that the triangle meets, by the same axes: ways from a point to
// the corners lead through several, and the largest derivative by u may be in one, that by v in
// another.
class Curvature {
  public:
    template <class Patch>
    void widen(const Patch& patch) {
        const auto [uu, uv, vv] = second_derivative_bounds(patch);
        const glm::dvec2 factor = 1.0 / unit_of(patch);
        uu_ = std::max(uu_, factor.x * factor.x * uu);
        uv_ = std::max(uv_, factor.x * factor.y * uv);
        vv_ = std::max(vv_, factor.y * factor.y * vv);
    }
    double deviation(const glm::dvec2& extent) const {
        return over_extent(extent, uu_, uv_, vv_) / 8;
    }

  private:
    double uu_ = 0, uv_ = 0, vv_ = 0;
};

// Squares of the lengths of vectors by e, and across it: the largest ones.
struct AboutAxis {
    double along = 0, across = 0;
    void widen(const glm::dvec3& x, const glm::dvec3& e) {
        const double by_e = glm::dot(x, e);
        const glm::dvec3 rest = x - by_e * e;
        along = std::max(along, by_e * by_e);
        across = std::max(across, glm::dot(rest, rest));
    }
    void widen(std::span<const glm::dvec3> all, const glm::dvec3& e) {
        for (const glm::dvec3& x : all) widen(x, e);
    }
};

// Differences of a net's points, by what the patch's are by: of the first order, and of the second.
// A derivative is `first`, `pure` (twice by one parameter) or `mixed` times as much; each
// difference carries the errors of `points` points.
struct NetDifferences {
    AboutAxis u, v, uu, uv, vv;
    double first, pure, mixed, points;
};

NetDifferences differences_about(const NormalNet& net, const glm::dvec3& e) {
    NetDifferences d{{}, {}, {}, {}, {}, 5, 20, 25, 4};
    const auto& n = net.n;
    for (std::size_t j = 0; j < 6; ++j)
        for (std::size_t i = 0; i < 6; ++i) {
            const std::size_t k = 6 * j + i;
            if (i < 5) d.u.widen(n[k + 1] - n[k], e);
            if (j < 5) d.v.widen(n[k + 6] - n[k], e);
            if (i < 4) d.uu.widen((n[k] - n[k + 1]) - (n[k + 1] - n[k + 2]), e);
            if (j < 4) d.vv.widen((n[k] - n[k + 6]) - (n[k + 6] - n[k + 12]), e);
            if (i < 5 && j < 5) d.uv.widen((n[k] - n[k + 1]) - (n[k + 6] - n[k + 7]), e);
        }
    return d;
}

NetDifferences differences_about(const QuarticNormalNet& net, const glm::dvec3& e) {
    NetDifferences d{{}, {}, {}, {}, {}, 6, 30, 30, std::max(1.0, net.reach * net.reach)};
    const TriangleNet<5> u = blossom<6>(net.n, net.by_u), v = blossom<6>(net.n, net.by_v);
    d.u.widen(u, e);
    d.v.widen(v, e);
    d.uu.widen(blossom<5>(u, net.by_u), e);
    d.uv.widen(blossom<5>(u, net.by_v), e);
    d.vv.widen(blossom<5>(v, net.by_v), e);
    return d;
}

// The same of the direction: all by |N|, whose unit is each piece's own.
class NormalCurvature {
  public:
    // `e`: a unit vector that is near the patch's normals.
    template <class Patch>
    void widen(const Patch& patch, const glm::dvec3& e);
    double deviation(const glm::dvec2& extent) const {
        if (!bounded_) return no_bound;
        const double along = extent.x * u_.along + extent.y * v_.along;
        const double across = extent.x * u_.across + extent.y * v_.across;
        const double first = across * std::sqrt(across * across + 4 * along * along);
        return std::min(no_bound, (over_extent(extent, uu_, uv_, vv_) + first) / 8);
    }

  private:
    struct Derivative {
        double along = 0, across = 0;  // of what is along n, and across it
        void widen(const Derivative& other) {
            along = std::max(along, other.along);
            across = std::max(across, other.across);
        }
    };
    Derivative u_, v_;
    double uu_ = 0, uv_ = 0, vv_ = 0;  // across
    bool bounded_ = true;
};

template <class Patch>
void NormalCurvature::widen(const Patch& patch, const glm::dvec3& e) {
    const glm::dvec2 factor = 1.0 / unit_of(patch);
    const auto net = normal_net(patch);
    double least = std::numeric_limits<double>::infinity();
    AboutAxis whole;
    for (const glm::dvec3& x : net.n) {
        least = std::min(least, glm::dot(x, e));
        whole.widen(x, e);
    }
    least -= net.error;
    if (!(least > 0)) {
        bounded_ = false;
        return;
    }
    // Of the angle to e, no more than its tangent: what the planes across the two differ by.
    const double sine = std::min(1.0, (std::sqrt(whole.across) + net.error) / least);
    const NetDifferences by = differences_about(net, e);
    const auto derivative = [&](const AboutAxis& x, double times) {
        const double error = by.points * net.error;
        const double along = times / least * (std::sqrt(x.along) + error);
        const double across = times / least * (std::sqrt(x.across) + error);
        return Derivative{std::min(along + sine * across, std::hypot(along, across)),
                          across + sine * along};
    };
    u_.widen(derivative(by.u, by.first * factor.x));
    v_.widen(derivative(by.v, by.first * factor.y));
    uu_ = std::max(uu_, derivative(by.uu, by.pure * factor.x * factor.x).across);
    uv_ = std::max(uv_, derivative(by.uv, by.mixed * factor.x * factor.y).across);
    vv_ = std::max(vv_, derivative(by.vv, by.pure * factor.y * factor.y).across);
}

// Largest |n − e|. Directions within less than a right angle of e are a convex cone, so that the
// net's widest is wider than all.
double cone_about(const QuarticNormalNet& net, const glm::dvec3& e) {
    double widest = 0;  // tangent of the angle to e
    for (const glm::dvec3& x : net.n) {
        const double by_e = glm::dot(x, e);
        const double along = by_e - net.error;
        const double across = glm::length(x - by_e * e) + net.error;
        if (!(along > 0)) return no_bound;
        widest = std::max(widest, across / along);
    }
    return chord_of_tangent(widest);
}

double farthest(const glm::dvec3& from, const std::array<glm::dvec3, 3>& to) {
    return std::max(
        {glm::length(from - to[0]), glm::length(from - to[1]), glm::length(from - to[2])});
}

// Of its normals: the one in its middle.
template <class Patch>
glm::dvec3 axis_of(const Patch& patch, const glm::dvec3& otherwise) {
    const auto middle = middle_derivatives(patch);
    return unit_or(glm::cross(middle[0], middle[1]), otherwise);
}

// Of first order: how far the normal turns within each patch, and between it and the corners; or
// directly how far it is from each of those, as |n − I n| is no more than the largest |n − n(v)|.
class ConeDeviation {
  public:
    explicit ConeDeviation(const LimitTriangle& triangle) : triangle_(triangle) {}

    void add(const BezierPatch& patch) {
        axes_[held_] = axis_of(patch, triangle_.normals[0]);
        for (std::size_t d = 0; d < 3; ++d) {
            const int at = int(d);
            for (std::size_t c = 0; c < 16; ++c)
                points_[(3 * c + d) * patches_at_once + held_] = patch.p[c][at];
            by_axis_[d * patches_at_once + held_] = axes_[held_][at];
        }
        if (++held_ == patches_at_once) take();
    }
    void add(const QuarticPatch& patch) {
        const glm::dvec3 e = axis_of(patch, triangle_.normals[0]);
        const auto net = normal_net(patch);
        take(e, cone_about(net, e),
             [&](std::size_t k) { return cone_about(net, triangle_.normals[k]); });
    }
    double largest() {
        take();
        return most_;
    }

  private:
    // What is not above the largest one yet need not be the less of the two.
    template <class Cone>
    void take(const glm::dvec3& axis, double cone, const Cone& about_corner) {
        const double about_axis = cone + farthest(axis, triangle_.normals);
        double from_corners = most_;
        for (std::size_t k = 0; k < 3 && about_axis > from_corners; ++k)
            from_corners = std::max(from_corners, about_corner(k));
        most_ = std::max(most_, std::min(from_corners, about_axis));
    }
    void take() {
        if (held_ == 0) return;
        std::array<double, 4 * patches_at_once> widest;
        bezier_cones(points_.data(), by_axis_.data(), &triangle_.normals[0].x, held_, widest.data(),
                     SimdLevel::automatic);
        for (std::size_t p = 0; p < held_; ++p)
            take(axes_[p], chord_of_tangent(widest[p]), [&](std::size_t k) {
                return chord_of_tangent(widest[(k + 1) * patches_at_once + p]);
            });
        held_ = 0;
    }

    const LimitTriangle& triangle_;
    double most_ = 0;
    std::size_t held_ = 0;
    std::array<glm::dvec3, patches_at_once> axes_;
    std::array<double, 3 * patches_at_once> by_axis_{};
    std::array<double, 48 * patches_at_once> points_{};
};

BaseDeviation at_vertex(const ChannelSurface& surface, const RingCones* cones,
                        const LimitTriangle& triangle, const LimitPieces& pieces) {
    BaseDeviation most;
    const LinearMap linear(triangle);
    std::optional<ConeDeviation> direction;
    if (cones) direction.emplace(triangle);
    pieces.for_each_patch([&](const auto& patch) {
        if (is_apart(patch.box, triangle)) return;
        most.position = hull_deviation(patch, triangle, linear, most.position);
        if (direction) direction->add(patch);
    });
    if (direction) most.direction = direction->largest();
    for (const LimitTip& tip : pieces.tips) {
        if (is_apart(tip.box, triangle)) continue;
        const glm::dvec3 middle = linear(0.5 * (tip.box.low + tip.box.high));
        const glm::dvec3 reach =
            0.5 * (glm::abs(linear.du) * tip.box.size().x + glm::abs(linear.dv) * tip.box.size().y);
        for (const glm::dvec3& point : tip.hull)
            most.position =
                std::max(most.position, glm::length(point - middle) + glm::length(reach));
        if (!cones) continue;
        most.direction = std::max(
            most.direction, cones->from_level(tip.ring, tip.sector, tip.level) +
                                farthest(surface.rings.normal(tip.ring).normal, triangle.normals));
    }
    most.direction = std::min(most.direction, no_bound);
    return most;
}

}  // namespace

// Of the root's parameters: the square (i, j) of 2^level each way, or of those of a triangle its
// half at (i, j), or the other one.
struct CellBounds::Key {
    std::uint64_t owner = 0;  // none has 0
    std::uint32_t root = 0;
    int level = 0;
    std::uint64_t i = 0, j = 0;
    bool far_half = false;

    bool operator==(const Key&) const = default;
    std::uint64_t hash() const {
        std::uint64_t hash = (owner << 40) ^ (std::uint64_t(root) << 8) ^ std::uint64_t(level);
        for (const std::uint64_t part : {i, 2 * j + std::uint64_t(far_half)})
            hash = (hash ^ part) * 0x9e3779b97f4a7c15U;
        return hash >> 40;
    }
};

struct CellBounds::Cell {
    Key key;
    bool bounded = false;
    Curvature curvature;
    NormalCurvature normal_curvature;

    // With the key last: what is made in part is nobody's.
    void make(const Key& wanted, const ChannelSurface& surface, bool with_normals) {
        key = {};
        thread_local LimitPieces pieces;
        const bool triangles = surface.has_triangles();
        const double side = std::ldexp(triangles ? triangle_root_side : 1, -wanted.level);
        const glm::dvec2 low = side * glm::dvec2(double(wanted.i), double(wanted.j));
        const ParameterAxes axes{{side, 0}, {0, side}};
        const glm::dvec2 right = low + axes.u, up = low + axes.v;
        if (!triangles)
            collect_pieces(surface, wanted.root, {low, low + side}, pieces);
        else if (wanted.far_half)
            collect_pieces(surface, wanted.root, {low + side, up, right}, axes, pieces);
        else
            collect_pieces(surface, wanted.root, {low, right, up}, axes, pieces);
        bounded = pieces.tips.empty();
        curvature = {};
        normal_curvature = {};
        if (bounded)
            pieces.for_each_patch([&](const auto& patch) {
                curvature.widen(patch);
                if (with_normals)
                    normal_curvature.widen(patch, axis_of(patch, glm::dvec3(0, 0, 1)));
            });
        key = wanted;
    }
};

CellBounds::CellBounds(const ChannelSurface& surface, bool with_normals)
    : surface_(surface), with_normals_(with_normals) {
    static std::atomic<std::uint64_t> made{0};
    owner_ = ++made;
}

std::optional<BaseDeviation> CellBounds::deviation(std::uint32_t root,
                                                   const std::array<glm::dvec2, 3>& p) const {
    const bool triangles = surface_.has_triangles();
    const double root_side = triangles ? triangle_root_side : 1;
    const auto [low, high] = box_of(p);
    glm::dvec2 extent = high - low;
    // A cell is four triangles wide: some dozens share it, and derivatives differ little in it.
    int exponent = 0;
    std::frexp(std::max(extent.x, extent.y), &exponent);
    const int level = std::max(0, -exponent - (triangles ? 2 : 1));
    constexpr int deepest = 48;
    if (!(low.x >= 0 && low.y >= 0 && high.x <= root_side && high.y <= root_side) ||
        level > deepest)
        return std::nullopt;
    const double count = std::ldexp(1.0, level), cells = triangles ? count / root_side : count;
    const double x = std::min(std::floor(low.x * cells), count - 1);
    const double y = std::min(std::floor(low.y * cells), count - 1);
    if (high.x * cells > x + 1 || high.y * cells > y + 1) return std::nullopt;
    bool far_half = false;
    if (triangles) {
        extent *= cells;             // the axes are a cell's sides
        double least = 2, most = 0;  // of the sums of both parameters within the square
        for (const glm::dvec2& at : p) {
            const double sum = (at.x * cells - x) + (at.y * cells - y);
            least = std::min(least, sum);
            most = std::max(most, sum);
        }
        far_half = most > 1;
        const bool is_outside = far_half && x + y >= count - 1;
        if (is_outside || (far_half && least < 1)) return std::nullopt;
    }
    constexpr std::size_t kept = 1024;
    thread_local std::vector<Cell> cache(kept);
    const Key key{owner_, root, level, std::uint64_t(x), std::uint64_t(y), far_half};
    Cell& cell = cache[std::size_t(key.hash()) % kept];
    if (cell.key != key) cell.make(key, surface_, with_normals_);
    if (!cell.bounded) return std::nullopt;
    return BaseDeviation{cell.curvature.deviation(extent),
                         with_normals_ ? cell.normal_curvature.deviation(extent) : 0};
}

BaseDeviation limit_deviation(const ChannelSurface& surface, const RingCones* cones,
                              const LimitTriangle& triangle) {
    thread_local LimitPieces pieces;
    glm::dvec2 extent(1.0);  // by the axes
    if (surface.has_triangles()) {
        const ParameterAxes axes = axes_of(triangle.parameters);
        collect_pieces(surface, triangle.root, triangle.parameters, axes, pieces);
    } else {
        const ParameterBox box = box_of(triangle.parameters);
        collect_pieces(surface, triangle.root, box, pieces);
        extent = box.size();
    }
    if (!pieces.tips.empty()) return at_vertex(surface, cones, triangle, pieces);
    const LinearMap linear(triangle);
    Curvature curvature;
    NormalCurvature normal_curvature;
    double by_hulls = 0;
    pieces.for_each_patch([&](const auto& patch) {
        if (is_apart(patch.box, triangle)) return;
        curvature.widen(patch);
        by_hulls = hull_deviation(patch, triangle, linear, by_hulls);
        if (cones) normal_curvature.widen(patch, axis_of(patch, triangle.normals[0]));
    });
    BaseDeviation most;
    most.position = std::min(curvature.deviation(extent), by_hulls);
    if (cones) most.direction = normal_curvature.deviation(extent);
    // Beside an extraordinary vertex the second derivatives are as large at every scale.
    constexpr double worth_a_second_look = 0.01;
    if (cones && most.direction > worth_a_second_look) {
        ConeDeviation by_cones(triangle);
        pieces.for_each_patch([&](const auto& patch) {
            if (!is_apart(patch.box, triangle)) by_cones.add(patch);
        });
        most.direction = std::min(most.direction, by_cones.largest());
    }
    return most;
}

}  // namespace prep::detail
