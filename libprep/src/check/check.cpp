#include "prep/check.h"

#include "check/check_parts.h"

namespace prep {

MeshCheck check(const Mesh& mesh, std::uint32_t mesh_index, const CheckOptions& options) {
    const MeshView view(mesh);
    detail::CheckContext context{
        mesh,
        view,
        build_topology(view, weld_exact(view.positions, options.threads), options.threads),
        face_normals(view, Precision::accurate, options.threads),
        options.threads,
        mesh_index,
        {},
        {}};
    detail::check_vertices(context);
    detail::check_faces(context);
    detail::check_adjacency(context);
    detail::check_attributes(context);
    return {std::move(context.summary), std::move(context.findings)};
}

SceneCheck check(const Scene& scene, const CheckOptions& options) {
    SceneCheck result;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
        MeshCheck one = check(scene.meshes[m], m, options);
        result.meshes.push_back(one.summary);
        for (Finding& finding : one.findings) result.findings.push_back(std::move(finding));
        detail::check_materials(scene, m, result.findings);
    }
    return result;
}

}  // namespace prep
