#include "geometry/homogeneous_triangle.h"

#include <algorithm>
#include <cmath>

namespace rast::detail {
namespace {

bool snapped(const VertexRecord& v) {
    return v.x > first_valid;
}

double determinant(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
    return a.x * (b.y * c.w - b.w * c.y) - a.y * (b.x * c.w - b.w * c.x) +
           a.w * (b.x * c.y - b.y * c.x);
}

// The part of the triangle that is in front of the near plane, as a box in pixels.
bool visible_box(const std::array<ScreenVertex, 3>& v, CrossingTriangle& out) {
    out.low_x = out.low_y = INFINITY;
    out.high_x = out.high_y = -INFINITY;
    bool any = false;
    const auto add = [&](double x, double y, double w) {
        if (!(w > 0)) return false;
        out.low_x = std::min(out.low_x, x / w);
        out.high_x = std::max(out.high_x, x / w);
        out.low_y = std::min(out.low_y, y / w);
        out.high_y = std::max(out.high_y, y / w);
        any = true;
        return true;
    };
    for (std::size_t i = 0; i < 3; ++i) {
        const ScreenVertex &a = v[i], &b = v[(i + 1) % 3];
        const double da = a.w - a.z, db = b.w - b.z;  // ≥ 0: in front of the near plane
        if (da >= 0 && !add(a.x, a.y, a.w)) return false;
        if ((da >= 0) != (db >= 0)) {
            const double s = da / (da - db);
            if (!add(a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.w + s * (b.w - a.w)))
                return false;
        }
    }
    return any;
}

CrossingEdge edge_between(const VertexRecord& from, const VertexRecord& to,
                          const ScreenVertex& from_full, const ScreenVertex& to_full) {
    CrossingEdge e;
    const auto along = [&](const VertexRecord& start, double dx, double dy, double sign) {
        e.px = double(start.x) / subpixels;
        e.py = double(start.y) / subpixels;
        e.nx = sign * -dy;
        e.ny = sign * dx;
    };
    if (snapped(from) && snapped(to)) {
        along(from, double(to.x - from.x) / subpixels, double(to.y - from.y) / subpixels, 1);
    } else if (snapped(from) || snapped(to)) {
        const bool forward = snapped(from);
        const VertexRecord& start = forward ? from : to;
        const ScreenVertex& other = forward ? to_full : from_full;
        const double x = double(start.x) / subpixels, y = double(start.y) / subpixels;
        along(start, other.x - x * other.w, other.y - y * other.w, forward ? 1 : -1);
    } else {
        e.nx = from_full.y * to_full.w - from_full.w * to_full.y;
        e.ny = from_full.w * to_full.x - from_full.x * to_full.w;
        e.constant = from_full.x * to_full.y - from_full.y * to_full.x;
    }
    e.inclusive = e.nx > 0 || (e.nx == 0 && e.ny > 0);
    return e;
}

CrossingPlane plane_of(const std::array<ScreenVertex, 3>& corners, const CrossingTriangle& box) {
    CrossingPlane out;
    out.px = std::clamp((box.low_x + box.high_x) / 2, -guard_band, guard_band);
    out.py = std::clamp((box.low_y + box.high_y) / 2, -guard_band, guard_band);
    std::array<ScreenVertex, 3> v = corners;
    out.low = INFINITY;
    out.high = -INFINITY;
    for (ScreenVertex& c : v) {
        c.x -= out.px * c.w;
        c.y -= out.py * c.w;
        const bool in_front = c.w > 0 && c.z <= c.w;
        if (in_front) out.low = std::min(out.low, c.z / c.w);
        out.high = std::max(out.high, in_front ? c.z / c.w : INFINITY);
    }
    const double scale = 1 / determinant(v[0], v[1], v[2]);
    for (std::size_t i = 0; i < 3; ++i) {
        const ScreenVertex &a = v[(i + 1) % 3], &b = v[(i + 2) % 3];
        out.nx[i] = a.y * b.w - a.w * b.y;
        out.ny[i] = a.w * b.x - a.x * b.w;
        out.constant[i] = a.x * b.y - a.y * b.x;
        out.depth += out.constant[i] * v[i].z * scale;
        out.depth_x += out.nx[i] * v[i].z * scale;
        out.depth_y += out.ny[i] * v[i].z * scale;
    }
    return out;
}

}  // namespace

VertexRecord record_of(const ScreenVertex& v) {
    VertexRecord r;
    r.w = float(v.w);
    r.depth = float(v.z / v.w);
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z) || !std::isfinite(v.w)) {
        r.x = mark_non_finite;
        return r;
    }
    const double reach = guard_band * v.w;
    r.x = mark_unsnapped;
    if (v.w > 0 && v.z <= v.w && v.x < reach && -reach < v.x && v.y < reach && -reach < v.y) {
        r.x = std::int32_t(std::floor(v.x / v.w * subpixels + 0.5));
        r.y = std::int32_t(std::floor(v.y / v.w * subpixels + 0.5));
    }
    return r;
}

CrossingOutcome set_up_crossing(const VertexSource& source, const VertexRecord* records,
                                const std::uint32_t corners[3], CrossingTriangle& out) {
    std::array<std::uint32_t, 3> order{corners[0], corners[1], corners[2]};
    std::array<ScreenVertex, 3> v;
    bool beyond_near = false, before_far = false;
    for (std::size_t i = 0; i < 3; ++i) {
        v[i] = source.homogeneous(order[i]);
        beyond_near = beyond_near || v[i].z <= v[i].w;
        before_far = before_far || v[i].z >= 0;
    }
    if (!beyond_near || !before_far) return CrossingOutcome::outside;
    const double det = determinant(v[0], v[1], v[2]);
    if (!(det != 0)) return CrossingOutcome::degenerate;
    out.turned = det < 0;
    if (out.turned) {
        std::swap(order[1], order[2]);
        std::swap(v[1], v[2]);
    }
    if (!visible_box(v, out)) return CrossingOutcome::outside;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t a = (i + 1) % 3, b = (i + 2) % 3;
        out.edges[i] = edge_between(records[order[a]], records[order[b]], v[a], v[b]);
    }
    out.plane = plane_of(v, out);
    return CrossingOutcome::drawn;
}

CrossingWeights crossing_weights(const VertexSource& source, const VertexRecord* records,
                                 const std::uint32_t corners[3]) {
    CrossingWeights out{0, 0, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}};
    CrossingTriangle t;
    if (set_up_crossing(source, records, corners, t) != CrossingOutcome::drawn) return out;
    out.px = t.plane.px;
    out.py = t.plane.py;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t k = t.turned && i > 0 ? 3 - i : i;
        out.nx[k] = t.plane.nx[i];
        out.ny[k] = t.plane.ny[i];
        out.constant[k] = t.plane.constant[i];
    }
    return out;
}

void CrossingWeights::at(double x, double y, double out[9]) const {
    for (std::size_t k = 0; k < 3; ++k) {
        out[k] = constant[k] + (nx[k] * (x - px) + ny[k] * (y - py));
        out[3 + k] = nx[k];
        out[6 + k] = ny[k];
    }
    // Just outside, as snapping saw it: the corner nearest to inside.
    if (!(std::max({out[0], out[1], out[2]}) > 0)) {
        const std::size_t k = std::size_t(std::max_element(out, out + 3) - out);
        out[0] = out[1] = out[2] = 0;
        out[k] = 1;
    }
}

}  // namespace rast::detail
