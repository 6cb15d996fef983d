#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "prep/face_normals.h"
#include "repair/repair_steps.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Follows open edges from the end of half-edge `c`, around the point, to the next open one;
// no_index where the walk ends at another kind of edge.
Index next_open(const Mesh& mesh, const Topology& topology, Index c) {
    const auto next = [&](Index k) {
        return next_corner(mesh.face_offsets, topology.corner_faces[k], k);
    };
    Index k = next(c);
    for (std::size_t steps = 0; steps <= mesh.corner_count(); ++steps) {
        if (topology.kinds[k] == EdgeKind::border) return k;
        if (topology.kinds[k] == EdgeKind::degenerate)
            k = next(k);
        else if (topology.opposite[k] != no_index)
            k = next(topology.opposite[k]);
        else
            return no_index;
    }
    return no_index;
}

// Twice the area vector of a triangle.
glm::dvec3 area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::cross(b - a, c - a);
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// The triangulation of a loop of points of least (largest angle to a neighbour, area), by dynamic
// programming over the sub-polygons i … j (Barequet and Sharir 1995; the weight: Liepa 2003).
// `taken(i, j)`: there is an edge between these points already, and a second one would make it
// non-manifold. `rims[i]`: area vector of the face outside edge i → i + 1, in the loop's direction.
template <class Taken>
class LoopTriangulation {
  public:
    LoopTriangulation(const std::vector<glm::dvec3>& points, const std::vector<glm::dvec3>& rims,
                      const Taken& taken)
        : points_(points), rims_(rims), taken_(taken), n_(points.size()), table_(n_ * n_) {
        for (std::size_t span = 2; span < n_; ++span)
            for (std::size_t i = 0; i + span < n_; ++i) choose(i, i + span);
    }

    // Three loop positions each, in the loop's direction. Empty where there is no triangulation
    // without a triangle that has no area or an edge that is taken.
    std::vector<std::size_t> triangles() const {
        std::vector<std::size_t> out;
        if (!std::isfinite(at(0, n_ - 1).area)) return out;
        std::vector<std::pair<std::size_t, std::size_t>> spans{{0, n_ - 1}};
        while (!spans.empty()) {
            const auto [i, j] = spans.back();
            spans.pop_back();
            if (j - i < 2) continue;
            const std::size_t m = at(i, j).middle;
            out.insert(out.end(), {i, m, j});
            spans.emplace_back(m, j);
            spans.emplace_back(i, m);
        }
        return out;
    }

  private:
    struct Entry {
        double angle = 0, area = 0;
        std::size_t middle = 0;
        glm::dvec3 normal{0.0};  // of the triangle on the edge i → j
    };

    const Entry& at(std::size_t i, std::size_t j) const { return table_[i * n_ + j]; }

    // What lies on the other side of edge i → j of a triangle: the rim or an inner triangle.
    const glm::dvec3& beyond(std::size_t i, std::size_t j) const {
        return j == i + 1 ? rims_[i] : at(i, j).normal;
    }

    void choose(std::size_t i, std::size_t j) {
        Entry best;
        best.angle = best.area = std::numeric_limits<double>::infinity();
        const bool diagonal = i > 0 || j + 1 < n_;
        for (std::size_t m = i + 1; m < j && !(diagonal && taken_(i, j)); ++m) {
            Entry e;
            e.normal = area(points_[i], points_[m], points_[j]);
            e.middle = m;
            e.area = glm::length(e.normal) + at(i, m).area + at(m, j).area;
            e.angle =
                std::max({at(i, m).angle, at(m, j).angle, angle_between(e.normal, beyond(i, m)),
                          angle_between(e.normal, beyond(m, j))});
            // The last edge of the loop closes it: its rim counts too.
            if (i == 0 && j + 1 == n_)
                e.angle = std::max(e.angle, angle_between(e.normal, rims_[n_ - 1]));
            if (!(glm::length(e.normal) > 0)) continue;
            if (e.angle < best.angle || (e.angle == best.angle && e.area < best.area)) best = e;
        }
        table_[i * n_ + j] = best;
    }

    const std::vector<glm::dvec3>& points_;
    const std::vector<glm::dvec3>& rims_;
    const Taken& taken_;
    std::size_t n_;
    std::vector<Entry> table_;
};

// A face of the rim's attributes, at the corners that leave the loop's points.
void add_triangle(Mesh& mesh, const Index (&corners)[3], Index rim_face) {
    for (const Index c : corners) mesh.corner_vertices.push_back(Index(mesh.corner_vertices[c]));
    if (!mesh.corner_file_vertices.empty())
        for (const Index c : corners)
            mesh.corner_file_vertices.push_back(Index(mesh.corner_file_vertices[c]));
    const auto add = [&corners](auto& layer, bool known) {
        if (layer.empty()) return;
        for (const Index c : corners)
            layer.indices.push_back(known ? Index(layer.indices[c]) : no_index);
    };
    add(mesh.normals, false);
    add(mesh.tangents, false);
    for (auto& layer : mesh.uvs) add(layer, true);
    for (auto& layer : mesh.colors) add(layer, true);
    mesh.face_offsets.push_back(Index(mesh.corner_vertices.size()));
    for (auto* per_face : {&mesh.face_materials, &mesh.face_smoothing, &mesh.face_parts})
        if (!per_face->empty()) per_face->push_back(Index((*per_face)[rim_face]));
}

// Half-edges around each hole, in the rim's direction. Those of more edges than `most_edges`, or
// that do not come back to where they began, are counted in `left`.
std::vector<std::vector<Index>> open_loops(const Mesh& mesh, const Topology& topology,
                                           std::uint32_t most_edges, std::uint64_t& left) {
    std::vector<std::uint8_t> seen(mesh.corner_count(), 0);
    std::vector<std::vector<Index>> loops;
    const Index corners = Index(mesh.corner_count());
    for (Index c = 0; c < corners; ++c) {
        if (seen[c] || topology.kinds[c] != EdgeKind::border) continue;
        std::vector<Index> loop;
        Index k = c;
        while (k != no_index && !seen[k]) {
            seen[k] = 1;
            loop.push_back(k);
            k = next_open(mesh, topology, k);
        }
        if (k != c || loop.size() > most_edges)
            ++left;
        else
            loops.push_back(std::move(loop));
    }
    return loops;
}

class HoleFiller {
  public:
    HoleFiller(Mesh& mesh, const Topology& topology, const FaceNormals& faces)
        : mesh_(mesh), topology_(topology), faces_(faces) {
        const Index corners = Index(mesh.corner_count());
        for (Index c = 0; c < corners; ++c)
            edges_.insert(edge_key(
                point(c), point(next_corner(mesh.face_offsets, topology.corner_faces[c], c))));
    }

    // Whether the hole could be filled.
    bool fill(const std::vector<Index>& loop) {
        if (!is_usable(loop)) return false;
        // The fill runs against the rim: its points in reverse.
        const std::vector<Index> reversed(loop.rbegin(), loop.rend());
        const std::vector<std::size_t> triangles = triangulation(reversed);
        for (std::size_t i = 0; i < triangles.size(); i += 3) {
            const Index at[3] = {reversed[triangles[i]], reversed[triangles[i + 1]],
                                 reversed[triangles[i + 2]]};
            for (int k = 0; k < 3; ++k)
                edges_.insert(edge_key(point(at[k]), point(at[(k + 1) % 3])));
            add_triangle(mesh_, at, topology_.corner_faces[at[0]]);
        }
        return !triangles.empty();
    }

  private:
    Index point(Index c) const { return topology_.welded[mesh_.corner_vertices[c]]; }

    // Of one part, touching neither itself nor faces without area.
    bool is_usable(const std::vector<Index>& loop) const {
        bool usable = loop.size() >= 3;
        std::vector<Index> met;
        for (const Index c : loop) {
            const Index f = topology_.corner_faces[c];
            met.push_back(point(c));
            usable &= faces_.states[f] == FaceState::regular;
            if (!mesh_.face_parts.empty())
                usable &= mesh_.face_parts[f] == mesh_.face_parts[topology_.corner_faces[loop[0]]];
        }
        std::sort(met.begin(), met.end());
        return usable && std::adjacent_find(met.begin(), met.end()) == met.end();
    }

    // Three places in `reversed` each; empty where none fits.
    std::vector<std::size_t> triangulation(const std::vector<Index>& reversed) const {
        std::vector<glm::dvec3> points, rims;
        for (std::size_t i = 0; i < reversed.size(); ++i) {
            points.emplace_back(mesh_.positions[mesh_.corner_vertices[reversed[i]]]);
            // The edge from point i to i + 1 of the reversed loop is that of the half-edge that
            // leaves point i + 1.
            rims.push_back(
                faces_.area_vectors[topology_.corner_faces[reversed[(i + 1) % reversed.size()]]]);
        }
        const auto taken = [&](std::size_t i, std::size_t j) {
            return edges_.contains(edge_key(point(reversed[i]), point(reversed[j])));
        };
        return LoopTriangulation(points, rims, taken).triangles();
    }

    Mesh& mesh_;
    const Topology& topology_;
    const FaceNormals& faces_;
    std::unordered_set<std::uint64_t> edges_;
};

}  // namespace

RepairStep fill_holes(Mesh& mesh, std::uint32_t most_edges, int threads) {
    RepairStep step;
    step.step = "holes";
    step.place_kind = PlaceKind::edge;
    step.text = "holes were filled";
    const Topology topology = repair_topology(mesh, threads);
    const std::vector<std::vector<Index>> loops = open_loops(mesh, topology, most_edges, step.left);
    Places places;
    if (!loops.empty()) {
        const FaceNormals faces = face_normals(MeshView(mesh), Precision::accurate, threads);
        HoleFiller filler(mesh, topology, faces);
        for (const std::vector<Index>& loop : loops) {
            if (filler.fill(loop))
                places.add(loop[0]);
            else
                ++step.left;
        }
    }
    step.changed = places.count;
    step.places = std::move(places.first);
    if (step.left > 0)
        step.text +=
            "; left: those of too many edges, of several parts, that touch themselves or faces "
            "without area, or that no triangulation fits";
    return step;
}

}  // namespace prep::detail
