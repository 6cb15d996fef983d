#include "tessellation/limit/hull_deviation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace prep::detail {
namespace {

// 1 or −1 as the triangle runs.
double orientation(const std::array<glm::dvec2, 3>& p) {
    return cross_of(p[1] - p[0], p[2] - p[0]) > 0 ? 1 : -1;
}

// Corners of a box in turn, from its low one.
constexpr std::array<glm::dvec2, 4> box_corners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

constexpr std::size_t point_count = 28;  // of degree 6

// The control points of a triangle within a patch's box.
struct TrianglePart {
    std::array<glm::dvec2, point_count> at;                     // of the box
    std::array<std::array<double, 16>, point_count> weights{};  // of the patch's points

    explicit TrianglePart(const std::array<glm::dvec2, 3>& corners) {
        std::size_t n = 0;
        for (int i = 0; i <= 6; ++i)
            for (int j = 0; i + j <= 6; ++j, ++n) {
                std::array<glm::dvec2, 6> x;
                for (int k = 0; k < 6; ++k)
                    x[std::size_t(k)] = corners[k < i ? 0 : k < i + j ? 1 : 2];
                at[n] = (double(i) * corners[0] + double(j) * corners[1] +
                         double(6 - i - j) * corners[2]) /
                        6.0;
                add_means(x, weights[n]);
            }
    }

  private:
    static std::array<double, 4> cubic(double a, double b, double c) {
        const double x = 1 - a, y = 1 - b, z = 1 - c;
        return {x * y * z, a * y * z + x * b * z + x * y * c, a * b * z + a * y * c + x * b * c,
                a * b * c};
    }
    static void add_means(const std::array<glm::dvec2, 6>& x, std::array<double, 16>& to) {
        constexpr double ways = 20;
        for (std::uint32_t taken = 0; taken < 64; ++taken) {
            std::array<double, 6> u{}, v{};
            std::size_t us = 0, vs = 0;
            for (std::uint32_t k = 0; k < 6; ++k)
                (taken >> k & 1) != 0 ? u[us++] = x[k].x : v[vs++] = x[k].y;
            if (us != 3) continue;
            const auto along_u = cubic(u[0], u[1], u[2]), along_v = cubic(v[0], v[1], v[2]);
            for (std::size_t b = 0; b < 4; ++b)
                for (std::size_t a = 0; a < 4; ++a) to[4 * b + a] += along_u[a] * along_v[b] / ways;
        }
    }
};

// `half[k]` is without corner k of the box; `tent[k]` over the side from it to the next.
struct TriangleParts {
    std::vector<TrianglePart> half, tent;
    TriangleParts() {
        for (std::size_t k = 0; k < 4; ++k) {
            const glm::dvec2 a = box_corners[k], b = box_corners[(k + 1) % 4];
            const glm::dvec2 c = box_corners[(k + 2) % 4], d = box_corners[(k + 3) % 4];
            half.emplace_back(std::array{b, c, d});
            tent.emplace_back(std::array{a, b, 0.5 * (c + d)});
        }
    }
};

enum class Cover : std::uint8_t { all, half, tent, other };

// What of the box the triangle covers, and the corner k of TriangleParts. Parameters are multiples
// of powers of two: nothing is rounded.
std::pair<Cover, std::size_t> cover_of(const ParameterBox& box, const LimitTriangle& triangle) {
    const auto& p = triangle.parameters;
    const double side = orientation(p);
    std::array<glm::dvec2, 4> corner;
    std::array<std::uint32_t, 4> outside{}, on{};  // a bit an edge
    std::size_t out = 0, last = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        corner[k] = box.low + box_corners[k] * box.size();
        for (std::uint32_t e = 0; e < 3; ++e) {
            const double at = side * cross_of(p[(e + 1) % 3] - p[e], corner[k] - p[e]);
            if (at < 0) outside[k] |= 1u << e;
            if (at == 0) on[k] |= 1u << e;
        }
        if (outside[k] != 0) ++out, last = k;
    }
    if (out == 0) return {Cover::all, 0};
    if (out == 1 && (on[(last + 1) % 4] & on[(last + 3) % 4] & outside[last]) != 0)
        return {Cover::half, last};
    for (std::size_t k = 0; out == 2 && k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        if (outside[k] != 0 || outside[next] != 0) continue;
        const glm::dvec2 tip = 0.5 * (corner[(k + 2) % 4] + corner[(k + 3) % 4]);
        const auto is_corner = [&](const glm::dvec2& q) {
            return q == p[0] || q == p[1] || q == p[2];
        };
        if (is_corner(corner[k]) && is_corner(corner[next]) && is_corner(tip))
            return {Cover::tent, k};
    }
    return {Cover::other, 0};
}

double largest_off(const BezierPatch& patch, const TrianglePart& part, const LinearMap& linear) {
    double most = 0;
    for (std::size_t n = 0; n < point_count; ++n) {
        glm::dvec3 point(0.0);
        for (std::size_t k = 0; k < 16; ++k) point += part.weights[n][k] * patch.p[k];
        const glm::dvec3 off =
            point + (patch.origin - linear(patch.box.low + part.at[n] * patch.box.size()));
        most = std::max(most, glm::dot(off, off));
    }
    return std::sqrt(most);
}

double largest_off(const BezierPatch& patch, const LinearMap& linear) {
    double most = 0;
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec2 at = patch.box.low + glm::dvec2(i, j) / 3.0 * patch.box.size();
            const glm::dvec3 off = patch.p[4 * j + i] + (patch.origin - linear(at));
            most = std::max(most, glm::dot(off, off));
        }
    return std::sqrt(most);
}

// Across its longer side.
std::array<BezierPatch, 2> halves_of(const BezierPatch& patch) {
    const glm::dvec2 size = patch.box.size();
    const bool along_u = size.x > size.y;
    const std::size_t step = along_u ? 1 : 4, row = along_u ? 4 : 1;
    std::array<BezierPatch, 2> parts{patch, patch};
    const glm::length_t axis = along_u ? 0 : 1;
    parts[0].box.high[axis] = parts[1].box.low[axis] = patch.box.low[axis] + 0.5 * size[axis];
    for (std::size_t r = 0; r < 4; ++r) {
        const auto at = [&](std::size_t k) { return r * row + k * step; };
        const glm::dvec3 a = patch.p[at(0)], b = patch.p[at(1)], c = patch.p[at(2)];
        const glm::dvec3 d = patch.p[at(3)];
        const glm::dvec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), cd = 0.5 * (c + d);
        const glm::dvec3 left = 0.5 * (ab + bc), right = 0.5 * (bc + cd);
        const glm::dvec3 middle = 0.5 * (left + right);
        parts[0].p[at(1)] = ab, parts[0].p[at(2)] = left, parts[0].p[at(3)] = middle;
        parts[1].p[at(0)] = middle, parts[1].p[at(1)] = right, parts[1].p[at(2)] = cd;
    }
    return parts;
}

template <std::size_t degree>
TriangleNet<degree + 1> raised_once(const TriangleNet<degree>& p) {
    TriangleNet<degree + 1> out;
    for (std::size_t j = 0; j <= degree + 1; ++j)
        for (std::size_t i = 0; i + j <= degree + 1; ++i) {
            const std::size_t own = degree + 1 - i - j;
            glm::dvec3 sum(0.0);
            if (own > 0) sum += double(own) * p[triangle_point(degree, i, j)];
            if (i > 0) sum += double(i) * p[triangle_point(degree, i - 1, j)];
            if (j > 0) sum += double(j) * p[triangle_point(degree, i, j - 1)];
            out[triangle_point(degree + 1, i, j)] = sum / double(degree + 1);
        }
    return out;
}

}  // namespace

LinearMap::LinearMap(const LimitTriangle& t) : at(t.parameters[0]), value(t.positions[0]) {
    const glm::dvec2 p = t.parameters[1] - at, q = t.parameters[2] - at;
    const double area = cross_of(p, q);
    const glm::dvec3 a = t.positions[1] - value, b = t.positions[2] - value;
    du = (q.y * a - p.y * b) / area;
    dv = (p.x * b - q.x * a) / area;
}

bool is_apart(const ParameterBox& box, const LimitTriangle& t) {
    const auto& p = t.parameters;
    const double side = orientation(p);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 from = p[k], along = p[(k + 1) % 3] - from;
        bool outside = true;
        for (const glm::dvec2& corner : box_corners)
            outside = outside && side * cross_of(along, box.low + corner * box.size() - from) <= 0;
        if (outside) return true;
    }
    return false;
}

double hull_deviation(const BezierPatch& patch, const LimitTriangle& triangle,
                      const LinearMap& linear, double least) {
    static const TriangleParts parts;
    if (is_apart(patch.box, triangle)) return least;
    // A part's points are means of the whole's: it is not farther off.
    const double whole = largest_off(patch, linear);
    if (whole <= least) return least;
    const auto [covered, k] = cover_of(patch.box, triangle);
    if (covered == Cover::half) return std::max(least, largest_off(patch, parts.half[k], linear));
    if (covered == Cover::tent) return std::max(least, largest_off(patch, parts.tent[k], linear));
    const glm::dvec2 size = patch.box.size();
    if (covered == Cover::all || size.x == size.y) return whole;
    const auto [first, second] = halves_of(patch);
    return hull_deviation(second, triangle, linear, hull_deviation(first, triangle, linear, least));
}

double hull_deviation(const QuarticPatch& patch, const LimitTriangle& /*triangle*/,
                      const LinearMap& linear, double least) {
    double most = least * least;
    const auto raised = raised_once<5>(raised_once<4>(patch.p));
    for (std::size_t j = 0, k = 0; j <= 6; ++j)
        for (std::size_t i = 0; i + j <= 6; ++i, ++k) {
            const glm::dvec2 at = (double(6 - i - j) * patch.corners[0] +
                                   double(i) * patch.corners[1] + double(j) * patch.corners[2]) /
                                  6.0;
            const glm::dvec3 off = raised[k] + (patch.origin - linear(at));
            most = std::max(most, glm::dot(off, off));
        }
    return std::max(least, std::sqrt(most));
}

}  // namespace prep::detail
