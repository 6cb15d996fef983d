#include "cost/oracles/fitted_normals.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cost {
namespace {

constexpr std::size_t terms = 10;  // of a cubic in two variables
constexpr std::size_t least_points = 16;

Vector cross_of(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real dot_of(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Real length_of(const Vector& v) {
    return std::sqrt(dot_of(v, v));
}

// Which faces meet at each vertex.
struct Corners {
    std::vector<std::size_t> first;
    std::vector<std::uint32_t> faces;
};
Corners corners_of(std::size_t vertices, std::span<const std::uint32_t> corner_vertices) {
    Corners c;
    c.first.assign(vertices + 1, 0);
    for (const std::uint32_t v : corner_vertices) ++c.first[v + 1];
    for (std::size_t v = 0; v < vertices; ++v) c.first[v + 1] += c.first[v];
    c.faces.resize(corner_vertices.size());
    std::vector<std::size_t> next(c.first.begin(), c.first.end() - 1);
    for (std::size_t i = 0; i < corner_vertices.size(); ++i)
        c.faces[next[corner_vertices[i]]++] = std::uint32_t(i / 3);
    return c;
}

class Fit {
  public:
    Fit(std::span<const glm::vec3> positions, std::span<const std::uint32_t> corner_vertices)
        : positions_(positions),
          corner_vertices_(corner_vertices),
          corners_(corners_of(positions.size(), corner_vertices)),
          seen_(positions.size(), 0) {}

    FittedNormal at(std::uint32_t vertex, int rings) {
        FittedNormal out;
        Vector side(0);
        if (!disc(vertex, side)) return out;
        gather(vertex, rings);
        if (points_.size() < least_points || !(length_of(side) > 0)) return out;
        Vector normal = side / length_of(side);
        for (int pass = 0; pass < 2; ++pass)
            if (!fit(normal, out.misfit)) return out;
        out.normal = dot_of(normal, side) < 0 ? normal * Real(-1) : normal;
        out.known = true;
        return out;
    }

  private:
    // Whether faces lie around the vertex once and close; the sum of their area vectors.
    bool disc(std::uint32_t vertex, Vector& side) const {
        std::vector<std::array<std::uint32_t, 2>> spokes;  // from, to: the edge opposite
        for (std::size_t i = corners_.first[vertex]; i < corners_.first[vertex + 1]; ++i) {
            const std::size_t f = 3 * std::size_t(corners_.faces[i]);
            for (std::size_t k = 0; k < 3; ++k) {
                if (corner_vertices_[f + k] != vertex) continue;
                const std::uint32_t a = corner_vertices_[f + (k + 1) % 3],
                                    b = corner_vertices_[f + (k + 2) % 3];
                if (a == b || a == vertex || b == vertex) return false;
                spokes.push_back({a, b});
                const Vector p(positions_[vertex]);
                side += cross_of(Vector(positions_[a]) - p, Vector(positions_[b]) - p);
            }
        }
        if (spokes.size() < 3) return false;
        std::uint32_t at = spokes[0][0];
        for (std::size_t step = 0; step < spokes.size(); ++step) {
            std::size_t next = spokes.size();
            for (std::size_t i = 0; i < spokes.size(); ++i) {
                if (spokes[i][0] != at) continue;
                if (next != spokes.size()) return false;  // two faces leave on one spoke
                next = i;
            }
            if (next == spokes.size()) return false;
            at = spokes[next][1];
            if (at == spokes[0][0]) return step + 1 == spokes.size();
        }
        return false;
    }

    void gather(std::uint32_t vertex, int rings) {
        points_.clear();
        ++mark_;
        std::vector<std::uint32_t> ring = {vertex}, next;
        seen_[vertex] = mark_;
        const Vector origin(positions_[vertex]);
        points_.push_back(Vector(0));
        for (int r = 0; r < rings; ++r) {
            next.clear();
            for (const std::uint32_t v : ring)
                for (std::size_t i = corners_.first[v]; i < corners_.first[v + 1]; ++i)
                    for (std::size_t k = 0; k < 3; ++k) {
                        const std::uint32_t w =
                            corner_vertices_[3 * std::size_t(corners_.faces[i]) + k];
                        if (seen_[w] == mark_) continue;
                        seen_[w] = mark_;
                        next.push_back(w);
                        points_.push_back(Vector(positions_[w]) - origin);
                    }
            ring.swap(next);
        }
        radius_ = 0;
        for (const Vector& p : points_) radius_ = std::max(radius_, length_of(p));
    }

    // The cubic above the plane across `normal`, and its own normal at the vertex.
    bool fit(Vector& normal, double& misfit) const {
        if (!(radius_ > 0) || !std::isfinite(radius_)) return false;
        const Vector axis = std::abs(normal.x) < Real(0.6) ? Vector(1, 0, 0) : Vector(0, 1, 0);
        Vector u = cross_of(normal, axis);
        u /= length_of(u);
        const Vector v = cross_of(normal, u);
        const auto row = [&](const Vector& p, std::array<Real, terms>& out) {
            const Real x = dot_of(p, u) / radius_, y = dot_of(p, v) / radius_;
            out = {1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y};
            return dot_of(p, normal) / radius_;
        };
        std::array<std::array<Real, terms + 1>, terms> m{};
        std::array<Real, terms> r{};
        for (const Vector& p : points_) {
            const Real z = row(p, r);
            for (std::size_t i = 0; i < terms; ++i) {
                for (std::size_t j = 0; j < terms; ++j) m[i][j] += r[i] * r[j];
                m[i][terms] += r[i] * z;
            }
        }
        std::array<Real, terms> c{};
        if (!solved(m, c)) return false;
        Real squares = 0;
        for (const Vector& p : points_) {
            Real z = row(p, r);
            for (std::size_t i = 0; i < terms; ++i) z -= c[i] * r[i];
            squares += z * z;
        }
        misfit = double(std::sqrt(squares / Real(points_.size())));
        normal = normal - u * c[1] - v * c[2];
        normal /= length_of(normal);
        return true;
    }

    // Gauss's elimination, the largest of each column first.
    static bool solved(std::array<std::array<Real, terms + 1>, terms>& m,
                       std::array<Real, terms>& out) {
        for (std::size_t k = 0; k < terms; ++k) {
            std::size_t best = k;
            for (std::size_t i = k + 1; i < terms; ++i)
                if (std::abs(m[i][k]) > std::abs(m[best][k])) best = i;
            // Points on a conic or two say nothing of a cubic: what is left is rounding.
            if (!(std::abs(m[best][k]) > Real(1e-9))) return false;
            std::swap(m[k], m[best]);
            for (std::size_t i = k + 1; i < terms; ++i) {
                const Real factor = m[i][k] / m[k][k];
                for (std::size_t j = k; j <= terms; ++j) m[i][j] -= factor * m[k][j];
            }
        }
        for (std::size_t k = terms; k-- > 0;) {
            Real sum = m[k][terms];
            for (std::size_t j = k + 1; j < terms; ++j) sum -= m[k][j] * out[j];
            out[k] = sum / m[k][k];
        }
        return true;
    }

    std::span<const glm::vec3> positions_;
    std::span<const std::uint32_t> corner_vertices_;
    Corners corners_;
    std::vector<std::uint32_t> seen_;
    std::uint32_t mark_ = 0;
    std::vector<Vector> points_;  // about the vertex, itself first
    Real radius_ = 0;
};

}  // namespace

std::vector<FittedNormal> fitted_normals(std::span<const glm::vec3> positions,
                                         std::span<const std::uint32_t> corner_vertices,
                                         std::span<const std::uint32_t> vertices, int rings) {
    Fit fit(positions, corner_vertices);
    std::vector<FittedNormal> out;
    out.reserve(vertices.size());
    for (const std::uint32_t v : vertices) out.push_back(fit.at(v, rings));
    return out;
}

}  // namespace cost
