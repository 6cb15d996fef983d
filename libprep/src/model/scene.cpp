#include "prep/scene.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace prep {

BlinnPhong blinn_phong(const glm::vec3& base, float metallic, float roughness,
                       const glm::vec3& reflectance) {
    const float alpha = std::max(roughness * roughness, 0.02f);
    const float shininess = std::max(2 / (alpha * alpha) - 2, 0.0f);
    const glm::vec3 reflected = reflectance + (base - reflectance) * metallic;
    return {base * (1 - metallic), reflected * highlight_spread(shininess), shininess};
}

float highlight_spread(float shininess) {
    const float width = std::max(shininess, 0.0f) + 2;
    return width / 8 + 0.5f / width;
}

Dielectric dielectric(const glm::vec3& specular, float shininess) {
    const double width = std::max(double(shininess), 0.0) + 2;
    return {glm::clamp(specular / highlight_spread(shininess), 0.0f, 1.0f),
            float(std::sqrt(std::sqrt(2 / width)))};
}

glm::vec3 usual_specular(float shininess) {
    return glm::vec3(std::min(0.04f * highlight_spread(shininess), 1.0f));
}

std::vector<std::filesystem::path> files_of(const ImageRef& image) {
    std::vector<std::filesystem::path> files;
    if (const std::filesystem::path& file = image.bytes.empty() ? image.path : image.read_from;
        !file.empty())
        files.push_back(file);
    for (const PackedChannel& channel : image.channels)
        if (channel.source)
            for (std::filesystem::path& file : files_of(*channel.source))
                files.push_back(std::move(file));
    return files;
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

namespace {

// By a power of two; zero and what is not finite stay as they are.
glm::dmat3 scaled_to_one(const glm::dmat3& m) {
    double most = 0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) most = std::max(most, std::abs(m[c][r]));
    if (!(most > 0) || !std::isfinite(most)) return m;
    // In two steps, because 2^-exponent itself can overflow.
    const int e = -std::ilogb(most);
    return m * std::ldexp(1.0, e / 2) * std::ldexp(1.0, e - e / 2);
}

}  // namespace

glm::dmat3 normal_matrix(const glm::dmat3& linear) {
    const glm::dmat3 m = scaled_to_one(linear);
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]),
                               glm::cross(m[0], m[1]));
    return scaled_to_one(mirrors(m) ? -cofactors : cofactors);
}

bool mirrors(const glm::dmat3& linear) {
    const glm::dmat3 m = scaled_to_one(linear);
    return glm::dot(m[0], glm::cross(m[1], m[2])) < 0;
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

void place_scene(Scene& scene, double scale, Axis up) {
    if (scale == 1 && up == Axis::y) return;
    // A document that is written back keeps its own nodes, and the meshes that none of them has.
    if (!scene.retained_file) instance_unused_meshes(scene);
    Node above;
    above.name = "placement";
    Trs trs;
    const double half = std::sqrt(0.5);
    if (up == Axis::x) trs.rotation = glm::dquat(half, 0, 0, half);
    if (up == Axis::z) trs.rotation = glm::dquat(half, -half, 0, 0);
    trs.scale = glm::dvec3(scale);
    // A quarter turn has no rounding.
    const glm::dvec3 zero(0.0);
    glm::dmat4 turn(1.0);
    if (up == Axis::x)
        turn = glm::dmat4(glm::dvec4(0, 1, 0, 0), glm::dvec4(-1, 0, 0, 0), glm::dvec4(0, 0, 1, 0),
                          glm::dvec4(zero, 1));
    if (up == Axis::z)
        turn = glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 0, -1, 0), glm::dvec4(0, 1, 0, 0),
                          glm::dvec4(zero, 1));
    for (int c = 0; c < 3; ++c) turn[c] *= scale;
    above.trs = trs;
    above.transform = turn;
    const auto self = static_cast<std::uint32_t>(scene.nodes.size());
    for (Node& node : scene.nodes)
        if (node.parent == no_index) node.parent = self;
    scene.nodes.push_back(std::move(above));
    for (Camera& camera : scene.cameras) {
        camera.znear *= scale;
        camera.zfar *= scale;
        camera.xmag *= scale;
        camera.ymag *= scale;
    }
    for (Light& light : scene.lights) light.range = float(light.range * scale);
    scene.placement.scale *= scale;
    scene.placement.up = up;
}

}  // namespace prep
