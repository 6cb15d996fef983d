#include "sheets/edges.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

EdgeClass class_of_break(std::uint8_t reasons, bool normals_made) {
    if (reasons & prep::hard_mark) return EdgeClass::mark;
    if (reasons & prep::hard_smoothing_group) return EdgeClass::smoothing_group;
    if (reasons & prep::hard_angle) return EdgeClass::angle;
    if (reasons & prep::hard_material) return EdgeClass::material;
    if (reasons & prep::hard_uv_border) return EdgeClass::uv_request;
    return normals_made ? EdgeClass::cancelled : EdgeClass::authored;
}

}  // namespace

const EdgeClassStyle& style_of(EdgeClass kind) {
    static constexpr EdgeClassStyle styles[] = {{"smooth", rgb(0x9ca3af)},
                                                {"angle", rgb(0xdc2626)},
                                                {"smoothing group", rgb(0xc026d3)},
                                                {"marked", rgb(0xea580c)},
                                                {"material border", rgb(0x7c3aed)},
                                                {"UV border", rgb(0x0891b2)},
                                                {"authored normals", rgb(0xd97706)},
                                                {"normals that cancel", rgb(0xa16207)},
                                                {"vertices apart in the file", rgb(0xbe185d)},
                                                {"non-manifold", rgb(0x111827)},
                                                {"inconsistent orientation", rgb(0x6b21a8)},
                                                {"open border", rgb(0x2563eb)},
                                                {"UV seam (smooth)", rgb(0x0d9488)}};
    static_assert(std::size(styles) == edge_class_count);
    return styles[std::size_t(kind)];
}

std::vector<ClassedEdge> classify_edges(const prep::PreparedScene& prepared, std::uint32_t index,
                                        const prep::PrepareOptions& options) {
    const prep::Mesh& mesh = prepared.scene.meshes[index];
    const prep::MeshView view(mesh);
    const auto holds = [index](const std::vector<bool>& facts) {
        return index < facts.size() && facts[index];
    };
    // What is open or crowded is so by position, as check() has it; normals were made over the
    // file's own vertices where those are no points repeated at seams.
    const bool welded = holds(prepared.welded);
    std::vector<std::uint32_t> points;
    if (welded || options.weld == prep::WeldMode::automatic)
        points = prep::weld_exact(view.positions, options.threads);
    const prep::Topology topology = prep::build_topology(view, points, options.threads);
    std::optional<prep::Topology> own;
    if (!welded && !points.empty()) own = prep::build_topology(view, {}, options.threads);
    const prep::Topology& shaded = own ? *own : topology;
    const prep::FaceNormals faces =
        prep::face_normals(view, options.normal.precision, options.threads);
    const prep::Result<prep::HardEdges> hard =
        prep::hard_edges(view, shaded, faces, options.hard_edges);

    std::vector<ClassedEdge> edges;
    edges.reserve(mesh.corner_count() / 2);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const std::uint32_t next = prep::next_corner(mesh.face_offsets, f, c);
            const std::uint32_t opposite = topology.opposite[c];
            if (opposite != no_index && opposite < c) continue;  // the other side tells
            const auto point = [&](std::uint32_t corner) {
                const std::uint32_t v = mesh.corner_vertices[corner];
                return points.empty() ? v : points[v];
            };
            ClassedEdge edge{point(c), point(next), EdgeClass::smooth};
            switch (topology.kinds[c]) {
                case prep::EdgeKind::degenerate:
                    continue;
                case prep::EdgeKind::border:
                    edge.kind = EdgeClass::border;
                    break;
                case prep::EdgeKind::inconsistent:
                    edge.kind = EdgeClass::inconsistent;
                    break;
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
                    normals_differ(mesh.normals, next, opposite)) {
                    const bool made = holds(prepared.normals_made);
                    edge.kind =
                        made && shaded.opposite[c] == no_index
                            ? EdgeClass::apart
                            : class_of_break(hard ? hard->reasons[c] : std::uint8_t(0), made);
                }
                if (edge.kind == EdgeClass::smooth &&
                    (uvs_differ(mesh, c, opposite_next) || uvs_differ(mesh, next, opposite)))
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
    // Edges of many faces come with each of their half-edges; others that lie on each other, as the
    // two sides of a leaf do, are edges of their own.
    const auto same = [](const ClassedEdge& a, const ClassedEdge& b) {
        const bool crowded = a.kind == EdgeClass::non_manifold || a.kind == EdgeClass::inconsistent;
        return crowded && a.kind == b.kind && a.v0 == b.v0 && a.v1 == b.v1;
    };
    edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
    return edges;
}

}  // namespace report
