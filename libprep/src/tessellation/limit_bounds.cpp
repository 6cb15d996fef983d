#include "tessellation/limit_bounds.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.h"
#include "tessellation/polygon_surface.h"

namespace prep::detail {
namespace {

constexpr double no_bound = 2;  // no two unit vectors are further apart

// `factor`: the triangle's extent over the patch's box.
double filip(const BezierPatch& patch, const glm::dvec2& factor) {
    const auto [uu, uv, vv] = second_derivative_bounds(patch);
    return (factor.x * factor.x * uu + 2 * factor.x * factor.y * uv + factor.y * factor.y * vv) / 8;
}

// The same of the direction. `e`: a unit vector that is near the patch's normals.
double normal_filip(const BezierPatch& patch, const glm::dvec3& e, const glm::dvec2& factor) {
    const NormalNet net = normal_net(patch);
    const auto& n = net.n;
    struct Suprema {
        double along = 0, across = 0;  // squares of the parts by e and across it
        void widen(const glm::dvec3& x, const glm::dvec3& e) {
            const double by_e = glm::dot(x, e);
            const glm::dvec3 rest = x - by_e * e;
            along = std::max(along, by_e * by_e);
            across = std::max(across, glm::dot(rest, rest));
        }
    };
    double least = std::numeric_limits<double>::infinity();
    Suprema whole;
    for (const glm::dvec3& x : n) {
        least = std::min(least, glm::dot(x, e));
        whole.widen(x, e);
    }
    least -= net.error;
    if (!(least > 0)) return no_bound;
    // Sine of the angle to e, no more than its tangent: what the planes across the two differ by.
    const double turn = std::min(1.0, (std::sqrt(whole.across) + net.error) / least);
    Suprema u, v, uu, uv, vv;
    for (std::size_t j = 0; j < 6; ++j)
        for (std::size_t i = 0; i < 6; ++i) {
            const std::size_t k = 6 * j + i;
            if (i < 5) u.widen(n[k + 1] - n[k], e);
            if (j < 5) v.widen(n[k + 6] - n[k], e);
            if (i < 4) uu.widen((n[k] - n[k + 1]) - (n[k + 1] - n[k + 2]), e);
            if (j < 4) vv.widen((n[k] - n[k + 6]) - (n[k + 6] - n[k + 12]), e);
            if (i < 5 && j < 5) uv.widen((n[k] - n[k + 1]) - (n[k + 6] - n[k + 7]), e);
        }
    struct Derivative {
        double along, across;  // of what is along n, and across it
    };
    const auto derivative = [&](const Suprema& x, double times) {
        const double error = 4 * net.error;
        const double along = times * (std::sqrt(x.along) + error);
        const double across = times * (std::sqrt(x.across) + error);
        return Derivative{std::min(along + turn * across, std::hypot(along, across)),
                          across + turn * along};
    };
    const Derivative d_u = derivative(u, 5 * factor.x), d_v = derivative(v, 5 * factor.y);
    const double second = derivative(uu, 20 * factor.x * factor.x).across +
                          2 * derivative(uv, 25 * factor.x * factor.y).across +
                          derivative(vv, 20 * factor.y * factor.y).across;
    const double first = (d_u.across + d_v.across) *
                         std::hypot(d_u.across + d_v.across, 2 * (d_u.along + d_v.along));
    return std::min(no_bound, (second / least + first / (least * least)) / 8);
}

// Bézier points of degree 2 × 3 (by u) and 3 × 2 (by v): first differences.
struct Slopes {
    std::array<glm::dvec3, 12> u, v;  // u[3 j + i], v[4 j + i]
};
Slopes slopes_of(const BezierPatch& patch) {
    Slopes s;
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 3; ++i)
            s.u[3 * j + i] = patch.p[4 * j + i + 1] - patch.p[4 * j + i];
    for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = 0; i < 4; ++i)
            s.v[4 * j + i] = patch.p[4 * (j + 1) + i] - patch.p[4 * j + i];
    return s;
}

// The least Bézier coefficient of (S_u × S_v)·e, of degree 5 × 5.
double least_along(const Slopes& s, const glm::dvec3& e) {
    static constexpr double two[3] = {1, 2, 1}, three[4] = {1, 3, 3, 1};
    static constexpr double five[6] = {1, 5, 10, 10, 5, 1};
    double sums[6][6] = {};
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec3 u = s.u[3 * j + i];
            const glm::dvec3 turned = glm::cross(e, u);  // (u × v)·e = v·(e × u)
            for (std::size_t l = 0; l < 3; ++l)
                for (std::size_t k = 0; k < 4; ++k)
                    sums[j + l][i + k] +=
                        two[i] * three[j] * three[k] * two[l] * glm::dot(turned, s.v[4 * l + k]);
        }
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < 6; ++j)
        for (std::size_t i = 0; i < 6; ++i)
            least = std::min(least, sums[j][i] / (five[i] * five[j]));
    return least;
}

// Largest |n − e|.
double cone_about(const BezierPatch& patch, const glm::dvec3& e) {
    const Slopes s = slopes_of(patch);
    const double along = least_along(s, e);
    if (!(along > 0)) return no_bound;
    double u = 0, v = 0, rise_u = 0, rise_v = 0;
    for (std::size_t k = 0; k < 12; ++k) {
        u = std::max(u, glm::length(s.u[k]));
        v = std::max(v, glm::length(s.v[k]));
        rise_u = std::max(rise_u, std::abs(glm::dot(s.u[k], e)));
        rise_v = std::max(rise_v, std::abs(glm::dot(s.v[k], e)));
    }
    // N across e is turned by e: S_u (S_v·e) − S_v (S_u·e).
    return std::min(no_bound, (u * rise_v + v * rise_u) / along);
}

// The linear function of a triangle.
struct Linear {
    glm::dvec2 at;
    glm::dvec3 value, du, dv;
    explicit Linear(const LimitTriangle& t) : at(t.parameters[0]), value(t.positions[0]) {
        const glm::dvec2 p = t.parameters[1] - at, q = t.parameters[2] - at;
        const double area = p.x * q.y - p.y * q.x;
        const glm::dvec3 a = t.positions[1] - value, b = t.positions[2] - value;
        du = (q.y * a - p.y * b) / area;
        dv = (p.x * b - q.x * a) / area;
    }
    glm::dvec3 operator()(const glm::dvec2& p) const {
        return value + (p.x - at.x) * du + (p.y - at.y) * dv;
    }
};

bool is_apart(const ParameterBox& box, const LimitTriangle& t) {
    const auto& p = t.parameters;
    const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) {
        return a.x * b.y - a.y * b.x;
    };
    const double turn = cross(p[1] - p[0], p[2] - p[0]) > 0 ? 1 : -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 from = p[k], along = p[(k + 1) % 3] - from;
        bool outside = true;
        for (const double x : {box.low.x, box.high.x})
            for (const double y : {box.low.y, box.high.y})
                outside = outside && turn * cross(along, glm::dvec2(x, y) - from) <= 0;
        if (outside) return true;
    }
    return false;
}

double farthest(const glm::dvec3& from, const std::array<glm::dvec3, 3>& to) {
    return std::max(
        {glm::length(from - to[0]), glm::length(from - to[1]), glm::length(from - to[2])});
}

// Of first order: how far the normal turns within the patch, and between it and the corners.
double cone_deviation(const BezierPatch& patch, const LimitTriangle& triangle) {
    const auto middle = middle_derivatives(patch);
    const glm::dvec3 e = unit_or(glm::cross(middle[0], middle[1]), triangle.normals[0]);
    return cone_about(patch, e) + farthest(e, triangle.normals);
}

BaseDeviation at_vertex(const ChannelSurface& surface, const RingCones* cones,
                        const LimitTriangle& triangle, const LimitPieces& pieces) {
    BaseDeviation most;
    const Linear linear(triangle);
    for (const BezierPatch& patch : pieces.patches) {
        if (is_apart(patch.box, triangle)) continue;
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t i = 0; i < 4; ++i) {
                const glm::dvec2 at = patch.box.low + glm::dvec2(i, j) / 3.0 * patch.box.size();
                most.position =
                    std::max(most.position, glm::length(patch.p[4 * j + i] - linear(at)));
            }
        if (cones) most.direction = std::max(most.direction, cone_deviation(patch, triangle));
    }
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

RingCones::RingCones(const ChannelSurface& surface, int threads) {
    std::size_t sectors = 0;
    for (const Ring& ring : surface.tree.rings) {
        first_.push_back(sectors);
        sectors += ring.shape.sectors;
    }
    cones_.resize(sectors * std::size_t(levels));
    parallel_blocks(first_.size(), 16, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) {
            const Ring& ring = surface.tree.rings[r];
            const glm::dvec3 normal = surface.rings.normal(std::uint32_t(r)).normal;
            float* const cones = cones_.data() + first_[r] * std::size_t(levels);
            RingLevels walked;
            walked.start(ring, 3, surface.rings.level(surface.tree, std::uint32_t(r), 0));
            for (int k = 0; k < levels; ++k) {
                const double* const rings = walked.level(k);
                const double* const next = walked.after();
                for (std::uint32_t j = 0; j < ring.shape.sectors; ++j) {
                    double most = 0;
                    for (const BezierPatch& patch :
                         ring_level_patches(ring.shape, rings, next, j, k))
                        most = std::max(most, cone_about(patch, normal));
                    cones[std::size_t(j) * levels + std::size_t(k)] =
                        std::nextafter(float(most), std::numeric_limits<float>::infinity());
                }
            }
            for (std::uint32_t j = 0; j < ring.shape.sectors; ++j)
                for (int k = levels - 1; k > 0; --k) {
                    float* const cone = cones + std::size_t(j) * levels + std::size_t(k);
                    cone[-1] = std::max(cone[-1], cone[0]);
                }
        }
    });
}

double RingCones::from_level(std::uint32_t ring, std::uint32_t sector, int k) const {
    if (k >= levels) k = levels - 1;
    return double(cones_[(first_[ring] + sector) * std::size_t(levels) + std::size_t(k)]);
}

BaseDeviation limit_deviation(const ChannelSurface& surface, const RingCones* cones,
                              const LimitTriangle& triangle) {
    const auto& p = triangle.parameters;
    const ParameterBox box{glm::min(p[0], glm::min(p[1], p[2])),
                           glm::max(p[0], glm::max(p[1], p[2]))};
    thread_local LimitPieces pieces;
    collect_pieces(surface, triangle.root, box, pieces);
    if (!pieces.tips.empty()) return at_vertex(surface, cones, triangle, pieces);
    BaseDeviation most;
    // Each argument over all pieces: from one piece to a corner in another both are met.
    double by_cones = 0;
    for (const BezierPatch& patch : pieces.patches) {
        if (is_apart(patch.box, triangle)) continue;
        const auto middle = middle_derivatives(patch);
        const glm::dvec3 normal = glm::cross(middle[0], middle[1]);
        const glm::dvec2 factor = box.size() / patch.box.size();
        most.position = std::max(most.position, filip(patch, factor));
        if (!cones) continue;
        most.direction = std::max(
            most.direction, normal_filip(patch, unit_or(normal, triangle.normals[0]), factor));
    }
    // Beside an extraordinary vertex the second derivatives are as large at every scale.
    constexpr double worth_a_second_look = 0.01;
    if (cones && most.direction > worth_a_second_look) {
        for (const BezierPatch& patch : pieces.patches)
            if (!is_apart(patch.box, triangle))
                by_cones = std::max(by_cones, cone_deviation(patch, triangle));
        most.direction = std::min(most.direction, by_cones);
    }
    return most;
}

}  // namespace prep::detail
