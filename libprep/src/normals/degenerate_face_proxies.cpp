#include "normals/degenerate_face_proxies.h"

#include <algorithm>

namespace prep::detail {
namespace {

using Index = std::uint32_t;
// Slits side by side that are looked through before giving up.
constexpr int longest_way = 64;

class Search {
  public:
    Search(const MeshView& mesh, const Topology& topology, const FaceNormals& faces)
        : mesh_(mesh), topology_(topology), faces_(faces) {}

    Index regular_neighbour(Index face) {
        collect_edges(face, no_index);
        const std::vector<Index> ways = edges_;
        for (const Index first : ways) {
            Index entered = topology_.opposite[first];
            for (int step = 0; step < longest_way; ++step) {
                const Index there = topology_.corner_faces[entered];
                if (faces_.states[there] == FaceState::regular) return there;
                if (faces_.states[there] != FaceState::zero_area || there == face) break;
                collect_edges(there, entered);
                if (edges_.empty()) break;
                entered = topology_.opposite[edges_.front()];
            }
        }
        return no_index;
    }

  private:
    // The face's half-edges with an opposite, without one of them, the longest first.
    void collect_edges(Index face, Index without) {
        edges_.clear();
        for (Index c = mesh_.face_offsets[face]; c < mesh_.face_offsets[face + 1]; ++c)
            if (c != without && topology_.opposite[c] != no_index) edges_.push_back(c);
        std::stable_sort(edges_.begin(), edges_.end(),
                         [&](Index a, Index b) { return squared(a) > squared(b); });
    }
    double squared(Index c) const {
        const Index d = next_corner(mesh_.face_offsets, topology_.corner_faces[c], c);
        const glm::dvec3 edge = glm::dvec3(mesh_.positions[mesh_.corner_vertices[d]]) -
                                glm::dvec3(mesh_.positions[mesh_.corner_vertices[c]]);
        return glm::dot(edge, edge);
    }

    const MeshView& mesh_;
    const Topology& topology_;
    const FaceNormals& faces_;
    std::vector<Index> edges_;
};

}  // namespace

std::vector<Index> stand_in_faces(const MeshView& mesh, const Topology& topology,
                                  const FaceNormals& faces) {
    const auto is_regular = [](FaceState s) { return s == FaceState::regular; };
    if (std::all_of(faces.states.begin(), faces.states.end(), is_regular)) return {};
    std::vector<Index> stand_ins(faces.states.size(), no_index);
    Search search(mesh, topology, faces);
    for (Index f = 0; f < stand_ins.size(); ++f) {
        if (faces.states[f] == FaceState::regular)
            stand_ins[f] = f;
        else if (faces.states[f] == FaceState::zero_area)
            stand_ins[f] = search.regular_neighbour(f);
    }
    return stand_ins;
}

}  // namespace prep::detail
