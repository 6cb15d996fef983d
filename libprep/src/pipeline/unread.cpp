// What is prepared for one picture alone carries nothing that this picture does not read.
#include <algorithm>

#include "pipeline/mesh_preparation.h"

namespace prep::detail {
namespace {

// Formats number UV sets from 0 on without holes: those below one that is read stay.
std::size_t uv_set_count_of(const AttributeReads& reads) {
    return reads.uv_sets.empty() ? 0 : std::size_t(reads.uv_sets.back()) + 1;
}

// By material: whether it is that of points or lines, which no picture has: somebody else reads it.
std::vector<bool> is_of_loose_parts(const Scene& scene) {
    std::vector<bool> result(scene.materials.size(), false);
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.points.empty() && mesh.line_vertices.empty()) continue;
        const MeshContents contents = contents_of(mesh, result.size());
        for (const auto* list : {&contents.materials, &contents.variants})
            for (const std::uint32_t m : *list) result[m] = true;
    }
    return result;
}

bool is_drawn_as_itself(const Scene& scene, std::uint32_t material, const Consumer& consumer) {
    const std::vector<const Material*> drawn = drawn_as(scene, material, consumer);
    return std::find(drawn.begin(), drawn.end(), &scene.materials[material]) != drawn.end();
}

}  // namespace

// Called when everything is computed that stands on them. Vertices are then split by what is left.
// What is not provided goes; requirements() has provided for all that is to stay.
void MeshPreparation::drop_unread() {
    if (!options_.request.consumer.exact) return;
    const AttributeReads& reads = need_.provided;
    const bool normals = !reads.normals && !mesh_.normals.empty();
    const bool tangents = !reads.tangents && !mesh_.tangents.empty();
    const bool colors = !reads.colors && !mesh_.colors.empty();
    // The textures of a document that is written back refer to their sets.
    const bool refers = options_.document_stays && mesh_.tied_to_file;
    const std::size_t uv_sets = refers ? mesh_.uvs.size() : uv_set_count_of(reads);
    if (!normals && !tangents && !colors && mesh_.uvs.size() <= uv_sets) {
        log_.skipped("unread attributes", "there is nothing else");
        return;
    }
    log_.run("unread attributes", "the picture does not read them", [&] {
        if (normals) {
            mesh_.normals = {};
            for (MorphTarget& target : mesh_.morph_targets) target.normals.clear();
            normals_made_ = limit_normals_ = false;
            out_.normals_made[index_] = false;
        }
        if (tangents) {
            mesh_.tangents = {};
            for (MorphTarget& target : mesh_.morph_targets) target.tangents.clear();
        }
        if (colors) mesh_.colors.clear();
        if (mesh_.uvs.size() > uv_sets) mesh_.uvs.resize(uv_sets);
        return true;
    });
}

void drop_unread_maps(PreparedScene& out, const PrepareOptions& options, StageLog& log) {
    const Consumer& consumer = options.request.consumer;
    // A document that is written back keeps its textures.
    const bool document = options.document_stays && out.scene.retained_file != nullptr;
    if (!consumer.exact || document) return;
    const std::vector<bool> kept = is_of_loose_parts(out.scene);
    std::string dropped;
    for (std::uint32_t m = 0; m < out.scene.materials.size(); ++m) {
        Material& material = out.scene.materials[m];
        if (kept[m]) continue;
        const bool drawn = is_drawn_as_itself(out.scene, m, consumer);
        for (const MaterialMap& map : material_maps) {
            if (!(material.*map.ref) || (drawn && map_is_read(material, map, consumer))) continue;
            material.*map.ref = {};
            if (dropped.empty())
                dropped = "the picture does not read the " + std::string(map.name) + " map of '" +
                          material.name + "'";
            else if (!dropped.ends_with(", and others"))
                dropped += ", and others";
        }
    }
    if (!dropped.empty()) log.run("unread maps", dropped, [] { return true; });
}

}  // namespace prep::detail
