#include "plan/drawn_contents.h"

#include <algorithm>

#include "plan/draw_choice.h"

namespace rast::detail {

DrawnContents drawn_contents(const prep::PreparedScene& prepared) {
    DrawnContents out;
    std::set<std::uint32_t> meshes;
    for (const prep::Node& node : prepared.scene.nodes) {
        if (node.mesh == prep::no_index) continue;
        const prep::VertexMesh& mesh = prepared.meshes[node.mesh];
        out.triangles += mesh.triangle_count();
        out.vertices += mesh.vertex_count();
        if (!meshes.insert(node.mesh).second) continue;
        out.most_triangles = std::max(out.most_triangles, std::uint64_t(mesh.triangle_count()));
        out.most_vertices = std::max(out.most_vertices, std::uint64_t(mesh.vertex_count()));
        for (const prep::VertexMesh::Range& range : mesh.ranges) {
            const bool own = range.material < prepared.scene.materials.size();
            const bool lit = range.triangle_count > 0 &&
                             !(own && prepared.scene.materials[range.material].unlit);
            out.lit |= lit;
            out.normals_missing |= lit && mesh.normals.empty();
            if (own)
                out.materials.insert(range.material);
            else
                out.default_material = true;
        }
    }
    out.meshes.assign(meshes.begin(), meshes.end());
    return out;
}

NormalsRead normals_read(const prep::PreparedScene& prepared, const DrawnContents& drawn,
                         const prep::Consumer& consumer) {
    NormalsRead out;
    for (const std::uint32_t m : drawn.meshes) {
        const prep::VertexMesh& mesh = prepared.meshes[m];
        const prep::MeshContents contents =
            prep::contents_of(mesh, prepared.scene.materials.size());
        if (!prep::reads_of(prep::calls_for(prepared.scene, contents, consumer)).normals) continue;
        out.read = true;
        out.there |= !mesh.normals.empty();
    }
    return out;
}

std::vector<MapsOfMaterial> maps_of_materials(const prep::PreparedScene& prepared,
                                              const DrawnContents& drawn, const RenderPlan& plan) {
    const std::vector<prep::Material>& materials = prepared.scene.materials;
    const prep::Consumer consumer = consumer_of(plan);
    std::vector<MapsOfMaterial> out(materials.size());
    std::vector<std::uint32_t> with_uvs(materials.size(), 0);
    for (const std::uint32_t number : drawn.meshes) {
        const prep::VertexMesh& mesh = prepared.meshes[number];
        for (const prep::VertexMesh::Range& range : mesh.ranges) {
            if (range.triangle_count == 0 || range.material >= materials.size()) continue;
            const prep::Material& material = materials[range.material];
            const std::uint32_t skipped = plan.skips.of(range.material).maps;
            MapsOfMaterial& maps = out[range.material];
            maps.placed |= choose(plan, consumer, mesh, material, range.material).maps;
            for (const prep::MaterialMap& map : prep::material_maps) {
                const std::uint32_t bit = 1u << unsigned(map.kind);
                const prep::TextureRef& ref = material.*map.ref;
                if (!ref || (skipped & bit) != 0 || !prep::map_is_read(material, map, consumer))
                    continue;
                maps.wanted |= bit;
                if (ref.uv_set < mesh.uvs.size() && !mesh.uvs[ref.uv_set].empty())
                    with_uvs[range.material] |= bit;
                else
                    maps.uvs_missing = true;
                maps.tangents_missing |= map.kind == prep::MapKind::normal &&
                                         mesh.tangents.empty() &&
                                         material.normal_map_space == prep::NormalMapSpace::tangent;
            }
        }
    }
    for (std::size_t m = 0; m < out.size(); ++m) out[m].without_uvs = out[m].wanted & ~with_uvs[m];
    return out;
}

}  // namespace rast::detail
