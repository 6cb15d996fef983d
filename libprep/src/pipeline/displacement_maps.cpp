#include "pipeline/displacement_maps.h"

#include <fmt/format.h>

#include "tessellation/height_functions.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

Index material_of(const Mesh& mesh, std::size_t face) {
    return mesh.face_materials.empty() ? no_index : mesh.face_materials[face];
}

// Every face with this material (every face: no_index) has UVs in the set.
Result<void> check_uvs(const Mesh& mesh, Index material, Index uv_set, const std::string& picture) {
    const bool has_set = uv_set < mesh.uvs.size() && !mesh.uvs[uv_set].empty();
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        if (material != no_index && material_of(mesh, f) != material) continue;
        for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            if (!has_set || mesh.uvs[uv_set].indices[c] == no_index)
                return Error{ErrorCode::invalid,
                             fmt::format("face {} has no UVs in set {}, at which {} is read: "
                                         "displacement by a map needs them",
                                         f, uv_set, picture),
                             mesh.name.empty() ? "" : fmt::format("mesh '{}'", mesh.name)};
    }
    return {};
}

}  // namespace

Result<const Image*> DisplacementMaps::picture(const ImageRef& ref) {
    std::unique_ptr<const Image>& known = pictures_[&ref];
    if (!known) {
        auto image = load_image(ref);
        if (!image) return image.error();
        known = std::make_unique<const Image>(*std::move(image));
    }
    return known.get();
}

Result<void> DisplacementMaps::add(const ImageRef& image, const HeightMapOptions& heights,
                                   Index uv_set, const Mesh& mesh, Index material, OfMesh& to) {
    const std::string name = image.path.empty() ? image.name : image.path.filename().string();
    if (!maps_.contains(material)) {
        const auto pixels = picture(image);
        if (!pixels) return pixels.error();
        auto made = HeightMap::make(**pixels, heights);
        if (!made) {
            Error error = std::move(made).error();
            if (error.place.empty()) error.place = name;
            return error;
        }
        maps_.emplace(material, *std::move(made));
    }
    const HeightMap& map = maps_.at(material);
    if (auto checked = check_uvs(mesh, material, uv_set, name); !checked) return checked.error();
    to.names.push_back(name);
    to.quantisations.push_back(map.quantisation());
    to.displacements.push_back(
        {.height = height_function(map, &mesh, uv_set, material, threads_), .uv_set = uv_set});
    return {};
}

Result<DisplacementMaps::OfMesh> DisplacementMaps::of(const Scene& scene, const Mesh& mesh) {
    OfMesh out;
    HeightMapOptions heights = options_.heights;
    heights.threads = threads_;
    heights.band_limited = false;  // errors are measured against the map as it is
    heights.midlevel = options_.midlevel.value_or(HeightMapOptions{}.midlevel);
    if (options_.map) {
        auto added = add(*options_.map, heights, options_.uv_set, mesh, no_index, out);
        if (!added) return added.error();
        return out;
    }
    if (!options_.from_materials) return out;
    out.material_displacements.assign(scene.materials.size(), no_index);
    std::vector<bool> used(scene.materials.size(), false);
    for (const Index m : mesh.face_materials)
        if (m < used.size()) used[m] = true;
    for (Index m = 0; m < scene.materials.size(); ++m) {
        const Material& material = scene.materials[m];
        const TextureRef& ref = material.displacement_map;
        if (!used[m] || ref.texture >= scene.textures.size()) continue;
        const Texture& texture = scene.textures[ref.texture];
        if (texture.image >= scene.images.size()) continue;
        if (material.displacement_kind != DisplacementKind::height) {
            ++out.vector_maps;
            continue;
        }
        HeightMapOptions of_material = heights;
        of_material.wrap_u = texture.wrap_u;
        of_material.wrap_v = texture.wrap_v;
        of_material.placement = ref;
        of_material.scale *= double(material.displacement_scale) * double(ref.strength);
        of_material.midlevel = options_.midlevel.value_or(double(material.displacement_midlevel));
        out.material_displacements[m] = Index(out.displacements.size());
        auto added = add(scene.images[texture.image], of_material, ref.uv_set, mesh, m, out);
        if (!added) return added.error();
        used_.insert(m);
    }
    if (out.displacements.empty()) out.material_displacements.clear();
    return out;
}

void DisplacementMaps::forget(Scene& scene) const {
    for (const Index m : used_) scene.materials[m].displacement_map = {};
}

}  // namespace prep::detail
