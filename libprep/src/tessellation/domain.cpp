#include "tessellation/domain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "prep/triangulate.h"
#include "surface/edge_key.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Whether each triangle of the fan about the mean runs the way of them all: where the polygon is
// not convex, the mean clearly on that side of each edge, for on an edge's line triangles collapse,
// and beside it heights fold them.
bool is_star_shaped(const Mesh& mesh, Index first, Index last) {
    const auto at = [&](Index c) { return glm::dvec3(mesh.positions[mesh.corner_vertices[c]]); };
    glm::dvec3 mean(0.0);
    for (Index c = first; c < last; ++c) mean += at(c) - at(first);
    mean = mean / double(last - first) + at(first);
    const auto after = [&](Index c) { return c + 1 == last ? first : c + 1; };
    const auto area = [&](Index c) { return glm::cross(at(c) - mean, at(after(c)) - mean); };
    glm::dvec3 sum(0.0);
    for (Index c = first; c < last; ++c) sum += area(c);
    const double scale = std::sqrt(glm::length(sum));  // of the polygon
    bool convex = true, clear = true;
    for (Index c = first; c < last; ++c) {
        const double on_side = glm::dot(area(c), sum);
        if (on_side < 0) return false;
        const glm::dvec3 edge = at(after(c)) - at(c), next = at(after(after(c))) - at(after(c));
        convex = convex && glm::dot(glm::cross(edge, next), sum) >= 0;
        // The mean's distance from the edge, times its length and twice the polygon's area.
        constexpr double least = 1.0 / 64;
        const double length = glm::length(edge);
        clear = clear && (length == 0 || on_side > least * scale * length * scale * scale);
    }
    return convex || clear;
}

// Triangles of one polygon with the diagonals turned that have angles of more than half a circle
// against them: Delaunay's, within its border (Lawson 1977). Cutting off corners leaves slivers,
// which heights fold.
class Cut {
  public:
    Cut(const Mesh& mesh, std::span<const Index> corners)
        : mesh_(mesh), triangles_(corners.size() / 3) {
        glm::dvec3 sum(0.0);
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) triangles_[t][k] = corners[3 * t + k];
            sum += twice_area(triangles_[t]);
        }
        const double length = glm::length(sum);
        if (length > 0) normal_ = sum / length;
        glm::length_t k = std::abs(sum.y) > std::abs(sum.x) ? 1 : 0;
        if (std::abs(sum.z) > std::abs(sum[k])) k = 2;
        axis_[k] = sum[k] < 0 ? -1 : 1;
    }

    std::vector<std::array<Index, 3>> turned() && {
        constexpr int most_passes = 16;
        for (int pass = 0; pass < most_passes && turn_all() > 0; ++pass) {
        }
        return std::move(triangles_);
    }

  private:
    struct Side {
        Index low, high;      // corners
        std::size_t t, from;  // of triangle t, from its corner `from`
    };
    glm::dvec3 at(Index corner) const {
        return glm::dvec3(mesh_.positions[mesh_.corner_vertices[corner]]);
    }
    glm::dvec3 twice_area(const std::array<Index, 3>& t) const {
        return glm::cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]));
    }
    // Squared.
    double largest_side(const std::array<Index, 3>& t) const {
        double largest = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 side = at(t[(k + 1) % 3]) - at(t[k]);
            largest = std::max(largest, glm::dot(side, side));
        }
        return largest;
    }
    // Sine and cosine of the angle at `tip`, as the polygon is seen, times lengths.
    glm::dvec2 angle(Index tip, Index from, Index to) const {
        const glm::dvec3 a = at(from) - at(tip), b = at(to) - at(tip);
        return {glm::dot(glm::cross(a, b), normal_), glm::dot(a, b)};
    }

    // A pass over the diagonals; a triangle turns once in it.
    std::size_t turn_all() {
        std::vector<Side> sides;
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const Index a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
                sides.push_back({std::min(a, b), std::max(a, b), t, k});
            }
        std::sort(sides.begin(), sides.end(), [](const Side& p, const Side& q) {
            return std::tie(p.low, p.high, p.t) < std::tie(q.low, q.high, q.t);
        });
        std::vector<bool> turned(triangles_.size(), false);
        std::size_t count = 0;
        for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
            const Side &s = sides[i], &r = sides[i + 1];
            if (s.low != r.low || s.high != r.high || turned[s.t] || turned[r.t]) continue;
            if (!turn(triangles_[s.t], s.from, triangles_[r.t], r.from)) continue;
            turned[s.t] = turned[r.t] = true;
            ++count;
        }
        return count;
    }

    // The diagonal from s[i] to s[i + 1], which is that from r[j + 1] to r[j].
    bool turn(std::array<Index, 3>& s, std::size_t i, std::array<Index, 3>& r,
              std::size_t j) const {
        const Index a = s[i], b = s[(i + 1) % 3], c = s[(i + 2) % 3], d = r[(j + 2) % 3];
        const glm::dvec2 p = angle(c, a, b), q = angle(d, b, a);
        const double size = glm::length(p) * glm::length(q);
        constexpr double rounding = 0x1p-40;
        if (!(p.x * q.y + p.y * q.x < -rounding * size)) return false;
        // Only across a strictly convex quadrilateral a, d, b, c, whether it is seen along the
        // normal or along the axis along which triangulate() does.
        const std::array<Index, 3> left{a, d, c}, right{b, c, d};
        for (const auto& triangle : {s, r, left, right})
            for (const glm::dvec3& along : {normal_, axis_})
                if (!(glm::dot(twice_area(triangle), along) > rounding * largest_side(triangle)))
                    return false;
        s = left;
        r = right;
        return true;
    }

    const Mesh& mesh_;
    std::vector<std::array<Index, 3>> triangles_;
    glm::dvec3 normal_{0.0}, axis_{0.0};  // axis: the one that the normal is nearest to
};

constexpr Index whole = no_index - 1;  // a fan that starts as one triangle

// The corner (0 or 1) of a quad from which it is halved along a diagonal; no_index where it starts
// as a fan.
Index diagonal_start(const Mesh& mesh, std::span<const DomainRoot> roots, Nearer nearer) {
    if (roots.size() != 4) return no_index;
    std::array<Index, 4> v{};
    std::array<glm::dvec3, 4> p;
    for (std::size_t k = 0; k < 4; ++k) {
        v[k] = mesh.corner_vertices[roots[k].corners[0]];
        p[k] = glm::dvec3(mesh.positions[v[k]]);
        for (std::size_t l = 0; l < k; ++l)
            if (v[l] == v[k]) return no_index;
    }
    const glm::dvec3 across = glm::cross(p[2] - p[0], p[3] - p[1]);
    const auto runs_back = [&](std::size_t tip) {
        const glm::dvec3 at = p[tip], before = p[(tip + 3) % 4], after = p[(tip + 1) % 4];
        return glm::dot(glm::cross(at - before, after - at), across) < 0;
    };
    const std::array<bool, 2> folds{runs_back(1) || runs_back(3), runs_back(0) || runs_back(2)};
    if (folds[0] != folds[1]) return folds[0] ? 1 : 0;
    if (nearer != Nearer::neither) return nearer == Nearer::first ? 0 : 1;
    const auto squared = [](const glm::dvec3& d) { return glm::dot(d, d); };
    const double first = squared(p[2] - p[0]), second = squared(p[3] - p[1]);
    if (first != second) return first < second ? 0 : 1;
    const auto least = std::min_element(v.begin(), v.end(), [&](Index a, Index b) {
        const glm::vec3 &s = mesh.positions[a], &t = mesh.positions[b];
        return std::tuple(s.x, s.y, s.z, a) < std::tuple(t.x, t.y, t.z, b);
    });
    return Index(least - v.begin()) % 2;
}

void add_fan(Domain& domain, Index face, std::span<const Index> corners) {
    const Index fan = domain.fans();
    const auto first = Index(domain.roots.size()), count = Index(corners.size());
    for (Index k = 0; k < count; ++k)
        domain.roots.push_back({face, fan, {corners[k], corners[(k + 1) % count]}});
    domain.fan_roots.push_back(first + count);
}

struct Edge {
    std::uint64_t vertices;
    Index owner;  // a root, or of a diagonal a fan
};

Edge edge_of(Index a, Index b, Index owner) {
    return {edge_key(a, b), owner};
}

void sort_edges(std::vector<Edge>& edges) {
    std::sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) {
        return p.vertices != q.vertices ? p.vertices < q.vertices : p.owner < q.owner;
    });
}

class FirstTriangles {
  public:
    FirstTriangles(const Domain& domain, const Mesh& mesh, std::span<const Nearer> nearer)
        : domain_(domain), mesh_(mesh), starts_(domain.fans()) {
        const std::span<const DomainRoot> roots(domain.roots);
        for (Index fan = 0; fan < domain.fans(); ++fan) {
            const Index first = domain.fan_roots[fan], count = domain.fan_roots[fan + 1] - first;
            starts_[fan] =
                count == 3 ? whole : diagonal_start(mesh, roots.subspan(first, count), nearer[fan]);
        }
    }

    DomainStart make() {
        for (Index r = 0; r < domain_.roots.size(); ++r) {
            const Index a = vertex(r, 0), b = vertex(r, 1);
            if (a != b) edges_.push_back(edge_of(a, b, r));
        }
        sort_edges(edges_);
        open_where_diagonals_meet();
        half_edges_.resize(domain_.roots.size());
        for (Index fan = 0; fan < domain_.fans(); ++fan) add(fan);
        for (std::size_t begin = 0, end = 0; begin < edges_.size(); begin = end) {
            while (end < edges_.size() && edges_[end].vertices == edges_[begin].vertices) ++end;
            for (std::size_t k = begin; k < end; ++k)
                link(half_edges_[edges_[k].owner],
                     half_edges_[edges_[k + 1 == end ? begin : k + 1].owner]);
        }
        return std::move(start_);
    }

  private:
    Index vertex(Index root, std::size_t k) const {
        return mesh_.corner_vertices[domain_.roots[root].corners[k]];
    }
    void link(Index half_edge, Index next) {
        start_.triangles[half_edge / 3].next[half_edge % 3] = next;
    }

    void open_where_diagonals_meet() {
        std::vector<Edge> diagonals;
        for (Index fan = 0; fan < domain_.fans(); ++fan) {
            if (starts_[fan] == no_index || starts_[fan] == whole) continue;
            const Index r = domain_.fan_roots[fan] + starts_[fan];
            diagonals.push_back(edge_of(vertex(r, 0), vertex(r + 1, 1), fan));
        }
        sort_edges(diagonals);
        auto edge = edges_.begin();
        for (std::size_t begin = 0, end = 0; begin < diagonals.size(); begin = end) {
            const std::uint64_t vertices = diagonals[begin].vertices;
            while (end < diagonals.size() && diagonals[end].vertices == vertices) ++end;
            while (edge != edges_.end() && edge->vertices < vertices) ++edge;
            const bool is_edge = edge != edges_.end() && edge->vertices == vertices;
            if (end - begin == 1 && !is_edge) continue;
            for (std::size_t k = begin; k < end; ++k) starts_[diagonals[k].owner] = no_index;
        }
    }

    void add(Index fan) {
        if (starts_[fan] == no_index) return add_open(fan);
        if (starts_[fan] != whole) return add_pairs(fan);
        const Index t = Index(start_.triangles.size()), r = domain_.fan_roots[fan];
        start_.triangles.push_back({{vertex(r, 0), vertex(r + 1, 0), vertex(r + 2, 0)},
                                    {3 * t, 3 * t + 1, 3 * t + 2},
                                    r,
                                    r + 1,
                                    true});
        for (Index k = 0; k < 3; ++k) half_edges_[r + k] = 3 * t + k;
    }

    void add_open(Index fan) {
        const Index centre = domain_.cage_vertices + Index(start_.centres.size());
        start_.centres.push_back(fan);
        const Index first = domain_.fan_roots[fan], last = domain_.fan_roots[fan + 1];
        const auto shift = Index(start_.triangles.size()) - first;
        for (Index r = first; r < last; ++r) {
            const Index before = r == first ? last - 1 : r - 1;
            // b – centre is the next root's centre – a.
            const Index t = r + shift;
            start_.triangles.push_back(
                {{vertex(r, 0), vertex(r, 1), centre},
                 {3 * t, 3 * (domain_.next_root(r) + shift) + 2, 3 * (before + shift) + 1},
                 r,
                 r});
            half_edges_[r] = 3 * t;
        }
    }

    void add_pairs(Index fan) {
        const auto t = Index(start_.triangles.size());
        Index root = domain_.fan_roots[fan] + starts_[fan];
        for (const Index half : {t, t + 1}) {
            const Index next = domain_.next_root(root);
            start_.triangles.push_back({{vertex(next, 1), vertex(root, 0), vertex(root, 1)},
                                        {3 * (half == t ? t + 1 : t), 3 * half + 1, 3 * half + 2},
                                        root,
                                        next});
            half_edges_[root] = 3 * half + 1;
            half_edges_[next] = 3 * half + 2;
            root = domain_.next_root(next);
        }
    }

    const Domain& domain_;
    const Mesh& mesh_;
    DomainStart start_;
    std::vector<Index> starts_;      // diagonal_start() per fan, or `whole`
    std::vector<Edge> edges_;        // of the cage
    std::vector<Index> half_edges_;  // per root: where its ab is
};

}  // namespace

Domain make_domain(const Mesh& mesh, const std::vector<std::uint8_t>& left_out, bool straight,
                   int threads) {
    Domain domain;
    domain.cage_vertices = Index(mesh.vertex_count());
    std::optional<Triangulation> cut;
    Index triangle = 0;
    std::vector<Index> corners;
    for (Index f = 0; f < mesh.face_count(); ++f) {
        if (!left_out.empty() && left_out[f]) continue;
        const Index first = mesh.face_offsets[f], last = mesh.face_offsets[f + 1];
        if (straight && last - first > 3 && !is_star_shaped(mesh, first, last)) {
            if (!cut) cut = triangulate(MeshView(mesh), threads);
            while (cut->triangle_faces[triangle] != f) ++triangle;
            const Index begin = triangle;
            while (triangle < cut->triangle_faces.size() && cut->triangle_faces[triangle] == f)
                ++triangle;
            const auto own =
                std::span(cut->corners).subspan(3 * begin, 3 * std::size_t(triangle - begin));
            for (const auto& of_fan : Cut(mesh, own).turned()) add_fan(domain, f, of_fan);
            continue;
        }
        corners.clear();
        for (Index c = first; c < last; ++c) corners.push_back(c);
        add_fan(domain, f, corners);
    }
    return domain;
}

DomainStart make_start(const Domain& domain, const Mesh& mesh, std::span<const Nearer> nearer) {
    return FirstTriangles(domain, mesh, nearer).make();
}

}  // namespace prep::detail
