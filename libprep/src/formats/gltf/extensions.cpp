#include "formats/gltf/extensions.h"

#include <algorithm>
#include <set>

#include "text/note_once.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
using enum ExtensionUse;

constexpr GltfExtension table[] = {
    {"EXT_meshopt_compression", read, ""},
    {"EXT_texture_webp", read, ""},
    {"KHR_animation_pointer", read, ""},
    {"KHR_draco_mesh_compression", read, ""},
    {"KHR_lights_punctual", read, ""},
    {"KHR_materials_anisotropy", read, ""},
    {"KHR_materials_clearcoat", read, ""},
    {"KHR_materials_emissive_strength", read, ""},
    {"KHR_materials_ior", read, ""},
    {"KHR_materials_pbrSpecularGlossiness", read, ""},
    {"KHR_materials_sheen", read, ""},
    {"KHR_materials_specular", read, ""},
    {"KHR_materials_unlit", read, ""},
    {"KHR_materials_variants", read, ""},
    {"KHR_mesh_quantization", read, ""},
    {"KHR_texture_transform", read, ""},
    {"KHR_xmp_json_ld", read, ""},
    {"AGI_articulations", carried, "moves nodes"},
    {"AGI_stk_metadata", carried, "names nodes"},
    {"EXT_instance_features", carried, "numbers instances"},
    {"EXT_lights_ies", carried, "belongs to nodes"},
    {"EXT_lights_image_based", carried, "belongs to scenes"},
    {"EXT_mesh_gpu_instancing", carried, "places nodes; the instances are not drawn here"},
    {"EXT_structural_metadata", carried, "speaks of attributes, which are carried by vertex"},
    {"EXT_texture_avif", carried, "holds pictures"},
    {"GODOT_single_root", carried, "speaks of nodes"},
    {"KHR_audio_emitter", carried, "belongs to nodes"},
    {"KHR_implicit_shapes", carried, "belongs to nodes"},
    {"KHR_interactivity", carried, "speaks of nodes and materials"},
    {"KHR_materials_diffuse_transmission", carried, "belongs to materials"},
    {"KHR_materials_dispersion", carried, "belongs to materials"},
    {"KHR_materials_iridescence", carried, "belongs to materials, which are drawn without it"},
    {"KHR_materials_transmission", carried, "belongs to materials, which are drawn without it"},
    {"KHR_materials_volume", carried, "belongs to materials, which are drawn without it"},
    {"KHR_node_hoverability", carried, "belongs to nodes"},
    {"KHR_node_selectability", carried, "belongs to nodes"},
    {"KHR_node_visibility", carried, "belongs to nodes; all of them are drawn here"},
    {"KHR_physics_rigid_bodies", carried, "belongs to nodes"},
    {"KHR_texture_basisu", carried, "holds pictures, which are drawn here as a checker"},
    {"KHR_xmp", carried, "holds metadata"},
    {"MSFT_lod", carried, "chooses between nodes"},
    {"MSFT_packing_normalRoughnessMetallic", carried, "belongs to materials"},
    {"MSFT_packing_occlusionRoughnessMetallic", carried, "belongs to materials"},
    {"MSFT_texture_dds", carried, "holds pictures"},
    {"OMI_physics_body", carried, "belongs to nodes"},
    {"OMI_physics_shape", carried, "belongs to nodes"},
    {"VRM", carried, "speaks of nodes, meshes and materials"},
    {"VRMC_materials_mtoon", carried, "belongs to materials"},
    {"VRMC_node_constraint", carried, "belongs to nodes"},
    {"VRMC_springBone", carried, "belongs to nodes"},
    {"VRMC_vrm", carried, "speaks of nodes and meshes"},
    {"CESIUM_primitive_outline", remapped, "numbers the vertices along outlines"},
    {"EXT_mesh_features", remapped, "may number features by vertex"},
    {"FB_ngon_encoding", remapped,
     "says by the order of vertices which triangles were one polygon"},
    {"EXT_mesh_manifold", per_vertex, "merges vertices by their numbers"},
    {"EXT_primitive_voxels", per_vertex, "has no triangles"},
    {"KHR_gaussian_splatting", per_vertex, "draws points by rules of its own"},
    {"MSFT_meshlet", per_vertex, "numbers triangles"},
    {"KHR_accessor_float64", undecodable, "has numbers of 64 bits, which are not read here"},
    {"KHR_meshopt_compression", undecodable, "compresses vertices in a way that is not read here"},
    {"MPEG_accessor_timed", undecodable, "has vertices that change with time"},
    {"MPEG_buffer_circular", undecodable, "has vertices that change with time"},
};

bool listed(const Json& json, const char* list, std::string_view name) {
    const auto names = json.find(list);
    return names != json.end() && names->is_array() &&
           std::find(names->begin(), names->end(), Json(std::string(name))) != names->end();
}

void leave_out(Json& extensions, const std::string& name, std::vector<std::string>& notes) {
    extensions.erase(name);
    const GltfExtension* const row = gltf_extension(name);
    note_once(notes, "extension " + name + " (" + std::string(row->reason) +
                         ") no longer fits primitives whose vertices changed: left out there");
}

}  // namespace

std::span<const GltfExtension> gltf_extensions() {
    return table;
}

const GltfExtension* gltf_extension(std::string_view name) {
    const auto row = std::find_if(std::begin(table), std::end(table),
                                  [&](const GltfExtension& e) { return e.name == name; });
    return row == std::end(table) ? nullptr : row;
}

Result<std::string> required_extension(const std::string& name,
                                       const std::vector<std::string>& allowed) {
    const GltfExtension* const row = gltf_extension(name);
    const auto vouched = [&](std::string_view n) {
        return std::find(allowed.begin(), allowed.end(), n) != allowed.end();
    };
    const bool harmless = row && (row->use == read || row->use == carried || row->use == remapped);
    if (!harmless && (vouched(name) || vouched("all")) && !(row && row->use == undecodable))
        return "the file requires the extension " + name +
               ", which --allow-extension carries as it is";
    if (!row)
        return Error{ErrorCode::unsupported,
                     "the file requires the extension " + name +
                         ", which is not known here; where it says nothing about vertices or "
                         "triangles, --allow-extension " +
                         name + " carries it",
                     {}};
    if (!harmless)
        return Error{
            ErrorCode::unsupported,
            "the file requires the extension " + name + ", which " + std::string(row->reason),
            {}};
    if (row->use == read) return std::string();
    return "the required extension " + name + " is carried: it " + std::string(row->reason);
}

std::vector<Index> remapped_edges(std::span<const Index> pairs, const ChangedPrimitive& changed) {
    std::set<std::pair<Index, Index>> wanted, found;
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2)
        wanted.insert(std::minmax(pairs[i], pairs[i + 1]));
    for (std::size_t t = 0; t + 2 < changed.indices.size(); t += 3)
        for (std::size_t k = 0; k < 3; ++k) {
            const Index a = changed.indices[t + k], b = changed.indices[t + (k + 1) % 3];
            const Index old_a = changed.old_vertices[a], old_b = changed.old_vertices[b];
            if (wanted.contains(std::minmax(old_a, old_b))) found.insert(std::minmax(a, b));
        }
    std::vector<Index> out;
    for (const auto& [a, b] : found) out.insert(out.end(), {a, b});
    return out;
}

bool keeps_polygons(const ChangedPrimitive& changed) {
    for (std::size_t t = 3; t < changed.indices.size(); t += 3) {
        const Index first = changed.indices[t], before = changed.indices[t - 3];
        if ((first == before) != (changed.old_vertices[first] == changed.old_vertices[before]))
            return false;
    }
    return true;
}

bool numbers_features_by_vertex(const Json& mesh_features) {
    const auto sets = mesh_features.find("featureIds");
    return sets != mesh_features.end() && sets->is_array() &&
           std::any_of(sets->begin(), sets->end(), [](const Json& set) {
               return set.is_object() && !set.contains("attribute") && !set.contains("texture");
           });
}

void adapt_extensions(const GltfDocument& document, Json& primitive,
                      const ChangedPrimitive& changed,
                      const std::function<std::size_t(const std::vector<Index>&)>& append,
                      std::vector<std::string>& notes) {
    const auto all = primitive.find("extensions");
    if (all == primitive.end() || !all->is_object()) return;
    if (const auto it = all->find("CESIUM_primitive_outline");
        it != all->end() && it->is_object() && it->contains("indices")) {
        const auto accessor = index_member(
            document, *it, "indices", "",
            document.json.contains("accessors") ? document.json["accessors"].size() : 0);
        const auto raw =
            accessor ? document.raw_accessor(*accessor) : Result<RawAccessor>(accessor.error());
        std::vector<Index> edges;
        if (raw && raw->width == 1) edges = remapped_edges(to_indices(*raw), changed);
        if (edges.empty())
            leave_out(*all, "CESIUM_primitive_outline", notes);
        else
            (*it)["indices"] = append(edges);
    }
    if (all->contains("FB_ngon_encoding") && !keeps_polygons(changed))
        leave_out(*all, "FB_ngon_encoding", notes);
    if (const auto it = all->find("EXT_mesh_features");
        it != all->end() && it->is_object() && numbers_features_by_vertex(*it))
        leave_out(*all, "EXT_mesh_features", notes);
    for (const GltfExtension& row : table)
        if (row.use == per_vertex && all->contains(row.name) &&
            !listed(document.json, "extensionsRequired", row.name))
            leave_out(*all, std::string(row.name), notes);
    if (all->empty()) primitive.erase("extensions");
}

}  // namespace prep::detail

namespace prep {

// Polygons are runs of triangles (FB_ngon_encoding), and an extension that is not known, or is
// required and cannot be put right, may number anything.
KeptOrder GltfDocument::kept_order(std::size_t mesh, std::size_t part) const {
    const auto& parts = json["meshes"][mesh]["primitives"];
    KeptOrder kept = KeptOrder::none;
    if (part >= parts.size()) return kept;
    const auto all = parts[part].find("extensions");
    if (all == parts[part].end() || !all->is_object()) return kept;
    for (const auto& item : all->items()) {
        const detail::GltfExtension* const row = detail::gltf_extension(item.key());
        if (!row || row->use == detail::ExtensionUse::undecodable ||
            (row->use == detail::ExtensionUse::per_vertex &&
             detail::listed(json, "extensionsRequired", row->name)))
            return KeptOrder::all;
        if (row->name == "FB_ngon_encoding") kept = KeptOrder::triangles;
    }
    return kept;
}

}  // namespace prep
