#include "prep/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/finite.h"
#include "base/parallel.h"
#include "base/step_count.h"
#include "exact/orient2d.h"
#include "surface/corner_tree.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t polygon_grain = 16384;
// Looks at corners that one polygon may cost before the rest of it is cut as a fan: simple polygons
// of a million corners stay below it, and hopelessly self-crossing ones end within seconds.
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
        : points_(std::move(points)),
          first_corner_(first_corner),
          out_(out),
          reflex_corners_(points_) {
        const Index n = Index(points_.size());
        next_.resize(n);
        previous_.resize(n);
        for (Index i = 0; i < n; ++i) {
            next_[i] = i + 1 == n ? 0 : i + 1;
            previous_[i] = i == 0 ? n - 1 : i - 1;
        }
        reflex_.resize(n);
        spike_.resize(n);
        turns_.resize(n);
        for (Index i = 0; i < n; ++i) classify(i);
    }

    // Cutting an ear off makes or unmakes no ear but its two neighbours (Meisters 1975), so each
    // corner waits for its turn once, and again when a neighbour went.
    void run() {
        Index left = Index(points_.size()), at = 0;
        for (Index i = 0; i < left; ++i) await(i);
        bool looked_at_all = true;
        while (left > 3) {
            if (first_waiting_ < waiting_.size()) {
                const Waiting next = waiting_[first_waiting_++];
                if (turns_[next.corner] != next.turn) continue;
                // A spike encloses nothing, but hides what its neighbours enclose.
                if (!gave_up() && !spike_[next.corner] && !is_ear(next.corner)) continue;
                at = next.corner;
            } else if (!looked_at_all && !gave_up()) {  // where it touches or crosses itself
                waiting_.clear();
                first_waiting_ = 0;
                for (Index k = 0; k < left; ++k, at = next_[at]) await(at);
                looked_at_all = true;
                continue;
            } else {  // no ear at all: a flat corner loses nothing; else any
                for (Index k = 0; k < left && !gave_up() && turn(at) != 0; ++k, ++work_)
                    at = next_[at];
            }
            at = clip(at);
            --left;
            looked_at_all = false;
        }
        emit(at);
        detail::count_steps(work_);
    }

  private:
    int turn(Index i) const { return orient(previous_[i], i, next_[i]); }
    int orient(Index a, Index b, Index c) const {
        return detail::orient2d(points_[a], points_[b], points_[c]);
    }
    void classify(Index i) {
        const int sign = turn(i);
        reflex_[i] = sign <= 0;
        reflex_corners_.set_live(i, reflex_[i]);
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
    // the triangle; or both run along the triangle's own sides, with nothing of the polygon between
    // them.
    bool enters(Index r, Index a, Index b, Index c) const {
        const Index before = previous_[r], after = next_[r];
        const auto inside = [&](Index k) { return orient(b, c, k) > 0 && orient(a, b, k) > 0; };
        return inside(before) || inside(after) || (along(b, c, before) && along(b, a, after));
    }
    // Whether k lies on the ray from `from` to `to`.
    bool along(Index from, Index to, Index k) const {
        const glm::vec2 &f = points_[from], &t = points_[to], &p = points_[k];
        return p != f && orient(from, to, k) == 0 &&
               (t.x != f.x ? (t.x > f.x) == (p.x > f.x) : (t.y > f.y) == (p.y > f.y));
    }

    bool is_ear(Index i) {
        ++work_;
        if (reflex_[i]) return false;
        const Index a = previous_[i], b = i, c = next_[i];
        return !reflex_corners_.any_near(points_[a], points_[b], points_[c], work_, [&](Index r) {
            if (r == a || r == b || r == c) return false;
            // Polygons may touch themselves, or reach a hole by a bridge.
            const glm::vec2& p = points_[r];
            if (p == points_[a]) return enters(r, c, a, b);
            if (p == points_[b]) return enters(r, a, b, c);
            if (p == points_[c]) return enters(r, b, c, a);
            return orient(a, b, r) >= 0 && orient(b, c, r) >= 0 && orient(c, a, r) >= 0;
        });
    }

    bool gave_up() const { return work_ > work_limit; }
    // Behind all that wait; its earlier place counts no more.
    void await(Index i) { waiting_.push_back({i, ++turns_[i]}); }

    // Cuts corner i off; returns its next one. Both neighbours go to the end of the queue, so that
    // ears are taken from all around instead of fanning out from one corner.
    Index clip(Index i) {
        emit(i);
        const Index a = previous_[i], c = next_[i];
        next_[a] = c;
        previous_[c] = a;
        reflex_corners_.set_live(i, false);
        ++turns_[i];
        for (const Index k : {a, c}) {
            classify(k);
            await(k);
        }
        return c;
    }

    void emit(Index i) {
        *out_++ = first_corner_ + previous_[i];
        *out_++ = first_corner_ + i;
        *out_++ = first_corner_ + next_[i];
    }

    std::vector<glm::vec2> points_;
    Index first_corner_;
    Index* out_;
    std::vector<Index> next_, previous_;
    std::vector<char> reflex_, spike_;
    struct Waiting {
        Index corner, turn;
    };
    std::vector<Waiting> waiting_;  // from first_waiting_ on
    std::size_t first_waiting_ = 0;
    std::vector<Index> turns_;  // by corner: the one place in the queue that counts
    detail::CornerTree reflex_corners_;
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
        if (!detail::is_finite(p)) return false;
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
    detail::parallel_blocks(
        faces, polygon_grain, threads, [&](std::size_t first, std::size_t last) {
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
