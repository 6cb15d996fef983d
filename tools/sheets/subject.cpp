#include "sheets/subject.h"

namespace report {

Subject whole_subject(const prep::PreparedScene& prepared, std::string name) {
    return {std::move(name), prepared};
}

Subject mesh_subject(const prep::PreparedScene& prepared, std::uint32_t mesh) {
    Subject subject;
    prep::PreparedScene& out = subject.scene;
    const prep::Scene& scene = prepared.scene;
    subject.name = scene.meshes[mesh].name.empty() ? "mesh " + std::to_string(mesh)
                                                   : "mesh '" + scene.meshes[mesh].name + "'";
    out.scene.source = scene.source;
    out.scene.meshes = {scene.meshes[mesh]};
    out.scene.materials = scene.materials;
    out.scene.textures = scene.textures;
    out.scene.images = scene.images;
    out.meshes = {prepared.meshes[mesh]};
    out.requirements = {prepared.requirements[mesh]};
    const auto of_mesh = [mesh](const std::vector<bool>& facts) {
        return std::vector<bool>{mesh < facts.size() && facts[mesh]};
    };
    out.welded = of_mesh(prepared.welded);
    out.subdivided = of_mesh(prepared.subdivided);
    out.normals_made = of_mesh(prepared.normals_made);
    if (mesh < prepared.cages.size()) out.cages = {prepared.cages[mesh]};
    if (mesh < prepared.tessellated.size()) out.tessellated = {prepared.tessellated[mesh]};
    if (mesh < prepared.tessellation_errors.size())
        out.tessellation_errors = {prepared.tessellation_errors[mesh]};
    prep::Node node;
    node.mesh = 0;
    const std::vector<glm::dmat4> world = prep::world_transforms(scene);
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
        if (scene.nodes[n].mesh != mesh) continue;
        node.transform = world[n];
        break;
    }
    out.scene.nodes.push_back(std::move(node));
    return subject;
}

}  // namespace report
