#include "sheets/surfaces/displacement_views.h"

#include <algorithm>
#include <bit>
#include <vector>

#include "sheets/subject.h"

namespace report {
namespace {

using prep::Material;
using prep::Result;

constexpr std::uint32_t coarser = 32;  // times fewer triangles

// Texels a side: all materials' maps together have about as many as the picture has pixels.
std::uint32_t residual_size(std::size_t materials, std::uint32_t pixels) {
    const std::uint64_t side = std::bit_ceil(std::clamp(pixels, 64u, 1024u));
    std::uint64_t size = side;
    while (size > 64 && size * size * materials > side * side) size /= 2;
    return static_cast<std::uint32_t>(size);
}

// The picture that displaces every face, in place of the materials' bump and normal maps.
void bump_all(prep::Scene& scene, const prep::DisplaceOptions& options) {
    prep::Texture texture;
    texture.image = static_cast<std::uint32_t>(scene.images.size());
    texture.wrap_u = options.heights.wrap_u;
    texture.wrap_v = options.heights.wrap_v;
    scene.images.push_back(*options.map);
    prep::TextureRef bump = options.heights.placement;
    bump.texture = static_cast<std::uint32_t>(scene.textures.size());
    bump.uv_set = options.uv_set;
    bump.strength = static_cast<float>(options.heights.scale);
    scene.textures.push_back(texture);
    // Faces without a material get one.
    const auto plain = static_cast<std::uint32_t>(scene.materials.size());
    scene.materials.emplace_back();
    for (prep::Mesh& mesh : scene.meshes) {
        if (mesh.face_materials.empty()) mesh.face_materials.assign(mesh.face_count(), plain);
        for (std::uint32_t& m : mesh.face_materials) m = std::min(m, plain);
    }
    for (Material& m : scene.materials) {
        m.bump_map = bump;
        m.normal_map = {};
    }
}

void bump_by_materials(prep::Scene& scene, const prep::DisplaceOptions& options) {
    for (Material& m : scene.materials) {
        m.bump_map = m.displacement_map;
        m.bump_map.strength *= m.displacement_scale * static_cast<float>(options.heights.scale);
        m.normal_map = {};
    }
}

std::string why_no_bump(const prep::Scene& scene, const prep::DisplaceOptions& options) {
    if (options.noise) return "Noise is no picture: no bump map holds it.";
    const auto is_vector = [](const Material& m) {
        return m.displacement_map && m.displacement_kind != prep::DisplacementKind::height;
    };
    if (options.map ? options.kind != prep::DisplacementKind::height
                    : std::any_of(scene.materials.begin(), scene.materials.end(), is_vector))
        return "Vector maps move points sideways, which no bump map shows.";
    if (options.heights.channel != 0) return "Bump maps are read from the first channel alone.";
    return {};
}

std::uint64_t tessellated_triangles(const prep::PreparedScene& scene) {
    std::uint64_t sum = 0;
    for (const auto& certificate : scene.tessellated)
        if (certificate) sum += certificate->triangles;
    return sum;
}

// What a material has of its own is no part of the relief.
void keep_residual_maps(prep::PreparedScene& scene) {
    std::vector<bool> made(scene.scene.materials.size(), false);
    for (const prep::ResidualMap& map : scene.residual_maps)
        if (map.material < made.size()) made[map.material] = true;
    for (std::size_t m = 0; m < made.size(); ++m) {
        scene.scene.materials[m].bump_map = {};
        if (!made[m]) scene.scene.materials[m].normal_map = {};
    }
}

// Meshes in proportion: the goal is one for each of them.
std::uint64_t coarse_goal(const prep::PreparedScene& scene) {
    std::uint64_t meshes = 0;
    for (const auto& certificate : scene.tessellated) meshes += certificate.has_value();
    return std::max<std::uint64_t>(
        tessellated_triangles(scene) / coarser / std::max<std::uint64_t>(meshes, 1), 2);
}

}  // namespace

DisplacementViews make_displacement_views(const prep::Scene& scene,
                                          const prep::PrepareOptions& options,
                                          const prep::PreparedScene& displaced,
                                          std::uint32_t pixels) {
    DisplacementViews out;
    if (tessellated_triangles(displaced) == 0) {
        out.no_bumped = out.no_coarse = "No mesh was displaced.";
        return out;
    }
    const prep::DisplaceOptions& displacement = options.displacement;
    prep::PrepareOptions asked = options;
    asked.keep_cages = false;
    out.no_bumped = why_no_bump(scene, displacement);
    if (out.no_bumped.empty()) {
        prep::Scene bare = scene;
        if (displacement.map)
            bump_all(bare, displacement);
        else
            bump_by_materials(bare, displacement);
        asked.displacement = {};
        Result<prep::PreparedScene> made = prep::prepare(std::move(bare), asked);
        if (made)
            out.bumped = *std::move(made);
        else
            out.no_bumped = "Not made: " + to_string(made.error());
    }
    asked.displacement = displacement;
    asked.displacement.residual =
        prep::ResidualMapOptions{residual_size(scene.materials.size(), pixels), 16};
    prep::TessellateOptions& fineness = asked.tessellation;
    fineness.chord_error = fineness.edge_length = fineness.pixel_error = {};
    fineness.max_triangles = coarse_goal(displaced);
    Result<prep::PreparedScene> made = prep::prepare(scene, asked);
    if (!made) {
        out.no_coarse = "Not made: " + to_string(made.error());
    } else if (made->residual_maps.empty()) {
        out.no_coarse = "No residual normal map can be made:";
        for (const prep::Finding& f : made->findings)
            if (f.kind == "no-residual-map") {
                out.no_coarse += " " + f.text;
                break;
            }
    } else {
        out.coarse = *std::move(made);
        keep_residual_maps(*out.coarse);
    }
    return out;
}

DisplacementViews views_of_mesh(const DisplacementViews& views, std::uint32_t mesh) {
    DisplacementViews out{{}, views.no_bumped, {}, views.no_coarse};
    if (views.bumped) out.bumped = mesh_subject(*views.bumped, mesh).scene;
    if (views.coarse) out.coarse = mesh_subject(*views.coarse, mesh).scene;
    return out;
}

prep::PreparedScene with_relief_alone(prep::PreparedScene scene, const Material& model) {
    const auto last = static_cast<std::uint32_t>(scene.scene.materials.size());
    for (Material& m : scene.scene.materials) {
        Material plain = model;
        plain.bump_map = m.bump_map;
        plain.normal_map = m.normal_map;
        m = plain;
    }
    scene.scene.materials.push_back(model);
    for (prep::VertexMesh& mesh : scene.meshes) {
        mesh.colors.clear();
        for (prep::VertexMesh::Range& range : mesh.ranges)
            range.material = std::min(range.material, last);
    }
    return scene;
}

}  // namespace report
