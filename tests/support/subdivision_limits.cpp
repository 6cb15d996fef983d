// Limit positions and tangents of a vertex (Halstead, Kass & DeRose 1993; Biermann, Levin & Zorin
// 2000).
#include <cmath>
#include <map>
#include <numbers>

#include "subdivision_refinement.h"

namespace test::subdivision {

namespace {

using Scheme = SubdivisionRules::Scheme;
using Limit = SubdivisionOracle::Limit;
constexpr Real pi = std::numbers::pi_v<Real>;

// What is around a vertex, counter-clockwise from a face: edges 0 … n, of which n is 0 again where
// the faces go round; face i is between edges i and i + 1.
struct Ring {
    Point vertex{};
    std::vector<Point> edges;      // their other ends
    std::vector<Point> diagonals;  // of each quad
    std::vector<Real> sharpness;   // of the edges
    std::size_t asked = 0;         // the face that the ring was asked for
    bool closed = false;
    std::size_t face_count() const { return diagonals.size(); }
};

struct Corner {
    std::uint32_t face, corner;
};

class RingWalk {
  public:
    RingWalk(const Level& level, std::uint32_t vertex) : level_(level) {
        for (std::uint32_t f = 0; f < level.face_count(); ++f)
            for (std::uint32_t c = level.offsets[f]; c < level.offsets[f + 1]; ++c)
                if (level.vertices[c] == vertex) at_.push_back({f, c - level.offsets[f]});
    }

    // Up to sharp edges, or all around.
    Ring walk(Corner start, bool through_sharp) const {
        std::vector<Corner> corners{start};
        bool closed = false;
        for (const Corner* next = &start; corners.size() <= at_.size();) {
            next = across(in_edge(*next), *next, through_sharp);
            if (!next) break;
            if (next->face == start.face && next->corner == start.corner) {
                closed = true;
                break;
            }
            corners.push_back(*next);
        }
        std::size_t before = 0;
        if (!closed)
            for (const Corner* last = &start; corners.size() <= at_.size(); ++before) {
                last = across(out_edge(*last), *last, through_sharp);
                if (!last) break;
                corners.insert(corners.begin(), *last);
            }
        Ring ring;
        ring.closed = closed;
        ring.asked = before;
        const std::uint32_t v = vertex_of(start, 0);
        ring.vertex = level_.points[v];
        for (const Corner& corner : corners) {
            ring.edges.push_back(level_.points[vertex_of(corner, 1)]);
            ring.diagonals.push_back(level_.points[vertex_of(corner, 2)]);
            ring.sharpness.push_back(level_.all_edges[out_edge(corner)].sharpness);
        }
        ring.edges.push_back(level_.points[vertex_of(corners.back(), -1)]);
        ring.sharpness.push_back(level_.all_edges[in_edge(corners.back())].sharpness);
        return ring;
    }

  private:
    std::uint32_t slot(const Corner& c, int step) const {
        const std::uint32_t n = level_.offsets[c.face + 1] - level_.offsets[c.face];
        return level_.offsets[c.face] + (c.corner + std::uint32_t(step + int(n))) % n;
    }
    std::uint32_t vertex_of(const Corner& c, int step) const {
        return level_.vertices[slot(c, step)];
    }
    std::uint32_t out_edge(const Corner& c) const { return level_.edges[slot(c, 0)]; }
    std::uint32_t in_edge(const Corner& c) const { return level_.edges[slot(c, -1)]; }
    const Corner* across(std::uint32_t edge, const Corner& from, bool through_sharp) const {
        if (!through_sharp && level_.all_edges[edge].sharpness > 0) return nullptr;
        for (const Corner& other : at_)
            if ((other.face != from.face || other.corner != from.corner) &&
                (out_edge(other) == edge || in_edge(other) == edge))
                return &other;
        return nullptr;
    }

    const Level& level_;
    std::vector<Corner> at_;
};

// Weights of a ring's points: vertex, edges 0 …, diagonals 0 ….
struct Weights {
    Real vertex = 0;
    std::vector<Real> edges, diagonals;
};
Point apply(const Weights& weights, const Ring& ring) {
    Point sum = weights.vertex * ring.vertex;
    for (std::size_t i = 0; i < weights.edges.size(); ++i) sum += weights.edges[i] * ring.edges[i];
    for (std::size_t i = 0; i < weights.diagonals.size(); ++i)
        sum += weights.diagonals[i] * ring.diagonals[i];
    return sum;
}

Real loop_beta(std::size_t n) {
    const Real c = Real(0.375) + std::cos(2 * pi / Real(n)) / 4;
    return Real(0.625) - c * c;
}

Point smooth_position(const Ring& ring, Scheme scheme) {
    const std::size_t n = ring.face_count();
    const Real count = Real(n);
    Point edges{}, diagonals{};
    for (std::size_t i = 0; i < n; ++i) edges += ring.edges[i], diagonals += ring.diagonals[i];
    if (scheme == Scheme::catmark)
        return (count * count * ring.vertex + Real(4) * edges + diagonals) / (count * (count + 5));
    const Real beta = loop_beta(n);
    return (Real(0.375) * ring.vertex + beta / count * edges) / (Real(0.375) + beta);
}

// Towards edge `first` and a quarter turn further, in the ring's own plane.
std::array<Weights, 2> smooth_tangents(std::size_t n, std::size_t first, Scheme scheme) {
    std::array<Weights, 2> out;
    const Real step = 2 * pi / Real(n), c = std::cos(step);
    const Real a = 1 + c + std::cos(pi / Real(n)) * std::sqrt(2 * (9 + c));
    for (int t = 0; t < 2; ++t) {
        const auto wave = [&](std::size_t i) {
            const Real angle = step * (Real(i) - Real(first));
            return t == 0 ? std::cos(angle) : std::sin(angle);
        };
        for (std::size_t i = 0; i < n; ++i) {
            out[std::size_t(t)].edges.push_back((scheme == Scheme::catmark ? a : 1) * wave(i));
            if (scheme == Scheme::catmark)
                out[std::size_t(t)].diagonals.push_back(wave(i) + wave(i + 1));
        }
    }
    return out;
}

// From a crease into its k faces: the left eigenvector of the sector's matrix. Within, it is half a
// sine wave; what the crease's own points weigh follows from the columns of the matrix. (Biermann
// et al. give masks for rules of Loop's scheme that they changed beside creases.)
Weights across_crease(std::size_t k, Scheme scheme) {
    const bool catmark = scheme == Scheme::catmark;
    const Real theta = pi / Real(k), c = std::cos(theta);
    const Real eigenvalue =
        catmark ? (5 + c + std::sqrt((9 + c) * (1 + c))) / 16 : Real(0.375) + c / 4;
    Weights w;
    w.edges.resize(k + 1);
    for (std::size_t i = 1; i < k; ++i) w.edges[i] = std::sin(Real(i) * theta);
    // Column of a crease end: w_v/8 + own = (λ - 1/2) w_0, of which own is w_1/16 + d_0/4, or w_1/8
    // for Loop; of the vertex: 3/4 w_v + w_0 + within = λ w_v, within 3/8 Σ w_i + 1/4 Σ d_i.
    Real own = w.edges[1] / (catmark ? 16 : 8), within = 0;
    for (const Real& edge : w.edges) within += Real(0.375) * edge;
    for (std::size_t i = 0; catmark && i < k; ++i) {
        w.diagonals.push_back((w.edges[i] + w.edges[i + 1]) / (16 * eigenvalue - 4));
        within += w.diagonals[i] / 4;
    }
    if (catmark) own += w.diagonals[0] / 4;
    const Real off = eigenvalue - Real(0.5);
    if (k == (catmark ? 2U : 3U)) {  // there λ is 1/2
        w.vertex = -8 * own;
        w.edges[0] = w.vertex * (eigenvalue - Real(0.75)) - within;
    } else {
        // w_0 = (w_v/8 + own) / off, put into the vertex' column.
        w.vertex = (within + own / off) / (eigenvalue - Real(0.75) - 1 / (8 * off));
        w.edges[0] = (w.vertex / 8 + own) / off;
    }
    w.edges[k] = w.edges[0];
    return w;
}

// A crease that ends: its edge keeps the crease's rule, so the smooth masks do not hold. The left
// eigenvectors of the ring's matrix, by iteration: edge 0 is the crease.
struct DartMasks {
    Weights position, tangents[2];
};
class DartIteration {
  public:
    DartIteration(std::size_t n, Scheme scheme) : n_(n), size_(1 + 2 * n), scheme_(scheme) {}
    DartMasks run() {
        fill();
        std::array<std::vector<Real>, 3> vectors;
        for (std::size_t k = 0; k < 3; ++k) {
            vectors[k].resize(size_);
            for (std::size_t i = 0; i < size_; ++i)
                vectors[k][i] = k == 0 ? 1 : std::cos(Real((i + 1) * (3 * k + 1)));
        }
        for (int step = 0; step < 600; ++step)
            for (std::size_t k = 0; k < 3; ++k) {
                vectors[k] = transposed_times(vectors[k]);
                for (std::size_t j = 0; j < k; ++j) remove(vectors[k], vectors[j]);
                normalise(vectors[k]);
            }
        // The span is what iterates to the left eigenvectors' span; tangents must not see
        // constants.
        DartMasks masks{weights(vectors[0]), {}};
        const Real total = sum(vectors[0]);
        for (auto* list : {&masks.position.edges, &masks.position.diagonals})
            for (Real& w : *list) w /= total;
        masks.position.vertex /= total;
        for (std::size_t k = 1; k < 3; ++k) {
            const Real own = sum(vectors[k]) / total;
            for (std::size_t i = 0; i < size_; ++i) vectors[k][i] -= own * vectors[0][i];
            masks.tangents[k - 1] = weights(vectors[k]);
        }
        return masks;
    }

  private:
    Real& at(std::size_t row, std::size_t column) { return matrix_[row * size_ + column]; }
    std::size_t edge(std::size_t i) const { return 1 + i % n_; }
    std::size_t diagonal(std::size_t i) const { return 1 + n_ + i % n_; }
    void fill() {
        matrix_.assign(size_ * size_, 0);
        const Real n = Real(n_);
        if (scheme_ == Scheme::loop) {
            const Real beta = loop_beta(n_);
            at(0, 0) = 1 - beta;
            for (std::size_t i = 0; i < n_; ++i) {
                at(0, edge(i)) = beta / n;
                at(edge(i), 0) = at(edge(i), edge(i)) = Real(0.375);
                at(edge(i), edge(i + 1)) += Real(0.125);
                at(edge(i), edge(i + n_ - 1)) += Real(0.125);
            }
        } else {
            at(0, 0) = (n - 2) / n;
            for (std::size_t i = 0; i < n_; ++i) {
                // Face i's point.
                const std::array<std::size_t, 4> face{0, edge(i), edge(i + 1), diagonal(i)};
                at(0, edge(i)) += 1 / (n * n);
                for (const std::size_t p : face) {
                    at(0, p) += 1 / (4 * n * n);
                    at(diagonal(i), p) += Real(0.25);
                    at(edge(i), p) += Real(0.0625);
                    at(edge(i + 1), p) += Real(0.0625);
                }
                at(edge(i), 0) += Real(0.25);
                at(edge(i), edge(i)) += Real(0.25);
            }
        }
        for (std::size_t c = 0; c < size_; ++c) at(edge(0), c) = 0;
        at(edge(0), 0) = at(edge(0), edge(0)) = Real(0.5);
    }
    std::vector<Real> transposed_times(const std::vector<Real>& x) {
        std::vector<Real> y(size_);
        for (std::size_t r = 0; r < size_; ++r)
            for (std::size_t c = 0; c < size_; ++c) y[c] += at(r, c) * x[r];
        return y;
    }
    static Real dot(const std::vector<Real>& a, const std::vector<Real>& b) {
        Real s = 0;
        for (std::size_t i = 0; i < a.size(); ++i) s += a[i] * b[i];
        return s;
    }
    static Real sum(const std::vector<Real>& a) {
        Real s = 0;
        for (const Real x : a) s += x;
        return s;
    }
    static void normalise(std::vector<Real>& a) {
        const Real length = std::sqrt(dot(a, a));
        for (Real& x : a) x /= length;
    }
    static void remove(std::vector<Real>& a, const std::vector<Real>& b) {
        const Real d = dot(a, b);
        for (std::size_t i = 0; i < a.size(); ++i) a[i] -= d * b[i];
    }
    Weights weights(const std::vector<Real>& x) const {
        Weights w{x[0], {}, {}};
        w.edges.assign(x.begin() + 1, x.begin() + 1 + std::ptrdiff_t(n_));
        w.diagonals.assign(x.begin() + 1 + std::ptrdiff_t(n_), x.end());
        return w;
    }

    std::size_t n_, size_;
    Scheme scheme_;
    std::vector<Real> matrix_;
};

const DartMasks& dart_masks(std::size_t n, Scheme scheme) {
    static std::map<std::pair<std::size_t, Scheme>, DartMasks> known;
    const auto [found, is_new] = known.try_emplace({n, scheme});
    if (is_new) found->second = DartIteration(n, scheme).run();
    return found->second;
}

void set_normal(Limit& limit, const Point& a, const Point& b) {
    const Point n = glm::cross(a, b);
    const Real length = std::sqrt(glm::dot(n, n));
    const Real lengths[] = {std::sqrt(glm::dot(a, a)), std::sqrt(glm::dot(b, b))};
    // Parallel, or nothing but rounding (1e-19 of the position).
    const Real noise = 1e-12L * std::sqrt(glm::dot(limit.position, limit.position));
    if (!(length > lengths[0] * lengths[1] * 1e-6L)) return;
    if (!(lengths[0] > noise && lengths[1] > noise)) return;
    limit.normal = n / length;
    limit.has_normal = true;
}

void smooth_limit(const Ring& ring, Scheme scheme, Limit& limit) {
    const std::size_t n = ring.face_count();
    limit.position = smooth_position(ring, scheme);
    if (n < 3) return;  // valence 2: both tangents' eigenvalues are not the largest
    const auto masks = smooth_tangents(n, ring.asked, scheme);
    const Point a = apply(masks[0], ring), b = apply(masks[1], ring);
    set_normal(limit, a, b);
    const bool catmark = scheme == Scheme::catmark;
    if (n != (catmark ? 4U : 6U)) return;
    // Of a bicubic B-spline, and of the box spline: masks of derivatives are these, scaled.
    limit.has_derivatives = true;
    if (catmark) {
        limit.du = a / Real(12);  // a = 4, so 4 (e0 - e2) + …: over 12 and the spline's 1/2
        limit.dv = b / Real(12);
    } else {
        const auto turned = smooth_tangents(n, ring.asked + 1, scheme);
        limit.du = a / Real(3);
        limit.dv = apply(turned[0], ring) / Real(3);
    }
}

void dart_limit(Ring ring, Scheme scheme, Limit& limit) {
    const std::size_t n = ring.face_count();
    std::size_t crease = 0;
    while (crease < n && !(ring.sharpness[crease] > 0)) ++crease;
    Ring turned = ring;
    turned.edges.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        turned.edges[i] = ring.edges[(i + crease) % n];
        turned.diagonals[i] = ring.diagonals[(i + crease) % n];
    }
    const DartMasks& masks = dart_masks(n, scheme);
    limit.position = apply(masks.position, turned);
    if (n < 3) return;
    set_normal(limit, apply(masks.tangents[0], turned), apply(masks.tangents[1], turned));
    if (!limit.has_normal) return;
    // The span's order is arbitrary: the side is that of a mesh whose ring is flat.
    Ring flat = turned;
    flat.vertex = {};
    for (std::size_t i = 0; i < n; ++i) {
        const Real angle = 2 * pi * Real(i) / Real(n), half = angle + pi / Real(n);
        flat.edges[i] = {std::cos(angle), std::sin(angle), 0};
        flat.diagonals[i] = {Real(1.4) * std::cos(half), Real(1.4) * std::sin(half), 0};
    }
    Limit side;
    set_normal(side, apply(masks.tangents[0], flat), apply(masks.tangents[1], flat));
    if (side.normal.z < 0) limit.normal = -limit.normal;
}

void crease_limit(const Ring& ring, Scheme scheme, Limit& limit) {
    const std::size_t k = ring.face_count();
    const Point &first = ring.edges.front(), &last = ring.edges.back();
    limit.position = Real(2) / 3 * ring.vertex + (first + last) / Real(6);
    const Point along = (first - last) / Real(2);
    const bool catmark = scheme == Scheme::catmark;
    // The second half wave must shrink faster than the crease's 1/2.
    if (k < 2) return;  // parallel
    if (k > (catmark ? 3U : 5U)) return;
    const Point across = apply(across_crease(k, scheme), ring);
    set_normal(limit, along, across);
    if (catmark ? k != 2 : k != 3) return;
    limit.has_derivatives = true;
    if (catmark) {
        const Point inwards = (ring.diagonals[0] + Real(4) * ring.edges[1] + ring.diagonals[1] -
                               first - Real(4) * ring.vertex - last) /
                              Real(6);
        limit.du = ring.asked == 0 ? along : inwards;
        limit.dv = ring.asked == 0 ? inwards : -along;
    } else {
        // Towards edge 1 and 2 of a crease from edge 0 to edge 3: halves of the crease and the
        // box spline's derivative across, with ghosts that continue the surface (natural spline).
        const Point across_unit =
            (ring.edges[1] + ring.edges[2] - ring.vertex - (first + last) / Real(2)) / Real(2);
        const std::array<Point, 4> directions{along, across_unit + along / Real(2),
                                              across_unit - along / Real(2), -along};
        limit.du = directions[ring.asked];
        limit.dv = directions[ring.asked + 1];
    }
}

void corner_limit(const Ring& ring, Limit& limit) {
    limit.position = ring.vertex;
    if (ring.closed || ring.face_count() != 1) return;
    limit.du = ring.edges[0] - ring.vertex;
    limit.dv = ring.edges[1] - ring.vertex;
    limit.has_derivatives = true;
    set_normal(limit, limit.du, limit.dv);
}

}  // namespace

Limit limit_at(const Level& level, const SubdivisionRules& rules, std::uint32_t face,
               std::uint32_t corner) {
    const std::uint32_t v = level.vertices[level.offsets[face] + corner];
    Limit limit;
    const RingWalk walk(level, v);
    if (rules.scheme == Scheme::bilinear) {
        // Each quad by itself; its four corners need not be in one plane.
        const std::uint32_t* at = level.vertices.data() + level.offsets[face];
        limit.position = level.points[v];
        limit.du = level.points[at[(corner + 1) % 4]] - limit.position;
        limit.dv = level.points[at[(corner + 3) % 4]] - limit.position;
        limit.has_derivatives = true;
        limit.valence = 1;
        set_normal(limit, limit.du, limit.dv);
        return limit;
    }
    std::uint32_t creases = 0;
    for (const Edge& edge : level.all_edges)
        creases += edge.sharpness > 0 && (edge.v0 == v || edge.v1 == v);
    const bool corner_rule = level.sharpness[v] > 0 || creases > 2;
    const Ring ring = walk.walk({face, corner}, !corner_rule && creases < 2);
    limit.valence = std::uint32_t(ring.face_count());
    if (corner_rule)
        corner_limit(ring, limit);
    else if (creases == 2)
        crease_limit(ring, rules.scheme, limit);
    else if (creases == 1)
        dart_limit(ring, rules.scheme, limit);
    else
        smooth_limit(ring, rules.scheme, limit);
    return limit;
}

}  // namespace test::subdivision
