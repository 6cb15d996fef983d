#include "formats/gltf/references.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "text/name_list.h"
#include "text/note_once.h"

namespace prep::detail {
namespace {

// Extensions whose references to accessors and bufferViews are visited below, or that have
// none. Anything else may hold indices that must not be renumbered.
bool references_known(const std::string& name) {
    static const std::set<std::string> names{
        "KHR_mesh_quantization",   "KHR_texture_transform",
        "KHR_lights_punctual",     "KHR_texture_basisu",
        "KHR_xmp_json_ld",         "KHR_animation_pointer",
        "EXT_meshopt_compression", "KHR_draco_mesh_compression",
        "EXT_texture_webp",        "EXT_mesh_gpu_instancing",
        "FB_ngon_encoding"};
    return names.contains(name) || name.starts_with("KHR_materials_");
}

// "3.0" is read as 3, and is written so: what is no reference here would be dropped.
void visit_index(Json& value, const ReferenceVisit& visit) {
    if (value.is_number_float()) {
        const double number = value.get<double>();
        if (number >= 0 && number < 0x1p53 && number == std::floor(number))
            value = std::uint64_t(number);
    }
    if (value.is_number_integer()) visit(value);
}
void visit_member(Json& object, const char* key, const ReferenceVisit& visit) {
    if (Json* const value = member(object, key)) visit_index(*value, visit);
}
void visit_members(Json& object, const ReferenceVisit& visit) {
    if (!object.is_object()) return;
    for (auto& item : object.items()) visit_index(item.value(), visit);
}

}  // namespace

void visit_accessors(Json& json, const ReferenceVisit& visit) {
    each(json, "meshes", [&](Json& mesh) {
        each(mesh, "primitives", [&](Json& primitive) {
            if (Json* attributes = member(primitive, "attributes"))
                visit_members(*attributes, visit);
            visit_member(primitive, "indices", visit);
            each(primitive, "targets", [&](Json& target) { visit_members(target, visit); });
        });
    });
    each(json, "animations", [&](Json& animation) {
        each(animation, "samplers", [&](Json& sampler) {
            visit_member(sampler, "input", visit);
            visit_member(sampler, "output", visit);
        });
    });
    each(json, "skins", [&](Json& skin) { visit_member(skin, "inverseBindMatrices", visit); });
    each(json, "nodes", [&](Json& node) {
        Json* extensions = member(node, "extensions");
        Json* instancing = extensions ? member(*extensions, "EXT_mesh_gpu_instancing") : nullptr;
        if (!instancing) return;
        if (Json* attributes = member(*instancing, "attributes")) visit_members(*attributes, visit);
    });
}

void visit_views(Json& json, const ReferenceVisit& visit) {
    each(json, "accessors", [&](Json& accessor) {
        visit_member(accessor, "bufferView", visit);
        if (Json* sparse = member(accessor, "sparse")) {
            if (Json* indices = member(*sparse, "indices"))
                visit_member(*indices, "bufferView", visit);
            if (Json* values = member(*sparse, "values"))
                visit_member(*values, "bufferView", visit);
        }
    });
    each(json, "images", [&](Json& image) { visit_member(image, "bufferView", visit); });
    each(json, "meshes", [&](Json& mesh) {
        each(mesh, "primitives", [&](Json& primitive) {
            Json* extensions = member(primitive, "extensions");
            if (Json* draco =
                    extensions ? member(*extensions, "KHR_draco_mesh_compression") : nullptr)
                visit_member(*draco, "bufferView", visit);
        });
    });
}

namespace {

// Keeps the entries of a list that `visit_all` reaches and renumbers the references.
template <class VisitAll>
std::vector<std::size_t> compact(Json& json, const char* key, bool keep_all,
                                 const VisitAll& visit_all, bool& lost_extras) {
    std::vector<std::size_t> kept;
    const auto list = json.find(key);
    if (list == json.end() || !list->is_array()) return kept;
    std::vector<bool> used(list->size(), keep_all);
    visit_all([&](Json& index) {
        const auto i = index.get<std::uint64_t>();
        if (i < used.size()) used[i] = true;
    });
    std::vector<std::size_t> renumbered(list->size(), 0);
    Json out = Json::array();
    for (std::size_t i = 0; i < list->size(); ++i) {
        if (!used[i]) {
            lost_extras |= (*list)[i].contains("extras");
            continue;
        }
        renumbered[i] = kept.size();
        kept.push_back(i);
        out.push_back(std::move((*list)[i]));
    }
    if (out.empty())
        json.erase(key);
    else
        *list = std::move(out);
    visit_all([&](Json& index) {
        const auto i = index.get<std::uint64_t>();
        if (i < renumbered.size()) index = renumbered[i];
    });
    return kept;
}

}  // namespace

bool name_all(std::span<const std::uint32_t> indices, std::size_t count) {
    if (indices.size() < count) return false;
    std::vector<std::uint8_t> named(count, 0);
    for (const std::uint32_t i : indices) {
        if (i >= count) return false;
        named[i] = 1;
    }
    return std::find(named.begin(), named.end(), 0) == named.end();
}

std::vector<std::uint32_t> number_anew(std::vector<std::uint32_t>& indices) {
    using Index = std::uint32_t;
    std::vector<Index> used;
    if (indices.empty()) return used;
    const auto [low, high] = std::minmax_element(indices.begin(), indices.end());
    const Index first = *low;
    const std::size_t range = std::size_t(*high - first) + 1;
    // A primitive's vertices mostly lie together; those that do not must not cost the whole mesh.
    if (range <= 4 * indices.size()) {
        std::vector<Index> places(range, 0);
        for (const Index i : indices) places[i - first] = 1;
        for (std::size_t v = 0; v < range; ++v) {
            if (places[v] == 0) continue;
            places[v] = Index(used.size());
            used.push_back(Index(first + v));
        }
        for (Index& i : indices) i = places[i - first];
        return used;
    }
    used = indices;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (Index& i : indices)
        i = Index(std::lower_bound(used.begin(), used.end(), i) - used.begin());
    return used;
}

void note_non_finite_data(const GltfDocument& document, Json& json,
                          std::vector<std::string>& notes) {
    const std::size_t count =
        document.json.contains("accessors") ? document.json["accessors"].size() : std::size_t(0);
    std::set<std::size_t> kept;
    visit_accessors(json, [&](Json& index) {
        const auto i = index.get<std::uint64_t>();
        if (i < count && json["accessors"][i]["componentType"] == 5126) kept.insert(i);
    });
    // Those that were left as they are have a note of their own.
    each(json, "meshes", [&](Json& mesh) {
        each(mesh, "primitives", [&](Json& primitive) {
            const ReferenceVisit leave = [&](Json& index) { kept.erase(index.get<std::size_t>()); };
            if (primitive.value("mode", 4) < 4) return;
            visit_members(primitive["attributes"], leave);
            each(primitive, "targets", [&](Json& target) { visit_members(target, leave); });
        });
    });
    NameList broken;
    for (const std::size_t i : kept) {
        const auto raw = document.raw_accessor(i);
        if (!raw) continue;
        const std::vector<float> values = to_floats(*raw);
        if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); }))
            broken.add(std::to_string(i));
    }
    if (!broken.empty())
        notes.push_back(
            "lines, points, animations, skins or instances have values that are not finite, "
            "which the format forbids; they were kept (accessors of the source: " +
            broken.text() + ")");
}

Result<PackedBuffer> pack_buffer(const GltfDocument& document, Json& json,
                                 const AppendedData& appended, std::vector<std::string>& notes) {
    PackedBuffer out;
    BinaryParts& binary = out.bytes;
    bool keep_all = false;
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
        if (Json* names = member(json, list); names && names->is_array())
            for (const Json& name : *names)
                keep_all |= !name.is_string() || !references_known(name.get<std::string>());
    if (keep_all)
        note_once(notes, "an extension is in use that may refer to any data: none was dropped");
    bool lost_extras = false;
    compact(
        json, "accessors", keep_all, [&](const ReferenceVisit& v) { visit_accessors(json, v); },
        lost_extras);
    const std::vector<std::size_t> views = compact(
        json, "bufferViews", keep_all, [&](const ReferenceVisit& v) { visit_views(json, v); },
        lost_extras);
    if (lost_extras)
        note_once(notes,
                  "extras of accessors and bufferViews whose data was replaced were left out");
    for (std::size_t v = 0; v < views.size(); ++v) {
        Json& view = json["bufferViews"][v];
        const bool compressed = extension_of(view, "EXT_meshopt_compression") != nullptr;
        SharedBytes bytes;
        if (const auto* made = appended.bytes_of(views[v])) {
            bytes = *made;
        } else if (compressed) {
            const auto stored = document.stored_view(views[v]);
            if (!stored) return stored.error();
            bytes = *stored;
        } else {
            const auto read = document.view(views[v]);
            if (!read) return read.error();
            bytes = *read;
        }
        binary.pad();
        if (compressed) {
            view["buffer"] = 1u;
            view["byteOffset"] = out.fallback_bytes;
            out.fallback_bytes += (view["byteLength"].get<std::uint64_t>() + 3) / 4 * 4;
        }
        // Only now: new keys move their siblings.
        Json& stored = compressed ? view["extensions"]["EXT_meshopt_compression"] : view;
        stored["buffer"] = 0u;
        stored["byteOffset"] = binary.size();
        stored["byteLength"] = bytes.size();
        binary.take(std::move(bytes));
    }
    json.erase("buffers");
    return out;
}

void remove_empty_lists(Json& json) {
    std::vector<std::string> empty;
    for (const auto& item : json.items())
        if (item.value().is_array() && item.value().empty()) empty.push_back(item.key());
    for (const std::string& key : empty) json.erase(key);
    if (Json* nodes = member(json, "nodes"))
        for (Json& node : *nodes)
            if (const Json* children = member(node, "children"); children && children->empty())
                node.erase("children");
    if (Json* scenes = member(json, "scenes"))
        for (Json& scene : *scenes)
            if (const Json* nodes = member(scene, "nodes"); nodes && nodes->empty())
                scene.erase("nodes");
}

}  // namespace prep::detail
