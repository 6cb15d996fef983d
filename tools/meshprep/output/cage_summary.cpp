#include "meshprep/output/cage_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "meshprep/output/counts.h"
#include "prep/topology.h"
#include "sheets/surfaces/cage_lines.h"

namespace meshprep {
namespace {

using prep::no_index;

std::uint64_t count_non_manifold_edges(const prep::Mesh& mesh, const prep::Topology& topology) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        if (topology.kinds[c] != prep::EdgeKind::non_manifold &&
            topology.kinds[c] != prep::EdgeKind::inconsistent)
            continue;
        const std::uint32_t next =
            prep::next_corner(mesh.face_offsets, topology.corner_faces[c], c);
        edges.push_back(std::minmax(topology.welded[mesh.corner_vertices[c]],
                                    topology.welded[mesh.corner_vertices[next]]));
    }
    std::sort(edges.begin(), edges.end());
    return std::uint64_t(std::unique(edges.begin(), edges.end()) - edges.begin());
}

// Points with several fans of faces. From a corner the walk goes on over the edge that enters it;
// it begins where a fan begins, and what is left then goes all around.
std::uint64_t count_non_manifold_vertices(const prep::Mesh& mesh, const prep::Topology& topology) {
    std::vector<std::uint8_t> seen(mesh.corner_count());
    std::uint64_t found = 0;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        std::uint32_t fans = 0;
        for (const bool open : {true, false})
            for (std::uint32_t k = topology.point_offsets[v]; k < topology.point_offsets[v + 1];
                 ++k) {
                std::uint32_t c = topology.point_corners[k];
                if (seen[c] || (open && topology.opposite[c] != no_index)) continue;
                ++fans;
                while (c != no_index && !seen[c]) {
                    seen[c] = 1;
                    c = topology.opposite[prep::previous_corner(mesh.face_offsets,
                                                                topology.corner_faces[c], c)];
                }
            }
        found += fans > 1;
    }
    return found;
}

}  // namespace

CageSummary summarise_cage(const prep::Mesh& mesh, int threads) {
    CageSummary cage;
    const std::size_t vertices = mesh.vertex_count();
    cage.triangles = mesh.corner_count() == 3 * mesh.face_count();
    // Points that the file repeats at seams are one.
    const prep::MeshView view(mesh);
    std::vector<std::uint32_t> welded;
    if (mesh.indexed_by_vertex) welded = prep::weld_exact(view.positions, threads);
    const prep::Topology topology = prep::build_topology(view, welded, threads);
    std::vector<bool> border(vertices);
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        if (topology.kinds[c] != prep::EdgeKind::border) continue;
        const std::uint32_t next =
            prep::next_corner(mesh.face_offsets, topology.corner_faces[c], c);
        for (const std::uint32_t corner : {c, next})
            border[topology.welded[mesh.corner_vertices[corner]]] = true;
    }
    cage.extraordinary_vertices =
        report::extraordinary_vertices(mesh, topology, cage.triangles).size();
    std::vector<std::uint8_t> ends(vertices);
    for (const prep::EdgeMark& mark : mesh.subdivision.creases) {
        if (!(mark.sharpness > 0)) continue;
        ++(mark.sharpness < 10 ? cage.semi_sharp_edges : cage.infinitely_sharp_edges);
        for (const std::uint32_t v : {mark.v0, mark.v1})
            if (v < vertices) ends[v] = std::uint8_t(std::min(ends[v] + 1, 3));
    }
    for (std::size_t v = 0; v < vertices; ++v) cage.crease_ends += ends[v] == 1 && !border[v];
    for (const prep::VertexMark& mark : mesh.subdivision.corners)
        cage.sharp_vertices += mark.sharpness > 0;
    cage.hole_faces = mesh.subdivision.holes.size();
    cage.non_manifold_edges = count_non_manifold_edges(mesh, topology);
    cage.non_manifold_vertices = count_non_manifold_vertices(mesh, topology);
    return cage;
}

std::string cage_text(const CageSummary& cage) {
    std::string text = fmt::format(
        "as a cage ({}): {}", cage.triangles ? "loop" : "catmark",
        count_of(cage.extraordinary_vertices, "extraordinary vertex", "extraordinary vertices"));
    if (const std::uint64_t edges = cage.semi_sharp_edges + cage.infinitely_sharp_edges; edges > 0)
        text += fmt::format(", {} ({} infinitely sharp), {}", count_of(edges, "creased edge"),
                            cage.infinitely_sharp_edges, count_of(cage.crease_ends, "crease end"));
    if (cage.sharp_vertices > 0)
        text += ", " + count_of(cage.sharp_vertices, "sharp vertex", "sharp vertices");
    if (cage.non_manifold_edges > 0)
        text += ", " + count_of(cage.non_manifold_edges, "non-manifold edge");
    if (cage.non_manifold_vertices > 0)
        text += ", " + count_of(cage.non_manifold_vertices, "non-manifold vertex",
                                "non-manifold vertices");
    if (cage.hole_faces > 0) text += ", " + count_of(cage.hole_faces, "hole face");
    return text;
}

Json to_json(const CageSummary& cage) {
    return {{"scheme", cage.triangles ? "loop" : "catmark"},
            {"extraordinary_vertices", cage.extraordinary_vertices},
            {"semi_sharp_edges", cage.semi_sharp_edges},
            {"infinitely_sharp_edges", cage.infinitely_sharp_edges},
            {"crease_ends", cage.crease_ends},
            {"sharp_vertices", cage.sharp_vertices},
            {"hole_faces", cage.hole_faces},
            {"non_manifold_edges", cage.non_manifold_edges},
            {"non_manifold_vertices", cage.non_manifold_vertices}};
}

}  // namespace meshprep
