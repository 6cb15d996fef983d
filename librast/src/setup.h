// From vertices to triangles that are ready to be rasterized.
//
// Screen space: pixels, x right, y down, homogeneous: (x·w, y·w, w), depth·w as the fourth.
// Vertices in front of the near plane and within the guard band are snapped to 1/256 pixel; all
// others are not.
//
// Watertight by construction: how an edge is evaluated depends on its two vertices only, so both
// triangles that share it partition the samples alike. Two snapped ends: exact integers and the
// top-left rule. One: the line from the snapped end towards the other in homogeneous double, so
// that all lines at a snapped vertex pass through it exactly. None: the homogeneous cross product,
// which IEEE arithmetic negates exactly when its operands are swapped.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rast/render.h"

namespace rast {

inline constexpr int subpixel_bits = 8;
inline constexpr int subpixel_one = 1 << subpixel_bits;
// With coordinates below 2^22 (16384 px · 256) an edge function is below 2^46: far inside 64 bits.
inline constexpr double guard_band = 16384;

struct ScreenVertex {
    double x = 0, y = 0, w = 0, z = 0;  // homogeneous pixels; z = depth · w
    std::int32_t sx = 0, sy = 0;        // 1/256 pixels, when snapped
    bool snapped = false, finite = false;
};

ScreenVertex screen_vertex(const glm::dvec4& clip, std::uint32_t width, std::uint32_t height);

struct SetupTriangle {
    std::array<std::uint32_t, 3> vertices;  // of the instance, ordered so that the area is positive
    std::uint32_t triangle = 0, instance = 0;
    std::int32_t min_x = 0, min_y = 0, max_x = -1, max_y = -1;  // pixels, inclusive
    std::array<std::int32_t, 3> sx, sy;                         // when not crossing
    bool back = false;                                          // seen from behind
    bool crossing = false;                                      // has an end that is not snapped
    // Depth, anchored at vertex 0: d + dx·(x − x0) + dy·(y − y0) in pixels; when not crossing.
    double depth = 0, depth_dx = 0, depth_dy = 0;
    float depth_min = 0, depth_max = 0;
};

enum class CullSide : std::uint8_t { none, back, front };

struct SetupContext {
    std::uint32_t width = 0, height = 0;
    std::uint32_t instance = 0;
    bool mirrored = false;  // the instance's transform turns the winding round
};

// Appends the triangle to `out` unless it is culled, and counts.
void set_up_triangle(std::span<const ScreenVertex> vertices, std::array<std::uint32_t, 3> corners,
                     std::uint32_t triangle, CullSide cull, const SetupContext& context,
                     std::vector<SetupTriangle>& out, Counters& counters);

// One edge of a crossing triangle: value(x, y) > 0 inside, in pixels; `weight` makes it the
// homogeneous edge function.
struct CrossingEdge {
    double nx = 0, ny = 0, px = 0, py = 0, constant = 0, weight = 1;
    bool inclusive = false;
    double value(double x, double y) const { return nx * (x - px) + ny * (y - py) + constant; }
    bool inside(double value_here) const {
        return value_here > 0 || (inclusive && value_here == 0);
    }
};

struct CrossingTriangle {
    std::array<CrossingEdge, 3> edges;  // edge i is opposite to vertex i
    std::array<double, 3> w, z;
};
CrossingTriangle crossing_edges(std::span<const ScreenVertex> vertices, const SetupTriangle& t);

// One edge function of a snapped triangle, at pixel centres: value(x, y) ≥ 0 inside (the top-left
// rule is in the constant).
struct IntegerEdge {
    std::int64_t a = 0, b = 0, c = 0;  // a·x + b·y + c with x, y whole pixels
    std::int64_t bias = 0;             // 0 or −1, already in c
};
std::array<IntegerEdge, 3> integer_edges(const SetupTriangle& t);

// Calls visit(x, y, depth) for every pixel of the rectangle whose centre the triangle covers, row
// by row.
template <class Visit>
void visit_coverage(std::span<const ScreenVertex> vertices, const SetupTriangle& t, std::int32_t x0,
                    std::int32_t y0, std::int32_t x1, std::int32_t y1, const Visit& visit) {
    x0 = std::max(x0, t.min_x);
    y0 = std::max(y0, t.min_y);
    x1 = std::min(x1, t.max_x);
    y1 = std::min(y1, t.max_y);
    if (x0 > x1 || y0 > y1) return;
    if (t.crossing) {
        const CrossingTriangle c = crossing_edges(vertices, t);
        for (std::int32_t y = y0; y <= y1; ++y)
            for (std::int32_t x = x0; x <= x1; ++x) {
                std::array<double, 3> e;
                bool inside = true;
                for (int i = 0; i < 3; ++i) {
                    const double value = c.edges[i].value(x + 0.5, y + 0.5);
                    inside = inside && c.edges[i].inside(value);
                    e[i] = value * c.edges[i].weight;
                }
                if (!inside) continue;
                const double w = e[0] * c.w[0] + e[1] * c.w[1] + e[2] * c.w[2];
                const double z = e[0] * c.z[0] + e[1] * c.z[1] + e[2] * c.z[2];
                const double depth = z / w;
                if (depth >= 0 && depth <= 1) visit(x, y, float(depth));
            }
        return;
    }
    const std::array<IntegerEdge, 3> e = integer_edges(t);
    const double anchor_x = double(t.sx[0]) / subpixel_one,
                 anchor_y = double(t.sy[0]) / subpixel_one;
    for (std::int32_t y = y0; y <= y1; ++y) {
        std::int64_t v0 = e[0].a * x0 + e[0].b * y + e[0].c;
        std::int64_t v1 = e[1].a * x0 + e[1].b * y + e[1].c;
        std::int64_t v2 = e[2].a * x0 + e[2].b * y + e[2].c;
        const double row = t.depth + t.depth_dy * (y + 0.5 - anchor_y);
        for (std::int32_t x = x0; x <= x1; ++x) {
            if ((v0 | v1 | v2) >= 0) {
                const float depth = float(row + t.depth_dx * (x + 0.5 - anchor_x));
                const float kept = std::min(std::max(depth, t.depth_min), t.depth_max);
                if (kept >= 0) visit(x, y, kept);
            }
            v0 += e[0].a;
            v1 += e[1].a;
            v2 += e[2].a;
        }
    }
}

// Perspective-correct barycentric coordinates at a pixel centre and their change per pixel.
struct Barycentrics {
    glm::vec3 value, dx, dy;
};
Barycentrics barycentrics(std::span<const ScreenVertex> vertices, const SetupTriangle& t,
                          std::int32_t x, std::int32_t y);

}  // namespace rast
