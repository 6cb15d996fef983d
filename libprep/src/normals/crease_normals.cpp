#include <optional>
#include <utility>

#include "base/parallel.h"
#include "normals/crease_fans.h"
#include "prep/corner_normals.h"
#include "prep/face_normals.h"
#include "prep/topology.h"
#include "surface/vertex_corners.h"

namespace prep {

Result<CreaseNormals> crease_normals(const MeshView& mesh, std::span<const std::uint32_t> welded,
                                     const HardEdgeOptions& hard_options,
                                     const NormalOptions& options) {
    HardEdgeOptions edges = hard_options;
    edges.threads = options.threads;
    FaceNormals faces;
    const auto find_faces = [&] { faces = face_normals(mesh, options.precision, options.threads); };
    if (detail::may_have_crease_fans(mesh, options)) {
        std::optional<detail::CornerPoints> points;
        detail::VertexCorners around;
        // Each has parts for one thread.
        detail::parallel_both(options.threads, find_faces, [&] {
            points.emplace(mesh, welded, options.threads);
            around = detail::corners_by_vertex(points->of_corners(), mesh.positions.size(),
                                               options.threads);
        });
        if (auto fans = detail::crease_fans(mesh, points->of_corners(), welded, around, faces,
                                            edges, options))
            return *std::move(fans);
    } else {
        find_faces();
    }
    const Topology topology = build_topology(mesh, welded, options.threads);
    auto hard = hard_edges(mesh, topology, faces, edges);
    if (!hard) return std::move(hard).error();
    auto normals = corner_normals(mesh, topology, faces, *hard, options);
    if (!normals) return std::move(normals).error();
    return CreaseNormals{*std::move(normals), *std::move(hard)};
}

}  // namespace prep
