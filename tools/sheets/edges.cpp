#include "sheets/edges.h"

#include <algorithm>
#include <cmath>

#include "prep/face_normals.h"
#include "prep/hard_edges.h"
#include "prep/topology.h"

namespace report {
namespace {

using prep::no_index;

bool normals_differ(const prep::CornerLayer<glm::vec3>& normals, std::uint32_t a, std::uint32_t b) {
    if (normals.empty()) return false;
    const std::uint32_t i = normals.indices[a], j = normals.indices[b];
    if (i == j) return false;
    if (i == no_index || j == no_index) return true;
    const glm::dvec3 n(normals.values[i]), m(normals.values[j]);
    // Half a degree: what the eye can tell; |n − m| = 2 sin(angle / 2) for unit normals.
    constexpr double least = 0.0087265;
    return glm::length(n - m) > least;
}

bool uvs_differ(const prep::Mesh& mesh, std::uint32_t a, std::uint32_t b) {
    if (mesh.uvs.empty() || mesh.uvs[0].empty()) return false;
    const prep::CornerLayer<glm::vec2>& layer = mesh.uvs[0];
    const std::uint32_t i = layer.indices[a], j = layer.indices[b];
    if (i == j) return false;
    if (i == no_index || j == no_index) return true;
    return layer.values[i] != layer.values[j];
}

EdgeClass class_of_break(std::uint8_t reasons) {
    if (reasons & prep::hard_mark) return EdgeClass::mark;
    if (reasons & prep::hard_smoothing_group) return EdgeClass::smoothing_group;
    if (reasons & prep::hard_angle) return EdgeClass::angle;
    if (reasons & prep::hard_material) return EdgeClass::material;
    if (reasons & prep::hard_uv_border) return EdgeClass::uv_request;
    return EdgeClass::authored;
}

}  // namespace

const char* edge_class_name(EdgeClass kind) {
    switch (kind) {
        case EdgeClass::smooth:
            return "smooth";
        case EdgeClass::angle:
            return "angle";
        case EdgeClass::smoothing_group:
            return "smoothing group";
        case EdgeClass::mark:
            return "marked";
        case EdgeClass::material:
            return "material border";
        case EdgeClass::uv_request:
            return "UV border";
        case EdgeClass::authored:
            return "authored normals";
        case EdgeClass::non_manifold:
            return "non-manifold";
        case EdgeClass::border:
            return "open border";
        case EdgeClass::uv_seam:
            break;
    }
    return "UV seam (smooth)";
}

std::vector<ClassedEdge> classify_edges(const prep::Mesh& mesh,
                                        const prep::PrepareOptions& options) {
    const prep::MeshView view(mesh);
    std::vector<std::uint32_t> welded;
    if (options.weld != prep::WeldMode::none)
        welded = prep::weld_exact(view.positions, options.threads);
    const prep::Topology topology = prep::build_topology(view, welded, options.threads);
    const prep::FaceNormals faces =
        prep::face_normals(view, options.normal.precision, options.threads);
    const prep::Result<prep::HardEdges> hard =
        prep::hard_edges(view, topology, faces, options.hard_edges);

    std::vector<ClassedEdge> edges;
    edges.reserve(mesh.corner_count() / 2);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const std::uint32_t next = prep::next_corner(mesh.face_offsets, f, c);
            const std::uint32_t opposite = topology.opposite[c];
            if (opposite != no_index && opposite < c) continue;  // the other side tells
            ClassedEdge edge{mesh.corner_vertices[c], mesh.corner_vertices[next],
                             EdgeClass::smooth};
            switch (topology.kinds[c]) {
                case prep::EdgeKind::degenerate:
                    continue;
                case prep::EdgeKind::border:
                    edge.kind = EdgeClass::border;
                    break;
                case prep::EdgeKind::inconsistent:
                case prep::EdgeKind::non_manifold:
                    edge.kind = EdgeClass::non_manifold;
                    break;
                case prep::EdgeKind::interior:
                    break;
            }
            if (edge.kind == EdgeClass::smooth && opposite != no_index) {
                const std::uint32_t opposite_next =
                    prep::next_corner(mesh.face_offsets, topology.corner_faces[opposite], opposite);
                if (normals_differ(mesh.normals, c, opposite_next) ||
                    normals_differ(mesh.normals, next, opposite))
                    edge.kind = class_of_break(hard ? hard->reasons[c] : std::uint8_t(0));
                else if (uvs_differ(mesh, c, opposite_next) || uvs_differ(mesh, next, opposite))
                    edge.kind = EdgeClass::uv_seam;
            }
            if (edge.v0 > edge.v1) std::swap(edge.v0, edge.v1);
            edges.push_back(edge);
        }
    }
    const auto by_vertices = [](const ClassedEdge& a, const ClassedEdge& b) {
        return a.v0 != b.v0 ? a.v0 < b.v0 : a.v1 != b.v1 ? a.v1 < b.v1 : a.kind < b.kind;
    };
    std::sort(edges.begin(), edges.end(), by_vertices);
    const auto same = [](const ClassedEdge& a, const ClassedEdge& b) {
        return a.v0 == b.v0 && a.v1 == b.v1;
    };
    edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
    return edges;
}

}  // namespace report
