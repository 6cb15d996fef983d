#include "setup.h"

#include <algorithm>
#include <cmath>

namespace rast {
namespace {

double determinant(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
    return a.x * (b.y * c.w - b.w * c.y) - a.y * (b.x * c.w - b.w * c.x) +
           a.w * (b.x * c.y - b.y * c.x);
}

// The part of the triangle that is in front of the near plane, as a box in pixels.
bool crossing_box(const std::array<const ScreenVertex*, 3>& v, double& low_x, double& low_y,
                  double& high_x, double& high_y) {
    struct Point {
        double x, y, w, z;
    };
    std::array<Point, 4> polygon;
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        const ScreenVertex &a = *v[i], &b = *v[(i + 1) % 3];
        const double da = a.w - a.z, db = b.w - b.z;  // ≥ 0: behind the near plane's far side
        if (da >= 0) polygon[count++] = {a.x, a.y, a.w, a.z};
        if ((da >= 0) != (db >= 0)) {
            const double s = da / (da - db);
            polygon[count++] = {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.w + s * (b.w - a.w),
                                0};
        }
    }
    low_x = low_y = INFINITY;
    high_x = high_y = -INFINITY;
    for (int i = 0; i < count; ++i) {
        if (!(polygon[i].w > 0)) return false;
        const double x = polygon[i].x / polygon[i].w, y = polygon[i].y / polygon[i].w;
        low_x = std::min(low_x, x);
        high_x = std::max(high_x, x);
        low_y = std::min(low_y, y);
        high_y = std::max(high_y, y);
    }
    return count > 0;
}

std::int32_t clamp_pixel(double x, std::uint32_t extent) {
    return std::int32_t(std::clamp(x, -1.0, double(extent)));
}

void set_up_crossing(std::span<const ScreenVertex> vertices, SetupTriangle t,
                     const SetupContext& context, std::vector<SetupTriangle>& out,
                     Counters& counters) {
    const std::array<const ScreenVertex*, 3> v{&vertices[t.vertices[0]], &vertices[t.vertices[1]],
                                               &vertices[t.vertices[2]]};
    double low_x, low_y, high_x, high_y;
    if (!crossing_box(v, low_x, low_y, high_x, high_y)) {
        ++counters.outside;
        return;
    }
    // One pixel more on each side pays for the rounding of the clip points.
    t.min_x = std::max(0, clamp_pixel(std::floor(low_x) - 1, context.width));
    t.min_y = std::max(0, clamp_pixel(std::floor(low_y) - 1, context.height));
    t.max_x = std::min(std::int32_t(context.width) - 1,
                       clamp_pixel(std::ceil(high_x) + 1, context.width));
    t.max_y = std::min(std::int32_t(context.height) - 1,
                       clamp_pixel(std::ceil(high_y) + 1, context.height));
    if (t.min_x > t.max_x || t.min_y > t.max_y) {
        ++counters.outside;
        return;
    }
    t.crossing = true;
    ++counters.crossing;
    out.push_back(t);
}

// The first pixel whose centre is at or right of x (in 1/256 pixels), and the last at or left of
// it.
std::int32_t first_centre(std::int32_t x) {
    return (x + subpixel_one / 2 - 1) >> subpixel_bits;
}
std::int32_t last_centre(std::int32_t x) {
    return (x - subpixel_one / 2) >> subpixel_bits;
}

void set_depth_plane(std::span<const ScreenVertex> vertices, std::int64_t area, SetupTriangle& t) {
    double d[3];
    for (int i = 0; i < 3; ++i) d[i] = vertices[t.vertices[i]].z / vertices[t.vertices[i]].w;
    // In 1/256 pixels: area is twice the triangle's, exact.
    const double x1 = t.sx[1] - t.sx[0], y1 = t.sy[1] - t.sy[0];
    const double x2 = t.sx[2] - t.sx[0], y2 = t.sy[2] - t.sy[0];
    const double d1 = d[1] - d[0], d2 = d[2] - d[0], scale = subpixel_one / double(area);
    t.depth = d[0];
    t.depth_dx = (d1 * y2 - d2 * y1) * scale;
    t.depth_dy = (d2 * x1 - d1 * x2) * scale;
    t.depth_min = float(std::min({d[0], d[1], d[2]}));  // below 0: beyond the far plane
    t.depth_max = std::min(1.0f, float(std::max({d[0], d[1], d[2]})));
}

}  // namespace

ScreenVertex screen_vertex(const glm::dvec4& clip, std::uint32_t width, std::uint32_t height) {
    ScreenVertex v;
    v.x = (clip.x + clip.w) * 0.5 * width;
    v.y = (clip.w - clip.y) * 0.5 * height;
    v.w = clip.w;
    v.z = clip.z;
    v.finite = std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.w) && std::isfinite(v.z);
    // In front of the near plane (depth ≤ 1) and of the eye.
    if (v.finite && v.w > 0 && v.z <= v.w) {
        const double x = v.x / v.w, y = v.y / v.w;
        if (std::abs(x) < guard_band && std::abs(y) < guard_band) {
            v.sx = std::int32_t(std::floor(x * subpixel_one + 0.5));
            v.sy = std::int32_t(std::floor(y * subpixel_one + 0.5));
            v.snapped = true;
        }
    }
    return v;
}

void set_up_triangle(std::span<const ScreenVertex> vertices, std::array<std::uint32_t, 3> corners,
                     std::uint32_t triangle, CullSide cull, const SetupContext& context,
                     std::vector<SetupTriangle>& out, Counters& counters) {
    ++counters.triangles;
    const ScreenVertex &a = vertices[corners[0]], &b = vertices[corners[1]],
                       &c = vertices[corners[2]];
    if (!a.finite || !b.finite || !c.finite) {
        ++counters.non_finite;
        return;
    }
    const bool all_snapped = a.snapped && b.snapped && c.snapped;
    std::int64_t area = 0;
    bool positive;
    if (all_snapped) {
        area =
            std::int64_t(b.sx - a.sx) * (c.sy - a.sy) - std::int64_t(b.sy - a.sy) * (c.sx - a.sx);
        if (area == 0) {
            ++counters.degenerate;
            return;
        }
        positive = area > 0;
    } else {
        const auto in_front = [](const ScreenVertex& v) { return v.w - v.z >= 0; };
        if (!in_front(a) && !in_front(b) && !in_front(c)) {
            ++counters.outside;
            return;
        }
        const double det = determinant(a, b, c);
        if (!(det != 0)) {
            ++counters.degenerate;
            return;
        }
        positive = det > 0;
    }
    // y points down on the screen: counter-clockwise in the world is a negative area here.
    const bool back = positive != context.mirrored;
    if ((cull == CullSide::back && back) || (cull == CullSide::front && !back)) {
        ++counters.facing_away;
        return;
    }
    SetupTriangle t;
    t.vertices = corners;
    if (!positive) std::swap(t.vertices[1], t.vertices[2]);
    t.triangle = triangle;
    t.instance = context.instance;
    t.back = back;
    if (!all_snapped) {
        set_up_crossing(vertices, t, context, out, counters);
        return;
    }
    for (int i = 0; i < 3; ++i) {
        t.sx[i] = vertices[t.vertices[i]].sx;
        t.sy[i] = vertices[t.vertices[i]].sy;
    }
    const auto [low_x, high_x] = std::minmax({t.sx[0], t.sx[1], t.sx[2]});
    const auto [low_y, high_y] = std::minmax({t.sy[0], t.sy[1], t.sy[2]});
    t.min_x = first_centre(low_x);
    t.max_x = last_centre(high_x);
    t.min_y = first_centre(low_y);
    t.max_y = last_centre(high_y);
    if (t.min_x > t.max_x || t.min_y > t.max_y) {
        ++counters.between_samples;
        return;
    }
    t.min_x = std::max(t.min_x, 0);
    t.min_y = std::max(t.min_y, 0);
    t.max_x = std::min(t.max_x, std::int32_t(context.width) - 1);
    t.max_y = std::min(t.max_y, std::int32_t(context.height) - 1);
    if (t.min_x > t.max_x || t.min_y > t.max_y || (a.z < 0 && b.z < 0 && c.z < 0)) {
        ++counters.outside;
        return;
    }
    set_depth_plane(vertices, std::abs(area), t);
    out.push_back(t);
}

std::array<IntegerEdge, 3> integer_edges(const SetupTriangle& t) {
    std::array<IntegerEdge, 3> edges;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const std::int64_t dx = t.sx[k] - t.sx[j], dy = t.sy[k] - t.sy[j];
        // Interior on the right of a left edge (dy < 0) and below a top edge (dy = 0, dx > 0).
        const bool inclusive = dy < 0 || (dy == 0 && dx > 0);
        constexpr std::int64_t half = subpixel_one / 2;
        IntegerEdge& e = edges[i];
        e.bias = inclusive ? 0 : -1;
        e.a = -dy * subpixel_one;
        e.b = dx * subpixel_one;
        e.c = dx * (half - t.sy[j]) - dy * (half - t.sx[j]) + e.bias;
    }
    return edges;
}

CrossingTriangle crossing_edges(std::span<const ScreenVertex> vertices, const SetupTriangle& t) {
    CrossingTriangle result;
    for (int i = 0; i < 3; ++i) {
        const ScreenVertex& v = vertices[t.vertices[i]];
        result.w[i] = v.w;
        result.z[i] = v.z;
        const ScreenVertex& from = vertices[t.vertices[(i + 1) % 3]];
        const ScreenVertex& to = vertices[t.vertices[(i + 2) % 3]];
        CrossingEdge& e = result.edges[i];
        const auto along = [&](const ScreenVertex& start, double dx, double dy, double sign) {
            e.px = double(start.sx) / subpixel_one;
            e.py = double(start.sy) / subpixel_one;
            e.nx = sign * -dy;
            e.ny = sign * dx;
        };
        if (from.snapped && to.snapped) {
            along(from, double(to.sx - from.sx) / subpixel_one,
                  double(to.sy - from.sy) / subpixel_one, 1);
            e.weight = from.w * to.w;
        } else if (from.snapped || to.snapped) {
            const ScreenVertex& start = from.snapped ? from : to;
            const ScreenVertex& other = from.snapped ? to : from;
            const double x = double(start.sx) / subpixel_one, y = double(start.sy) / subpixel_one;
            along(start, other.x - x * other.w, other.y - y * other.w, from.snapped ? 1 : -1);
            e.weight = start.w;
        } else {
            e.nx = from.y * to.w - from.w * to.y;
            e.ny = from.w * to.x - from.x * to.w;
            e.constant = from.x * to.y - from.y * to.x;
        }
        e.inclusive = e.nx > 0 || (e.nx == 0 && e.ny > 0);
    }
    return result;
}

Barycentrics barycentrics(std::span<const ScreenVertex> vertices, const SetupTriangle& t,
                          std::int32_t x, std::int32_t y) {
    double e[3], ex[3], ey[3];
    if (t.crossing) {
        const CrossingTriangle c = crossing_edges(vertices, t);
        for (int i = 0; i < 3; ++i) {
            e[i] = std::max(0.0, c.edges[i].value(x + 0.5, y + 0.5)) * c.edges[i].weight;
            ex[i] = c.edges[i].nx * c.edges[i].weight;
            ey[i] = c.edges[i].ny * c.edges[i].weight;
        }
    } else {
        const std::array<IntegerEdge, 3> edges = integer_edges(t);
        double w[3];
        for (int i = 0; i < 3; ++i) w[i] = vertices[t.vertices[i]].w;
        // e_i / w_i, times the product of all w: no division needed before the common one.
        const double weight[3] = {w[1] * w[2], w[2] * w[0], w[0] * w[1]};
        for (int i = 0; i < 3; ++i) {
            const std::int64_t value = edges[i].a * x + edges[i].b * y + edges[i].c - edges[i].bias;
            e[i] = double(value) * weight[i];
            ex[i] = double(edges[i].a) * weight[i];
            ey[i] = double(edges[i].b) * weight[i];
        }
    }
    const double sum = e[0] + e[1] + e[2], inverse = sum > 0 ? 1 / sum : 0;
    const double sum_x = ex[0] + ex[1] + ex[2], sum_y = ey[0] + ey[1] + ey[2];
    Barycentrics result;
    for (int i = 0; i < 3; ++i) {
        const double b = e[i] * inverse;
        result.value[i] = float(b);
        result.dx[i] = float((ex[i] - b * sum_x) * inverse);
        result.dy[i] = float((ey[i] - b * sum_y) * inverse);
    }
    return result;
}

}  // namespace rast
