#include "prep/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "orient2d.h"
#include "parallel.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t face_grain = 16384;
// Point-in-triangle tests that one polygon may cost before the rest of it is cut as a fan: a
// 10,000-corner polygon needs at most 10^8, and hopelessly self-crossing ones stay under a second.
constexpr std::size_t work_limit = 200'000'000;

// The polygon in the plane of its Newell normal, as exact coordinates: the axis along which the
// normal is longest is dropped, the other two kept in an order that makes the polygon run
// counter-clockwise.
std::vector<glm::vec2> project(const MeshView& mesh, Index begin, Index end) {
    glm::dvec3 normal(0.0);
    const auto at = [&](Index c) { return mesh.positions[mesh.corner_vertices[c]]; };
    const glm::dvec3 origin(at(begin));
    for (Index c = begin + 1; c + 1 < end; ++c)
        normal += glm::cross(glm::dvec3(at(c)) - origin, glm::dvec3(at(c + 1)) - origin);
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u, v);
    std::vector<glm::vec2> points(end - begin);
    for (Index c = begin; c < end; ++c) points[c - begin] = {at(c)[u], at(c)[v]};
    return points;
}

class EarClipper {
  public:
    EarClipper(std::vector<glm::vec2> points, Index first_corner, Index* out)
        : points_(std::move(points)), first_corner_(first_corner), out_(out) {
        const Index n = Index(points_.size());
        next_.resize(n);
        previous_.resize(n);
        for (Index i = 0; i < n; ++i) {
            next_[i] = i + 1 == n ? 0 : i + 1;
            previous_[i] = i == 0 ? n - 1 : i - 1;
        }
        reflex_.resize(n);
        spike_.resize(n);
        for (Index i = 0; i < n; ++i) classify(i);
        for (Index i = 0; i < n; ++i)
            if (reflex_[i]) reflex_list_.push_back(i);
    }

    void run() {
        Index left = Index(points_.size()), i = 0, failures = 0;
        while (left > 3) {
            const bool give_up = work_ > work_limit;
            // A spike encloses nothing, but hides what its neighbours enclose.
            if (give_up || spike_[i] || is_ear(i)) {
                i = clip(i);
                --left;
                failures = 0;
                continue;
            }
            i = next_[i];
            if (++failures < left) continue;
            // No proper ear: collinear or self-crossing. A flat corner loses nothing; else any.
            Index flat = i;
            for (Index k = 0; k < left && turn(flat) != 0; ++k) flat = next_[flat];
            i = clip(flat);
            --left;
            failures = 0;
        }
        emit(i);
    }

  private:
    int turn(Index i) const { return orient(previous_[i], i, next_[i]); }
    int orient(Index a, Index b, Index c) const {
        return detail::orient2d(points_[a], points_[b], points_[c]);
    }
    void classify(Index i) {
        const int sign = turn(i);
        reflex_[i] = sign <= 0;
        spike_[i] = sign == 0 && turns_back(i);
    }
    // For a corner of no turn: whether the next side runs back along the last one, or one of them
    // has no length.
    bool turns_back(Index i) const {
        const glm::vec2 &a = points_[previous_[i]], &b = points_[i], &c = points_[next_[i]];
        if (a == b || b == c) return true;
        return a.x != b.x ? (a.x < b.x) != (b.x < c.x) : (a.y < b.y) != (b.y < c.y);
    }
    // Whether a side at r, which lies where the corner b of the triangle a, b, c does, leaves into
    // the triangle.
    bool enters(Index r, Index a, Index b, Index c) const {
        const auto inside = [&](Index k) { return orient(b, c, k) > 0 && orient(a, b, k) > 0; };
        return inside(previous_[r]) || inside(next_[r]);
    }

    bool is_ear(Index i) {
        if (reflex_[i]) return false;
        const Index a = previous_[i], b = i, c = next_[i];
        const glm::vec2 low = glm::min(points_[a], glm::min(points_[b], points_[c]));
        const glm::vec2 high = glm::max(points_[a], glm::max(points_[b], points_[c]));
        for (std::size_t k = 0; k < reflex_list_.size();) {
            const Index r = reflex_list_[k];
            if (!reflex_[r]) {  // clipped or convex by now
                reflex_list_[k] = reflex_list_.back();
                reflex_list_.pop_back();
                continue;
            }
            ++k;
            ++work_;
            const glm::vec2& p = points_[r];
            if (p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y) continue;
            if (r == a || r == b || r == c) continue;
            // Polygons may touch themselves, or reach a hole by a bridge.
            if (p == points_[a] || p == points_[b] || p == points_[c]) {
                if (p == points_[a]   ? enters(r, c, a, b)
                    : p == points_[b] ? enters(r, a, b, c)
                                      : enters(r, b, c, a))
                    return false;
                continue;
            }
            if (orient(a, b, r) >= 0 && orient(b, c, r) >= 0 && orient(c, a, r) >= 0) return false;
        }
        return true;
    }

    // Cuts corner i off; returns where to look next (one further on, so that ears are taken from
    // all around instead of fanning out from one corner).
    Index clip(Index i) {
        emit(i);
        const Index a = previous_[i], c = next_[i];
        next_[a] = c;
        previous_[c] = a;
        reflex_[i] = false;
        // A reflex corner can turn convex, never the other way round in a simple polygon; in others
        // it can, and then it joins the list.
        for (const Index k : {a, c}) {
            const bool was = reflex_[k];
            classify(k);
            if (reflex_[k] && !was) reflex_list_.push_back(k);
        }
        return next_[c];
    }

    void emit(Index i) {
        *out_++ = first_corner_ + previous_[i];
        *out_++ = first_corner_ + i;
        *out_++ = first_corner_ + next_[i];
    }

    std::vector<glm::vec2> points_;
    Index first_corner_;
    Index* out_;
    std::vector<Index> next_, previous_, reflex_list_;
    std::vector<char> reflex_, spike_;
    std::size_t work_ = 0;
};

// A quad is cut along the shorter diagonal, unless that would lay a triangle outside or fold it.
void cut_quad(const MeshView& mesh, Index begin, Index* out) {
    std::array<glm::dvec3, 4> p;
    for (Index k = 0; k < 4; ++k)
        p[k] = glm::dvec3(mesh.positions[mesh.corner_vertices[begin + k]]);
    const auto area = [&](int a, int b, int c) { return glm::cross(p[b] - p[a], p[c] - p[a]); };
    const double good02 = glm::dot(area(0, 1, 2), area(0, 2, 3));
    const double good13 = glm::dot(area(0, 1, 3), area(1, 2, 3));
    const glm::dvec3 d02 = p[2] - p[0], d13 = p[3] - p[1];
    bool use02 = glm::dot(d02, d02) <= glm::dot(d13, d13);
    if (good02 > 0 && good13 <= 0) use02 = true;
    if (good13 > 0 && good02 <= 0) use02 = false;
    constexpr std::array<Index, 6> along02{0, 1, 2, 0, 2, 3}, along13{0, 1, 3, 1, 2, 3};
    for (int k = 0; k < 6; ++k) out[k] = begin + (use02 ? along02[k] : along13[k]);
}

bool all_finite(const MeshView& mesh, Index begin, Index end) {
    for (Index c = begin; c < end; ++c) {
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
    }
    return true;
}

void cut_face(const MeshView& mesh, Index begin, Index end, Index* out) {
    const Index k = end - begin;
    if (k == 3) {
        for (Index i = 0; i < 3; ++i) out[i] = begin + i;
    } else if (k == 4) {
        cut_quad(mesh, begin, out);
    } else if (all_finite(mesh, begin, end)) {
        EarClipper(project(mesh, begin, end), begin, out).run();
    } else {
        for (Index i = 0; i + 2 < k; ++i) {
            *out++ = begin;
            *out++ = begin + i + 1;
            *out++ = begin + i + 2;
        }
    }
}

}  // namespace

Triangulation triangulate(const MeshView& mesh, int threads) {
    const std::size_t faces = mesh.face_count();
    Triangulation result;
    const std::size_t triangles = mesh.corner_count() - 2 * faces;
    result.corners.resize(triangles * 3);
    result.triangle_faces.resize(triangles);
    detail::parallel_blocks(faces, face_grain, threads, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            const Index begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
            // Faces before this one gave (their corners − 2) triangles each.
            const std::size_t t = begin - 2 * f;
            cut_face(mesh, begin, end, result.corners.data() + 3 * t);
            std::fill_n(result.triangle_faces.begin() + std::ptrdiff_t(t), end - begin - 2,
                        Index(f));
        }
    });
    return result;
}

}  // namespace prep
