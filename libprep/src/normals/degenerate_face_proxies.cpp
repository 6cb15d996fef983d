#include "normals/degenerate_face_proxies.h"

#include <algorithm>
#include <array>
#include <unordered_map>

namespace prep::detail {
namespace {

using Index = std::uint32_t;
// Slits side by side that are looked through before giving up.
constexpr int longest_way = 64;

class Search {
    using Longest = std::array<Index, 2>;

  public:
    Search(const MeshView& mesh, const Topology& topology, const FaceNormals& faces)
        : mesh_(mesh), topology_(topology), faces_(faces) {}

    Index regular_neighbour(Index face) {
        collect_edges(face);
        for (const Index first : edges_) {
            Index entered = topology_.opposite[first];
            for (int step = 0; step < longest_way; ++step) {
                const Index there = topology_.corner_faces[entered];
                if (faces_.states[there] == FaceState::regular) return there;
                if (faces_.states[there] != FaceState::zero_area || there == face) break;
                const Index out = longest_but(there, entered);
                if (out == no_index) break;
                entered = topology_.opposite[out];
            }
        }
        return no_index;
    }

  private:
    // The face's half-edges with an opposite, the longest first.
    void collect_edges(Index face) {
        edges_.clear();
        for (Index c = mesh_.face_offsets[face]; c < mesh_.face_offsets[face + 1]; ++c)
            if (topology_.opposite[c] != no_index) edges_.push_back(c);
        std::stable_sort(edges_.begin(), edges_.end(),
                         [&](Index a, Index b) { return squared(a) > squared(b); });
    }
    // The longest of them without one. A face may be entered by each of its edges.
    Index longest_but(Index face, Index without) {
        const auto [known, is_new] = longest_.try_emplace(face, Longest{no_index, no_index});
        Longest& two = known->second;
        for (Index c = mesh_.face_offsets[face]; is_new && c < mesh_.face_offsets[face + 1]; ++c) {
            if (topology_.opposite[c] == no_index) continue;
            if (two[0] == no_index || squared(c) > squared(two[0]))
                two = {c, two[0]};
            else if (two[1] == no_index || squared(c) > squared(two[1]))
                two[1] = c;
        }
        return two[0] == without ? two[1] : two[0];
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
    std::unordered_map<Index, Longest> longest_;  // by face, the first of equal ones
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
