#include <algorithm>
#include <compare>

#include "base/disjoint_sets.h"
#include "prep/face_normals.h"
#include "repair/repair_steps.h"
#include "surface/shells.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Two faces with a common edge, and whether they run against each other there (as they should).
struct Link {
    Index a, b;
    bool agree;
};

std::vector<Link> links_over_edges(const Mesh& mesh, const Topology& topology) {
    std::vector<Link> links;
    struct Same {
        std::uint64_t edge;
        Index face;
        auto operator<=>(const Same&) const = default;
    };
    std::vector<Same> same;
    for (Index c = 0; c < mesh.corner_count(); ++c) {
        if (topology.kinds[c] == EdgeKind::interior && c < topology.opposite[c]) {
            links.push_back(
                {topology.corner_faces[c], topology.corner_faces[topology.opposite[c]], true});
        } else if (topology.kinds[c] == EdgeKind::inconsistent) {
            const Index to = next_corner(mesh.face_offsets, topology.corner_faces[c], c);
            const Index a = topology.welded[mesh.corner_vertices[c]];
            const Index b = topology.welded[mesh.corner_vertices[to]];
            same.push_back({edge_key(a, b), topology.corner_faces[c]});
        }
    }
    std::sort(same.begin(), same.end());
    for (std::size_t i = 1; i < same.size(); ++i)
        if (same[i].edge == same[i - 1].edge)
            links.push_back({same[i - 1].face, same[i].face, false});
    return links;
}

// Neighbours of each face as one array: those of f are at offsets[f] … offsets[f + 1].
struct Adjacency {
    std::vector<Index> offsets, faces;
    std::vector<std::uint8_t> agree;
};

Adjacency adjacency_of(const Mesh& mesh, const std::vector<Link>& links) {
    Adjacency adjacency;
    adjacency.offsets.assign(mesh.face_count() + 1, 0);
    for (const Link& link : links) {
        ++adjacency.offsets[link.a + 1];
        ++adjacency.offsets[link.b + 1];
    }
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        adjacency.offsets[f + 1] += adjacency.offsets[f];
    adjacency.faces.resize(2 * links.size());
    adjacency.agree.resize(2 * links.size());
    std::vector<Index> at(adjacency.offsets.begin(), adjacency.offsets.end() - 1);
    for (const Link& link : links) {
        for (const auto& [from, to] : {std::pair{link.a, link.b}, std::pair{link.b, link.a}}) {
            adjacency.faces[at[from]] = to;
            adjacency.agree[at[from]++] = link.agree;
        }
    }
    return adjacency;
}

}  // namespace

RepairStep unify_orientation(Mesh& mesh, int threads) {
    RepairStep step;
    step.step = "orientation";
    step.text = "faces were turned to agree with their neighbours";
    const Topology topology = repair_topology(mesh, threads);
    const std::vector<Link> links = links_over_edges(mesh, topology);
    const Adjacency adjacency = adjacency_of(mesh, links);
    std::vector<std::uint8_t> seen(mesh.face_count(), 0), turn(mesh.face_count(), 0);
    std::vector<Index> component;
    for (Index start = 0; start < mesh.face_count(); ++start) {
        if (seen[start]) continue;
        component.assign(1, start);
        seen[start] = 1;
        std::size_t turned = 0;
        for (std::size_t i = 0; i < component.size(); ++i) {
            const Index f = component[i];
            turned += turn[f];
            for (Index k = adjacency.offsets[f]; k < adjacency.offsets[f + 1]; ++k) {
                const Index other = adjacency.faces[k];
                if (seen[other]) continue;
                seen[other] = 1;
                turn[other] = adjacency.agree[k] ? turn[f] : !turn[f];
                component.push_back(other);
            }
        }
        if (2 * turned > component.size())
            for (const Index f : component) turn[f] = !turn[f];
    }
    for (const Link& link : links) step.left += link.agree != (turn[link.a] == turn[link.b]);
    Places places;
    for (Index f = 0; f < mesh.face_count(); ++f)
        if (turn[f]) places.add(f);
    step.changed = places.count;
    step.places = std::move(places.first);
    if (step.left > 0) step.text += "; edges of one-sided surfaces keep their seam";
    if (step.changed > 0)
        turn_faces(mesh, turn, face_normals(MeshView(mesh), Precision::accurate, threads));
    return step;
}

RepairStep turn_outward(Mesh& mesh, int threads) {
    RepairStep step;
    step.step = "outward";
    step.text = "closed components of negative volume were turned inside out";
    const Topology topology = repair_topology(mesh, threads);
    const FaceNormals faces = face_normals(MeshView(mesh), Precision::accurate, threads);
    DisjointSets components(mesh.face_count());
    for (Index c = 0; c < mesh.corner_count(); ++c)
        if (topology.kinds[c] == EdgeKind::interior)
            components.unite(topology.corner_faces[c], topology.corner_faces[topology.opposite[c]]);
    const std::vector<Index> shells = measure_shells(mesh, topology, faces, components).inside_out;
    if (shells.empty()) return step;
    const Adjacency adjacency = adjacency_of(mesh, links_over_edges(mesh, topology));
    std::vector<std::uint8_t> turn(mesh.face_count(), 0);
    std::vector<Index> queue(shells);
    for (const Index f : shells) turn[f] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const Index f = queue[i];
        for (Index k = adjacency.offsets[f]; k < adjacency.offsets[f + 1]; ++k) {
            if (turn[adjacency.faces[k]]) continue;
            turn[adjacency.faces[k]] = 1;
            queue.push_back(adjacency.faces[k]);
        }
    }
    step.changed = shells.size();
    step.places.assign(shells.begin(),
                       shells.begin() + std::min(shells.size(), Finding::max_places));
    turn_faces(mesh, turn, faces);
    return step;
}

}  // namespace prep::detail
