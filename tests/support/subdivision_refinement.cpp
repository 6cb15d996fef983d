#include "subdivision_refinement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace test::subdivision {

namespace {

using Scheme = SubdivisionRules::Scheme;

struct VertexSums {  // of what is around a vertex
    Point edge_ends{}, face_points{};
    Point crease_ends{}, next_crease_ends{};  // sharp now; sharp at the next level
    std::uint32_t edges = 0, faces = 0, creases = 0, next_creases = 0;
    Real semi_sharpness = 0;  // for Chaikin's rule
    std::uint32_t semi_sharp = 0;
    Real ending_sharpness = 0;  // of what is sharp now and smooth at the next level
    std::uint32_t ending = 0;
};

Real worn(Real sharpness) {
    return sharpness >= infinite ? sharpness : std::max<Real>(0, sharpness - 1);
}

// The sharpness of the half of an edge that is at a vertex.
Real child_sharpness(Real sharpness, const VertexSums& at, bool chaikin) {
    if (chaikin && is_semi_sharp(sharpness) && at.semi_sharp > 1) {
        const Real others = (at.semi_sharpness - sharpness) / Real(at.semi_sharp - 1);
        sharpness = Real(0.75) * sharpness + Real(0.25) * others;
    }
    return worn(sharpness);
}

enum class Rule { smooth, crease, corner };
Rule rule_of(Real sharpness, std::uint32_t creases) {
    if (sharpness > 0 || creases > 2) return Rule::corner;
    return creases == 2 ? Rule::crease : Rule::smooth;
}

Point vertex_point(Rule rule, const Point& v, const VertexSums& sums, const Point& crease_ends,
                   Scheme scheme) {
    if (rule == Rule::corner) return v;
    if (rule == Rule::crease) return Real(0.75) * v + Real(0.125) * crease_ends;
    const Real n = sums.edges;
    if (scheme == Scheme::catmark)
        return (n - 2) / n * v + (sums.edge_ends + sums.face_points) / (n * n);
    const Real c = Real(0.375) + std::cos(2 * std::numbers::pi_v<Real> / n) / 4;
    const Real beta = Real(0.625) - c * c;
    return (1 - beta) * v + beta / n * sums.edge_ends;
}

// Loop's weight of each end of an edge is 3/8, of each opposite vertex 1/8. Catmull and Clark: the
// mean of ends and both face points; smoothed triangles weigh theirs more.
Point smooth_edge_point(const Level& level, const Edge& edge, const Point& around,
                        std::uint32_t faces, std::uint32_t triangles,
                        const SubdivisionRules& rules) {
    const Point ends = level.points[edge.v0] + level.points[edge.v1];
    if (rules.scheme == Scheme::loop) return Real(0.375) * ends + Real(0.125) * around;
    Real face_weight = 0.25L;
    if (rules.smooth_triangles && faces == 2)
        face_weight = (Real(triangles) * 0.470L + Real(2 - triangles) * 0.25L) / 2;
    return (0.5L - face_weight) * ends + face_weight * around;
}

class Refinement {
  public:
    Refinement(const Level& level, const SubdivisionRules& rules)
        : level_(level),
          rules_(rules),
          quads_(rules.scheme != Scheme::loop),
          face_points_(quads_ ? level.face_count() : 0),
          edge_sum_(level.all_edges.size()),
          edge_faces_(level.all_edges.size()),
          edge_triangles_(level.all_edges.size()),
          sums_(level.points.size()) {}

    Level run() {
        sum_faces();
        sum_edges();
        place_points();
        connect();
        return std::move(out_);
    }

  private:
    std::uint32_t face_vertex(std::size_t f) const { return std::uint32_t(f); }
    std::uint32_t edge_vertex(std::uint32_t e) const {
        return std::uint32_t(face_points_.size() + e);
    }
    std::uint32_t vertex_vertex(std::uint32_t v) const {
        return std::uint32_t(face_points_.size() + level_.all_edges.size() + v);
    }
    // The half at v of an edge that leaves it, or arrives there.
    std::uint32_t half_edge(std::uint32_t e, std::uint32_t v, bool leaves) const {
        const Edge& edge = level_.all_edges[e];
        return 2 * e + ((edge.v0 == edge.v1 ? leaves : edge.v0 == v) ? 0 : 1);
    }

    void sum_faces() {
        for (std::size_t f = 0; f < level_.face_count(); ++f) {
            const std::uint32_t first = level_.offsets[f], end = level_.offsets[f + 1];
            Point middle{};
            for (std::uint32_t c = first; c < end; ++c) middle += level_.points[level_.vertices[c]];
            middle /= Real(end - first);
            if (quads_) face_points_[f] = middle;
            for (std::uint32_t c = first; c < end; ++c) {
                const std::uint32_t e = level_.edges[c];
                ++edge_faces_[e];
                edge_triangles_[e] += end - first == 3;
                edge_sum_[e] +=
                    quads_
                        ? middle
                        : level_.points[level_.vertices[first + (c - first + 2) % (end - first)]];
                VertexSums& at = sums_[level_.vertices[c]];
                at.face_points += middle;
                ++at.faces;
            }
        }
    }

    void sum_edges() {
        for (const Edge& edge : level_.all_edges) {
            for (const auto& [v, other] :
                 {std::pair{edge.v0, edge.v1}, std::pair{edge.v1, edge.v0}}) {
                VertexSums& at = sums_[v];
                at.edge_ends += level_.points[other];
                ++at.edges;
                if (edge.sharpness > 0) {
                    ++at.creases;
                    at.crease_ends += level_.points[other];
                }
                if (is_semi_sharp(edge.sharpness)) {
                    ++at.semi_sharp;
                    at.semi_sharpness += edge.sharpness;
                }
            }
        }
        out_.all_edges.reserve(2 * level_.all_edges.size() + level_.vertices.size());
        for (std::size_t e = 0; e < level_.all_edges.size(); ++e) {
            const Edge& edge = level_.all_edges[e];
            for (const auto& [v, other] :
                 {std::pair{edge.v0, edge.v1}, std::pair{edge.v1, edge.v0}}) {
                VertexSums& at = sums_[v];
                const Real next = child_sharpness(edge.sharpness, at, rules_.chaikin);
                out_.all_edges.push_back({edge_vertex(std::uint32_t(e)), vertex_vertex(v), next});
                if (next > 0) {
                    ++at.next_creases;
                    at.next_crease_ends += level_.points[other];
                } else if (edge.sharpness > 0) {
                    ++at.ending;
                    at.ending_sharpness += edge.sharpness;
                }
            }
        }
    }

    void place_points() {
        out_.points = face_points_;
        for (std::size_t e = 0; e < level_.all_edges.size(); ++e) {
            const Edge& edge = level_.all_edges[e];
            const Point middle = (level_.points[edge.v0] + level_.points[edge.v1]) / Real(2);
            const bool stays_sharp = out_.all_edges[2 * e].sharpness > 0 &&
                                     out_.all_edges[2 * e + 1].sharpness > 0;  // Chaikin's
            if (rules_.scheme == Scheme::bilinear || edge.sharpness >= 1 || stays_sharp) {
                out_.points.push_back(middle);
                continue;
            }
            const Point smooth = smooth_edge_point(level_, edge, edge_sum_[e], edge_faces_[e],
                                                   edge_triangles_[e], rules_);
            out_.points.push_back((1 - edge.sharpness) * smooth + edge.sharpness * middle);
        }
        out_.sharpness.assign(out_.points.size(), 0);
        for (std::size_t v = 0; v < level_.points.size(); ++v) {
            out_.points.push_back(child_of(v));
            out_.sharpness.push_back(worn(level_.sharpness[v]));
        }
    }

    Point child_of(std::size_t v) {
        const Point& point = level_.points[v];
        if (rules_.scheme == Scheme::bilinear) return point;
        VertexSums& at = sums_[v];
        const Real sharpness = level_.sharpness[v];
        if (sharpness > 0 && worn(sharpness) == 0) {
            ++at.ending;
            at.ending_sharpness += sharpness;
        }
        const Rule now = rule_of(sharpness, at.creases);
        const Rule next = rule_of(worn(sharpness), at.next_creases);
        const Point by_now = vertex_point(now, point, at, at.crease_ends, rules_.scheme);
        if (now == next) return by_now;
        const Real weight = std::min<Real>(1, at.ending_sharpness / Real(at.ending));
        const Point by_next = vertex_point(next, point, at, at.next_crease_ends, rules_.scheme);
        return weight * by_now + (1 - weight) * by_next;
    }

    void connect() {
        const std::uint32_t first_inner = std::uint32_t(2 * level_.all_edges.size());
        for (std::size_t f = 0; f < level_.face_count(); ++f) {
            const std::uint32_t first = level_.offsets[f], n = level_.offsets[f + 1] - first;
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t c = first + i, last = first + (i + n - 1) % n;
                const std::uint32_t v = level_.vertices[c];
                const std::uint32_t out = level_.edges[c], in = level_.edges[last];
                out_.vertices.insert(out_.vertices.end(), {vertex_vertex(v), edge_vertex(out)});
                out_.edges.push_back(half_edge(out, v, true));
                if (quads_) {  // an inner edge for each corner: from its edge to the face
                    out_.vertices.insert(out_.vertices.end(), {face_vertex(f), edge_vertex(in)});
                    out_.edges.insert(out_.edges.end(), {first_inner + c, first_inner + last});
                    out_.all_edges.push_back({edge_vertex(out), face_vertex(f), 0});
                } else {  // across the corner
                    out_.vertices.push_back(edge_vertex(in));
                    out_.edges.push_back(first_inner + c);
                    out_.all_edges.push_back({edge_vertex(out), edge_vertex(in), 0});
                }
                out_.edges.push_back(half_edge(in, v, false));
                out_.offsets.push_back(std::uint32_t(out_.vertices.size()));
            }
            if (quads_) continue;
            for (std::uint32_t i = 0; i < 3; ++i) {
                out_.vertices.push_back(edge_vertex(level_.edges[first + i]));
                out_.edges.push_back(first_inner + first + (i + 1) % 3);
            }
            out_.offsets.push_back(std::uint32_t(out_.vertices.size()));
        }
    }

    const Level& level_;
    const SubdivisionRules& rules_;
    bool quads_;
    std::vector<Point> face_points_, edge_sum_;
    std::vector<std::uint32_t> edge_faces_, edge_triangles_;
    std::vector<VertexSums> sums_;
    Level out_;
};

}  // namespace

Level refine(const Level& level, const SubdivisionRules& rules) {
    return Refinement(level, rules).run();
}

Level part_of(const Level& level, std::span<const std::uint32_t> faces) {
    Level part;
    // Few vertices of few faces: sorted lists, so that the cost is that of the part.
    std::vector<std::uint32_t> vertices, edges;
    for (const std::uint32_t f : faces)
        for (std::uint32_t c = level.offsets[f]; c < level.offsets[f + 1]; ++c) {
            vertices.push_back(level.vertices[c]);
            edges.push_back(level.edges[c]);
        }
    for (auto* list : {&vertices, &edges}) {
        std::ranges::sort(*list);
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    const auto place = [](const std::vector<std::uint32_t>& list, std::uint32_t value) {
        return std::uint32_t(std::ranges::lower_bound(list, value) - list.begin());
    };
    for (const std::uint32_t v : vertices) {
        part.points.push_back(level.points[v]);
        part.sharpness.push_back(level.sharpness[v]);
    }
    for (const std::uint32_t e : edges) {
        const Edge& edge = level.all_edges[e];
        part.all_edges.push_back(
            {place(vertices, edge.v0), place(vertices, edge.v1), edge.sharpness});
    }
    for (const std::uint32_t f : faces) {
        for (std::uint32_t c = level.offsets[f]; c < level.offsets[f + 1]; ++c) {
            part.vertices.push_back(place(vertices, level.vertices[c]));
            part.edges.push_back(place(edges, level.edges[c]));
        }
        part.offsets.push_back(std::uint32_t(part.vertices.size()));
    }
    return part;
}

std::vector<std::uint32_t> faces_around(const Level& level, std::uint32_t face) {
    const std::span own(level.vertices.data() + level.offsets[face],
                        level.offsets[face + 1] - level.offsets[face]);
    std::vector<std::uint32_t> around{face};
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
        if (f == face) continue;
        for (std::uint32_t c = level.offsets[f]; c < level.offsets[f + 1]; ++c)
            if (std::ranges::find(own, level.vertices[c]) != own.end()) {
                around.push_back(f);
                break;
            }
    }
    return around;
}

}  // namespace test::subdivision
