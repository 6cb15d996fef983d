#include "prep/scene.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

namespace prep {

BlinnPhong blinn_phong(const glm::vec3& base, float metallic, float roughness) {
    const float alpha = std::max(roughness * roughness, 0.02f);
    const float shininess = std::max(2 / (alpha * alpha) - 2, 0.0f);
    const glm::vec3 reflectance = glm::vec3(0.04f) + (base - glm::vec3(0.04f)) * metallic;
    const float width = shininess + 2;
    return {base * (1 - metallic), reflectance * (width / 8 + 0.5f / width), shininess};
}

glm::dmat4 Trs::matrix() const {
    glm::dmat4 result = glm::mat4_cast(rotation);
    for (int c = 0; c < 3; ++c) result[c] *= scale[c];
    result[3] = glm::dvec4(translation, 1);
    return result;
}

std::size_t morph_target_count(const Scene& scene) {
    std::size_t count = 0;
    for (const Mesh& mesh : scene.meshes) count += mesh.morph_targets.size();
    return count;
}

std::vector<glm::dmat4> world_transforms(const Scene& scene) {
    const std::size_t n = scene.nodes.size();
    std::vector<glm::dmat4> world(n, glm::dmat4(1.0));
    std::vector<bool> done(n, false);
    std::vector<std::uint32_t> chain;
    for (std::uint32_t i = 0; i < n; ++i) {
        // Walk up to the nearest finished ancestor, then come back down: no recursion, so that a
        // chain of a million nodes is as safe as a flat list.
        chain.clear();
        for (std::uint32_t k = i; k != no_index && !done[k]; k = scene.nodes[k].parent)
            chain.push_back(k);
        while (!chain.empty()) {
            const std::uint32_t k = chain.back();
            chain.pop_back();
            const Node& node = scene.nodes[k];
            world[k] =
                node.parent == no_index ? node.transform : world[node.parent] * node.transform;
            done[k] = true;
        }
    }
    return world;
}

void instance_unused_meshes(Scene& scene) {
    std::vector<bool> used(scene.meshes.size(), false);
    for (const Node& node : scene.nodes)
        if (node.mesh != no_index) used[node.mesh] = true;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
        if (used[m]) continue;
        Node node;
        node.name = scene.meshes[m].name;
        node.mesh = m;
        scene.nodes.push_back(std::move(node));
    }
}

}  // namespace prep
