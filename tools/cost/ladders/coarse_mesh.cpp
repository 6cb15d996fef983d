#include "cost/ladders/coarse_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>

namespace cost {
namespace {

using Face = std::array<std::uint32_t, 3>;

// The sine of the smallest angle that triangles may have, and the cosine of how far one may turn
// from its surroundings.
constexpr double least_sine = 0.15, least_cosine = 0.5;

class Collapses {
  public:
    Collapses(const std::vector<glm::vec3>& positions, std::vector<Face> faces)
        : positions_(positions), faces_(std::move(faces)), at_(positions.size()) {
        for (std::uint32_t f = 0; f < faces_.size(); ++f)
            for (const std::uint32_t v : faces_[f]) at_[v].push_back(f);
        for (const auto& faces_of : at_) left_ += !faces_of.empty();
    }

    void run(std::size_t wanted) {
        std::vector<std::uint32_t> order(positions_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::mt19937_64 random(1996);
        for (std::size_t i = order.size(); i > 1; --i)
            std::swap(order[i - 1], order[std::size_t(random() % i)]);
        std::vector<bool> touched;
        for (;;) {
            const std::size_t before = left_;
            touched.assign(positions_.size(), false);
            for (const std::uint32_t v : order)
                if (left_ > wanted && !touched[v]) remove(v, touched);
            if (left_ <= wanted || before - left_ < before / 200 + 1) return;
        }
    }

    std::vector<Face> faces() const {
        std::vector<Face> kept;
        for (const Face& f : faces_)
            if (f[0] != f[1]) kept.push_back(f);
        return kept;
    }

  private:
    glm::dvec3 area(const Face& f) const {
        const glm::dvec3 p(positions_[f[0]]);
        return glm::cross(glm::dvec3(positions_[f[1]]) - p, glm::dvec3(positions_[f[2]]) - p);
    }
    double smallest_sine(const Face& f, double twice_area) const {
        double longest[2] = {0, 0};  // the product of the two longest edges
        for (std::size_t k = 0; k < 3; ++k) {
            const double e =
                glm::distance(glm::dvec3(positions_[f[k]]), glm::dvec3(positions_[f[(k + 1) % 3]]));
            if (e > longest[0])
                longest[1] = longest[0], longest[0] = e;
            else
                longest[1] = std::max(longest[1], e);
        }
        return twice_area / (longest[0] * longest[1]);
    }
    std::vector<std::uint32_t> neighbours(std::uint32_t v) const {
        std::vector<std::uint32_t> out;
        for (const std::uint32_t f : at_[v])
            for (const std::uint32_t w : faces_[f])
                if (w != v) out.push_back(w);
        std::sort(out.begin(), out.end());
        return out;
    }

    void remove(std::uint32_t v, std::vector<bool>& touched) {
        // Inside: each neighbour by two faces. Anything else that is odd fails below.
        std::vector<std::uint32_t> around = neighbours(v);
        for (std::size_t i = 0; i < around.size(); i += 2)
            if (i + 1 >= around.size() || around[i] != around[i + 1] ||
                (i + 2 < around.size() && around[i + 1] == around[i + 2]))
                return;
        around.erase(std::unique(around.begin(), around.end()), around.end());
        if (around.size() < 3 || around.size() != at_[v].size()) return;
        glm::dvec3 side(0);
        for (const std::uint32_t f : at_[v]) side += area(faces_[f]);
        std::uint32_t best = v;
        double best_sine = least_sine;
        for (const std::uint32_t u : around) {
            std::vector<std::uint32_t> others = neighbours(u), shared;
            others.erase(std::unique(others.begin(), others.end()), others.end());
            std::set_intersection(around.begin(), around.end(), others.begin(), others.end(),
                                  std::back_inserter(shared));
            if (shared.size() != 2) continue;
            const double sine = worst_without(v, u, side);
            if (sine > best_sine) {
                best = u;
                best_sine = sine;
            }
        }
        if (best == v) return;
        for (const std::uint32_t f : at_[v]) {
            Face& face = faces_[f];
            const bool goes = std::find(face.begin(), face.end(), best) != face.end();
            if (goes) {
                for (const std::uint32_t w : face)
                    if (w != v) at_[w].erase(std::find(at_[w].begin(), at_[w].end(), f));
                face = {0, 0, 0};
                continue;
            }
            *std::find(face.begin(), face.end(), v) = best;
            at_[best].push_back(f);
        }
        at_[v].clear();
        --left_;
        for (const std::uint32_t w : around) touched[w] = true;
    }

    // The smallest sine of the triangles that stay when v becomes u; 0 where one turns round.
    double worst_without(std::uint32_t v, std::uint32_t u, const glm::dvec3& side) const {
        double worst = 1;
        for (const std::uint32_t f : at_[v]) {
            Face face = faces_[f];
            if (std::find(face.begin(), face.end(), u) != face.end()) continue;
            *std::find(face.begin(), face.end(), v) = u;
            const glm::dvec3 normal = area(face);
            const double twice = glm::length(normal);
            if (!(glm::dot(normal, side) > least_cosine * twice * glm::length(side))) return 0;
            worst = std::min(worst, smallest_sine(face, twice));
        }
        return worst;
    }

    const std::vector<glm::vec3>& positions_;
    std::vector<Face> faces_;  // {0, 0, 0}: gone
    std::vector<std::vector<std::uint32_t>> at_;
    std::size_t left_ = 0;
};

prep::Mesh mesh_of(std::vector<glm::vec3> positions, const std::vector<Face>& faces) {
    prep::Mesh mesh;
    mesh.positions = std::move(positions);
    for (const Face& f : faces) {
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), f.begin(), f.end());
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    return mesh;
}

// Equal positions are one vertex, the first of them; −0 is 0.
std::vector<std::uint32_t> firsts(const std::vector<glm::vec3>& positions) {
    const auto key = [&](std::uint32_t v) {
        std::array<std::uint32_t, 3> k{};  // bits: what is not a number has its place too
        for (int i = 0; i < 3; ++i)
            k[std::size_t(i)] = std::bit_cast<std::uint32_t>(positions[v][i] + 0.0f);
        return k;
    };
    std::vector<std::uint32_t> order(positions.size()), first(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const auto x = key(a), y = key(b);
        return x != y ? x < y : a < b;
    });
    for (std::size_t i = 0; i < order.size(); ++i)
        first[order[i]] =
            i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
    return first;
}

}  // namespace

CoarseMesh coarse_mesh(const prep::Mesh& mesh, double share) {
    CoarseMesh out;
    const std::vector<std::uint32_t> first = firsts(mesh.positions);
    std::vector<Face> faces;
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f] + 1; c + 1 < mesh.face_offsets[f + 1]; ++c) {
            const Face face = {first[mesh.corner_vertices[mesh.face_offsets[f]]],
                               first[mesh.corner_vertices[c]], first[mesh.corner_vertices[c + 1]]};
            const glm::dvec3 p(mesh.positions[face[0]]);
            const double area = glm::length(glm::cross(glm::dvec3(mesh.positions[face[1]]) - p,
                                                       glm::dvec3(mesh.positions[face[2]]) - p));
            if (area > 0 && std::isfinite(area)) faces.push_back(face);
        }
    out.dense = mesh_of(mesh.positions, faces);
    Collapses collapses(out.dense.positions, faces);
    std::vector<bool> used(mesh.positions.size(), false);
    for (const Face& f : faces)
        for (const std::uint32_t v : f) used[v] = true;
    collapses.run(std::size_t(share * double(std::count(used.begin(), used.end(), true))));
    std::vector<Face> kept = collapses.faces();
    std::vector<std::uint32_t> number(mesh.positions.size(), prep::no_index);
    std::vector<glm::vec3> positions;
    for (Face& f : kept)
        for (std::uint32_t& v : f) {
            if (number[v] == prep::no_index) {
                number[v] = std::uint32_t(positions.size());
                positions.push_back(mesh.positions[v]);
                out.dense_vertices.push_back(v);
            }
            v = number[v];
        }
    out.mesh = mesh_of(std::move(positions), kept);
    return out;
}

}  // namespace cost
