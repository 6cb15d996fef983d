// What every loader promises about a scene (mesh.h, scene.h), checked one by one: for tests and
// fuzz targets.
#pragma once

#include <string>

#include "prep/scene.h"

namespace test {

// Names the first promise that the scene breaks; empty when it keeps all.
inline std::string broken_promise(const prep::Scene& scene) {
    using prep::no_index;
    const auto offsets = [](const auto& list, std::size_t total, std::size_t least) {
        if (list.empty() || list.front() != 0 || list.back() != total) return false;
        for (std::size_t i = 1; i < list.size(); ++i)
            if (list[i] < list[i - 1] || list[i] - list[i - 1] < least) return false;
        return true;
    };
    const auto below = [](const auto& list, std::size_t count, bool none_allowed) {
        for (const auto i : list)
            if (i >= count && !(none_allowed && i == no_index)) return false;
        return true;
    };
    for (const prep::Mesh& mesh : scene.meshes) {
        const std::size_t vertices = mesh.vertex_count(), corners = mesh.corner_count();
        const auto layer = [&](const auto& l) {
            return l.empty() ||
                   (l.indices.size() == corners && below(l.indices, l.values.size(), true));
        };
        const auto per_face = [&](const auto& list, std::size_t count) {
            return list.empty() || (list.size() == mesh.face_count() && below(list, count, true));
        };
        if (!offsets(mesh.face_offsets, corners, 3)) return "face_offsets";
        if (!below(mesh.corner_vertices, vertices, false)) return "corner_vertices";
        if (!layer(mesh.normals)) return "normals";
        if (!layer(mesh.tangents)) return "tangents";
        for (const auto& uv : mesh.uvs)
            if (!layer(uv)) return "uvs";
        for (const auto& color : mesh.colors)
            if (!layer(color)) return "colors";
        if (!per_face(mesh.face_materials, scene.materials.size())) return "face_materials";
        if (!per_face(mesh.face_parts, mesh.parts.size())) return "face_parts";
        if (!mesh.face_smoothing.empty() && mesh.face_smoothing.size() != mesh.face_count())
            return "face_smoothing";
        if (!offsets(mesh.line_offsets, mesh.line_vertices.size(), 2)) return "line_offsets";
        if (!below(mesh.line_vertices, vertices, false)) return "line_vertices";
        if (!below(mesh.points, vertices, false)) return "points";
        if (!mesh.vertex_colors.empty() && mesh.vertex_colors.size() != vertices)
            return "vertex_colors";
        for (const auto& mark : mesh.hard_marks)
            if (mark.x >= vertices || mark.y >= vertices) return "hard_marks";
        for (const auto& crease : mesh.subdivision.creases)
            if (crease.v0 >= vertices || crease.v1 >= vertices) return "creases";
        for (const auto& corner : mesh.subdivision.corners)
            if (corner.vertex >= vertices) return "corners";
        if (!below(mesh.subdivision.holes, mesh.face_count(), false)) return "holes";
    }
    const auto good = [](std::uint32_t i, std::size_t count) { return i == no_index || i < count; };
    for (const prep::Node& node : scene.nodes) {
        if (!good(node.parent, scene.nodes.size())) return "node parent";
        if (!good(node.mesh, scene.meshes.size())) return "node mesh";
        if (!good(node.camera, scene.cameras.size())) return "node camera";
        if (!good(node.light, scene.lights.size())) return "node light";
        if (!good(node.skin, scene.skins.size())) return "node skin";
        std::size_t steps = 0;
        for (std::uint32_t up = node.parent; up != no_index; up = scene.nodes[up].parent) {
            if (++steps > scene.nodes.size()) return "node cycle";
            if (up >= scene.nodes.size()) return "node parent";
        }
    }
    for (const prep::Texture& texture : scene.textures)
        if (!good(texture.image, scene.images.size())) return "texture image";
    for (const prep::Material& m : scene.materials)
        for (const prep::TextureRef* ref :
             {&m.diffuse_map, &m.specular_map, &m.emissive_map, &m.occlusion_map, &m.normal_map,
              &m.bump_map, &m.displacement_map, &m.metallic_roughness_map})
            if (!good(ref->texture, scene.textures.size())) return "texture of a material";
    return {};
}

}  // namespace test
