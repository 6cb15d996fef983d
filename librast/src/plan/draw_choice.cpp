#include "plan/draw_choice.h"

#include <algorithm>

#include "plan/frame_pass.h"

namespace rast {
namespace detail {

prep::Consumer consumer_for(const RenderRequest& r, bool lights) {
    prep::Consumer c;
    c.exact = true;
    c.shading = r.shading;
    c.textures = r.textures || !r.prune;
    c.colors = r.keep_color || !r.prune;
    c.normals = r.keep_normals;
    c.uvs = r.keep_uvs;
    c.lights = lights || !r.prune;
    return c;
}

std::size_t texture_slot(std::size_t textures, prep::MapKind kind, const prep::TextureRef& ref) {
    if (ref.texture >= textures) return prep::no_index;
    const std::size_t use = prep::material_maps[std::size_t(kind)].color ? 0
                            : kind == prep::MapKind::bump                ? 2
                                                                         : 1;
    return use * textures + ref.texture;
}

DrawChoice choose(const RenderPlan& plan, const prep::Consumer& consumer,
                  const prep::VertexMesh& mesh, const prep::Material& material,
                  std::uint32_t number) {
    const RenderRequest& r = plan.request;
    const PlanSkips::OfMaterial skips = plan.skips.of(number);
    DrawChoice choice;
    choice.masked = material.alpha_mode == prep::AlphaMode::mask && !skips.mask;
    choice.highlights = !skips.highlights;
    if (r.shading == Shading::flat || mesh.normals.empty()) choice.source = NormalSource::face;
    for (const prep::MaterialMap& map : prep::material_maps) {
        if (map.use == prep::MapUse::not_drawn) break;
        const std::uint32_t bit = 1u << unsigned(map.kind);
        if ((skips.maps & bit) != 0 || !prep::map_is_read(material, map, consumer)) continue;
        const prep::TextureRef& ref = material.*map.ref;
        const bool there =
            ref && r.textures && ref.uv_set < mesh.uvs.size() && !mesh.uvs[ref.uv_set].empty();
        if (map.kind == prep::MapKind::bump) {
            if (choice.source == NormalSource::face) continue;
            choice.could_be |= bit;
        } else if (map.use == prep::MapUse::normals) {
            if (mesh.normals.empty()) continue;
            const bool object = material.normal_map_space == prep::NormalMapSpace::object;
            if (!object && mesh.tangents.empty()) continue;
            // A neutral map is one in tangent space.
            if (!object) choice.could_be |= bit;
            if (there)
                choice.source = object ? NormalSource::object_map : NormalSource::tangent_map;
        } else {
            choice.could_be |= bit;
        }
        if (there) choice.maps |= bit;
    }
    return choice;
}

}  // namespace detail

prep::Consumer consumer_of(const RenderPlan& plan) {
    prep::Consumer consumer = detail::consumer_for(
        plan.request,
        std::any_of(plan.lights.begin(), plan.lights.end(), [](const LightInstance& light) {
            return light.kind != prep::LightKind::ambient;
        }));
    consumer.normals |= detail::passes_read_normals(plan);
    return consumer;
}

std::vector<prep::AttributeReads> reads_of(const prep::PreparedScene& scene,
                                           const RenderPlan& plan) {
    const prep::Consumer consumer = consumer_of(plan);
    std::vector<prep::AttributeReads> reads;
    for (const prep::VertexMesh& mesh : scene.meshes)
        reads.push_back(prep::reads_of(prep::calls_for(
            scene.scene, prep::contents_of(mesh, scene.scene.materials.size()), consumer)));
    return reads;
}

}  // namespace rast
