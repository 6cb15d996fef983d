#include "surface/recover_quads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "prep/findings.h"
#include "prep/topology.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// A pair of triangles by the corner that leaves along the shared edge in each.
struct Candidate {
    Index face = no_index;
    Index own_corner = 0, other_corner = 0;
    double misfit = 0;  // degrees from a rectangle
};

class QuadRecovery {
  public:
    explicit QuadRecovery(Mesh& mesh)
        : mesh_(mesh),
          topology_(build_topology(MeshView(mesh))),
          candidates_(mesh.face_count()),
          partners_(mesh.face_count(), no_index),
          holes_(mesh.face_count(), false) {
        for (const Index hole : mesh.subdivision.holes)
            if (hole < holes_.size()) holes_[hole] = true;
        for (const EdgeMark& crease : mesh.subdivision.creases) mark(crease.v0, crease.v1);
        for (const glm::uvec2& edge : mesh.hard_marks) mark(edge.x, edge.y);
        std::sort(marked_.begin(), marked_.end());
    }

    RecoveredQuads run() {
        for (Index f = 0; f < mesh_.face_count(); ++f)
            if (is_triangle(f)) find_candidates(f);
        while (join_round()) {
        }
        count();
        rebuild();
        return std::move(result_);
    }

  private:
    static constexpr double worst_misfit = 60, margin = 1;              // degrees
    static constexpr double flattest_cosine = std::numbers::sqrt2 / 2;  // of 45°

    bool is_triangle(Index f) const {
        return mesh_.face_offsets[f + 1] - mesh_.face_offsets[f] == 3;
    }
    Index next(Index corner) const {
        return next_corner(mesh_.face_offsets, topology_.corner_faces[corner], corner);
    }
    glm::dvec3 at(Index corner) const { return mesh_.positions[mesh_.corner_vertices[corner]]; }

    template <class T>
    bool same_value(const CornerLayer<T>& layer, Index a, Index b) const {
        if (layer.empty()) return true;
        const Index i = layer.indices[a], k = layer.indices[b];
        if (i == k) return true;
        return i != no_index && k != no_index &&
               std::memcmp(&layer.values[i], &layer.values[k], sizeof(T)) == 0;
    }
    bool same_corner(Index a, Index b) const {
        for (const auto& layer : mesh_.uvs)
            if (!same_value(layer, a, b)) return false;
        for (const auto& layer : mesh_.colors)
            if (!same_value(layer, a, b)) return false;
        return same_value(mesh_.normals, a, b) && same_attributes(a, b);
    }
    bool same_attributes(Index a, Index b) const {
        const Index i = mesh_.corner_file_vertex(a), k = mesh_.corner_file_vertex(b);
        if (i == k) return true;
        return std::all_of(
            mesh_.vertex_attributes.begin(), mesh_.vertex_attributes.end(),
            [&](const VertexAttribute& attribute) {
                const std::size_t width = attribute.width;
                if ((std::max(i, k) + std::size_t(1)) * width > attribute.values.size())
                    return attribute.values.empty();
                return std::memcmp(&attribute.values[i * width], &attribute.values[k * width],
                                   width * sizeof(float)) == 0;
            });
    }
    // Creases and hard marks stay edges.
    void mark(Index a, Index b) { marked_.push_back({std::min(a, b), std::max(a, b)}); }
    bool is_marked(Index corner) const {
        const Index a = mesh_.corner_vertices[corner], b = mesh_.corner_vertices[next(corner)];
        return std::binary_search(marked_.begin(), marked_.end(),
                                  std::array<Index, 2>{std::min(a, b), std::max(a, b)});
    }
    bool same_face(Index a, Index b) const {
        const auto same = [&](const std::vector<Index>& list) {
            return list.empty() || list[a] == list[b];
        };
        return holes_[a] == holes_[b] && same(mesh_.face_materials) && same(mesh_.face_smoothing) &&
               same(mesh_.face_parts);
    }

    static double angle(const glm::dvec3& a, const glm::dvec3& b) {
        return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
    }

    // The largest deviation from 90° of the quad's angles; over the limit where it is none.
    double misfit(Index own, Index other) const {
        const glm::dvec3 a = at(own), b = at(next(own));
        const glm::dvec3 c = at(next(next(own))), d = at(next(next(other)));
        const glm::dvec3 n0 = glm::cross(b - a, c - a), n1 = glm::cross(d - a, b - a);
        const double lengths = glm::length(n0) * glm::length(n1);
        if (!(glm::dot(n0, n1) > flattest_cosine * lengths)) return 1e9;
        const double angles[] = {angle(c - a, b - a) + angle(b - a, d - a),
                                 angle(c - b, a - b) + angle(a - b, d - b), angle(a - c, b - c),
                                 angle(a - d, b - d)};
        double worst = 0;
        for (const double x : angles) {
            if (!(x < 180)) return 1e9;
            worst = std::max(worst, std::abs(x - 90));
        }
        return worst;
    }

    void find_candidates(Index f) {
        for (Index c = mesh_.face_offsets[f]; c < mesh_.face_offsets[f + 1]; ++c) {
            const Index other = topology_.opposite[c];
            if (other == no_index) continue;
            const Index g = topology_.corner_faces[other];
            if (g == f || !is_triangle(g) || !same_face(f, g) || is_marked(c)) continue;
            if (!same_corner(c, next(other)) || !same_corner(next(c), other)) continue;
            const double fit = misfit(c, other);
            if (fit <= worst_misfit) candidates_[f].push_back({g, c, other, fit});
        }
    }

    // None: nothing is left, or several are alike.
    const Candidate* best(Index f) const {
        const Candidate* first = nullptr;
        double second = 1e9;
        for (const Candidate& c : candidates_[f]) {
            if (partners_[c.face] != no_index) continue;
            if (!first || c.misfit < first->misfit) {
                if (first) second = first->misfit;
                first = &c;
            } else {
                second = std::min(second, c.misfit);
            }
        }
        return first && second - first->misfit >= margin ? first : nullptr;
    }

    bool join_round() {
        std::vector<std::array<Index, 2>> pairs;
        for (Index f = 0; f < mesh_.face_count(); ++f) {
            if (partners_[f] != no_index || candidates_[f].empty()) continue;
            const Candidate* own = best(f);
            if (!own || own->face < f) continue;
            const Candidate* theirs = best(own->face);
            if (theirs && theirs->face == f) pairs.push_back({f, own->face});
        }
        for (const auto& [a, b] : pairs) {
            partners_[a] = b;
            partners_[b] = a;
        }
        return !pairs.empty();
    }

    void count() {
        Index faces = 0;
        for (Index f = 0; f < mesh_.face_count(); ++f) {
            const bool joined = partners_[f] != no_index;
            if (joined && partners_[f] < f) continue;
            result_.quads += joined;
            if (!joined && is_triangle(f)) {
                const bool any =
                    std::any_of(candidates_[f].begin(), candidates_[f].end(),
                                [&](const Candidate& c) { return partners_[c.face] == no_index; });
                ++(any ? result_.ambiguous : result_.alone);
                if (result_.places.size() < Finding::max_places) result_.places.push_back(faces);
            }
            ++faces;
        }
    }

    template <class T>
    static void gather(std::vector<T>& list, const std::vector<Index>& from) {
        if (list.empty()) return;
        std::vector<T> out;
        out.reserve(from.size());
        for (const Index i : from) out.push_back(list[i]);
        list = std::move(out);
    }

    void rebuild() {
        if (result_.quads == 0) return;
        std::vector<Index> corners, faces, offsets{0};
        std::vector<Index> new_face(mesh_.face_count());
        for (Index f = 0; f < mesh_.face_count(); ++f) {
            const Index partner = partners_[f];
            if (partner != no_index && partner < f) {
                new_face[f] = new_face[partner];
                continue;
            }
            new_face[f] = Index(faces.size());
            faces.push_back(f);
            if (partner == no_index) {
                for (Index c = mesh_.face_offsets[f]; c < mesh_.face_offsets[f + 1]; ++c)
                    corners.push_back(c);
            } else {
                for (const Candidate& pair : candidates_[f])
                    if (pair.face == partner) {
                        // Around: from the diagonal's end to its begin, then the other's tip.
                        const Index end = next(pair.own_corner);
                        corners.insert(corners.end(), {end, next(end), pair.own_corner,
                                                       next(next(pair.other_corner))});
                        break;
                    }
            }
            offsets.push_back(Index(corners.size()));
        }
        mesh_.face_offsets = std::move(offsets);
        gather(mesh_.corner_vertices, corners);
        gather(mesh_.corner_file_vertices, corners);
        gather(mesh_.normals.indices, corners);
        gather(mesh_.tangents.indices, corners);
        for (auto& layer : mesh_.uvs) gather(layer.indices, corners);
        for (auto& layer : mesh_.colors) gather(layer.indices, corners);
        gather(mesh_.face_materials, faces);
        gather(mesh_.face_smoothing, faces);
        gather(mesh_.face_parts, faces);
        for (Index& hole : mesh_.subdivision.holes)
            if (hole < new_face.size()) hole = new_face[hole];
    }

    Mesh& mesh_;
    Topology topology_;
    std::vector<std::vector<Candidate>> candidates_;
    std::vector<Index> partners_;
    std::vector<bool> holes_;
    std::vector<std::array<Index, 2>> marked_;  // ascending
    RecoveredQuads result_;
};

}  // namespace

RecoveredQuads recover_quads(Mesh& mesh) {
    if (mesh.face_count() == 0) return {};
    return QuadRecovery(mesh).run();
}

}  // namespace prep::detail
