#include "formats/gltf/compression/quantized_nodes.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <string_view>

namespace prep::detail {
namespace {

// Extensions that say nothing of which node has a mesh, or whose words are changed with it.
bool leaves_nodes_alone(const std::string& name) {
    static const std::set<std::string> names{
        "KHR_mesh_quantization",   "KHR_texture_transform",   "KHR_lights_punctual",
        "KHR_texture_basisu",      "KHR_xmp_json_ld",         "KHR_animation_pointer",
        "EXT_meshopt_compression", "EXT_texture_webp",        "EXT_mesh_gpu_instancing",
        "FB_ngon_encoding",        "KHR_node_visibility",     "KHR_draco_mesh_compression",
        "EXT_texture_avif",        "EXT_structural_metadata", "CESIUM_primitive_outline",
        "EXT_mesh_features",       "GODOT_single_root",       "MSFT_texture_dds"};
    return names.contains(name) || name.starts_with("KHR_materials_");
}

bool has_lengths(const Json& material) {
    const Json* const volume = extension_of(material, "KHR_materials_volume");
    const auto extras = material.find("extras");
    return volume != nullptr ||
           (extras != material.end() && extras->is_object() && extras->contains("displacement"));
}

// A skin's matrices, each after the grid's.
Result<std::vector<float>> placed_matrices(const GltfDocument& document, const Json& skin,
                                           const PositionGrid& grid) {
    const std::size_t joints = skin["joints"].size();
    std::vector<float> matrices;
    if (const auto it = skin.find("inverseBindMatrices"); it != skin.end()) {
        const auto raw = document.raw_accessor(it->get<std::size_t>());
        if (!raw) return raw.error();
        matrices = to_floats(*raw);
    } else {
        for (std::size_t j = 0; j < joints; ++j)
            for (int k = 0; k < 16; ++k) matrices.push_back(k % 5 == 0 ? 1.0f : 0.0f);
    }
    for (std::size_t m = 0; m + 16 <= matrices.size(); m += 16)
        for (std::size_t row = 0; row < 4; ++row) {
            float* const at = &matrices[m + row];
            const double moved = at[0] * grid.origin.x + at[4] * grid.origin.y +
                                 at[8] * grid.origin.z + double(at[12]);
            at[12] = float(moved);
            for (std::size_t column = 0; column < 3; ++column)
                at[4 * column] = float(at[4 * column] * grid.step);
        }
    return matrices;
}

constexpr std::size_t none = std::size_t(-1);

// The node whose weights a pointer of KHR_animation_pointer is into; `none`: into something else.
std::size_t node_of_weights(const std::string& pointer) {
    constexpr std::string_view nodes = "/nodes/", weights = "/weights";
    if (!pointer.starts_with(nodes)) return none;
    const char* const end = pointer.data() + pointer.size();
    std::size_t node = none;
    const auto [rest, failed] = std::from_chars(pointer.data() + nodes.size(), end, node);
    const std::string_view key(rest, std::size_t(end - rest));
    const bool into = key == weights || key.starts_with("/weights/");
    return failed == std::errc() && into ? node : none;
}

}  // namespace

GridNodes::GridNodes(const GltfDocument& document, Json& json, AppendedData& appended)
    : document_(document), json_(json), appended_(appended) {
    if (const auto used = json.find("extensionsUsed"); used != json.end() && used->is_array())
        for (const Json& name : *used)
            if (unknown_extension_.empty() && name.is_string() &&
                !leaves_nodes_alone(name.get<std::string>()))
                unknown_extension_ = name.get<std::string>();
    if (const auto meshes = json.find("meshes"); meshes != json.end())
        nodes_of_mesh_.resize(meshes->size());
    if (const auto skins = json.find("skins"); skins != json.end())
        users_of_skin_.resize(skins->size());
    const auto nodes = json.find("nodes");
    if (nodes == json.end()) return;
    for (std::size_t n = 0; n < nodes->size(); ++n) {
        const auto mesh = (*nodes)[n].value("mesh", none), skin = (*nodes)[n].value("skin", none);
        if (mesh < nodes_of_mesh_.size()) nodes_of_mesh_[mesh].push_back(n);
        if (skin < users_of_skin_.size()) ++users_of_skin_[skin];
    }
    channels_of_weights_.resize(nodes->size());
    find_weight_channels();
}

void GridNodes::find_weight_channels() {
    const auto animations = json_.find("animations");
    if (animations == json_.end()) return;
    for (std::size_t a = 0; a < animations->size(); ++a) {
        const auto channels = (*animations)[a].find("channels");
        if (channels == (*animations)[a].end()) continue;
        for (std::size_t c = 0; c < channels->size(); ++c) {
            const auto target = (*channels)[c].find("target");
            if (target == (*channels)[c].end()) continue;
            std::size_t node = none;
            if (target->value("path", "") == "weights") node = target->value("node", none);
            const Json* const extension = extension_of(*target, "KHR_animation_pointer");
            if (extension != nullptr && extension->contains("pointer") &&
                (*extension)["pointer"].is_string())
                node = node_of_weights((*extension)["pointer"].get<std::string>());
            if (node < channels_of_weights_.size()) channels_of_weights_[node].push_back({a, c});
        }
    }
}

std::string GridNodes::no_place_for_grid(std::size_t mesh) const {
    if (!unknown_extension_.empty()) return "of a file with " + unknown_extension_;
    for (const Json& primitive : json_["meshes"][mesh]["primitives"]) {
        std::vector<std::uint32_t> materials = materials_of_variants(primitive);
        if (const auto material = primitive.find("material"); material != primitive.end())
            materials.push_back(material->get<std::uint32_t>());
        for (const std::uint32_t m : materials)
            if (has_lengths(json_["materials"].at(m)))
                return "whose materials have lengths of their own";
    }
    for (const std::size_t n : nodes_of_mesh_[mesh])
        if (extension_of(json_["nodes"][n], "EXT_mesh_gpu_instancing") != nullptr)
            return "with instances";
    return nodes_of_mesh_[mesh].empty() ? "that no node has" : "";
}

std::map<std::size_t, std::size_t> GridNodes::skins_of(std::size_t mesh) const {
    std::map<std::size_t, std::size_t> users;
    for (const std::size_t n : nodes_of_mesh_[mesh])
        if (const auto skin = json_["nodes"][n].value("skin", none); skin != none) ++users[skin];
    return users;
}

Result<bool> GridNodes::matrices_hold(std::size_t mesh, const PositionGrid& grid) const {
    if (grid.neutral()) return true;
    for (const auto& [skin, users] : skins_of(mesh)) {
        const auto matrices = placed_matrices(document_, json_["skins"][skin], grid);
        if (!matrices) return matrices.error();
        for (std::size_t m = 0; m + 16 <= matrices->size(); m += 16) {
            float largest = 0;
            for (std::size_t k = 0; k < 16; ++k) {
                const float v = (*matrices)[m + k];
                if (!std::isfinite(v)) return false;
                if (k < 12) largest = std::max(largest, std::abs(v));
            }
            if (!std::isnormal(largest)) return false;
        }
    }
    return true;
}

Result<std::size_t> GridNodes::placed_skin(std::size_t skin, std::size_t users,
                                           const PositionGrid& grid) {
    const auto matrices = placed_matrices(document_, json_["skins"][skin], grid);
    if (!matrices) return matrices.error();
    std::vector<std::byte> bytes(matrices->size() * sizeof(float));
    std::memcpy(bytes.data(), matrices->data(), bytes.size());
    if (users < users_of_skin_[skin]) {
        users_of_skin_[skin] -= users;
        Json copy = json_["skins"][skin];
        skin = json_["skins"].size();
        json_["skins"].push_back(std::move(copy));
    }
    json_["skins"][skin]["inverseBindMatrices"] =
        appended_.add_accessor({{"bufferView", appended_.add_view(std::move(bytes), 0, 0)},
                                {"componentType", 5126},
                                {"count", matrices->size() / 16},
                                {"type", "MAT4"}});
    return skin;
}

void GridNodes::move_weight_channels(std::size_t from, std::size_t to) {
    for (const auto& [animation, channel] : channels_of_weights_[from]) {
        Json& target = json_["animations"][animation]["channels"][channel]["target"];
        if (target.value("path", "") == "weights" && target.value("node", none) == from)
            target["node"] = to;
        const Json* const extension = extension_of(target, "KHR_animation_pointer");
        if (extension == nullptr) continue;
        const std::string pointer = (*extension)["pointer"].get<std::string>();
        const std::string rest = pointer.substr(pointer.find("/weights"));
        target["extensions"]["KHR_animation_pointer"]["pointer"] =
            "/nodes/" + std::to_string(to) + rest;
    }
}

Result<void> GridNodes::place_grid(std::size_t mesh, const PositionGrid& grid) {
    if (grid.neutral()) return {};
    std::map<std::size_t, std::size_t> placed;  // skins
    for (const auto& [skin, users] : skins_of(mesh)) {
        const auto made = placed_skin(skin, users, grid);
        if (!made) return made.error();
        placed[skin] = *made;
    }
    for (const std::size_t n : nodes_of_mesh_[mesh]) {
        Json child{{"mesh", mesh},
                   {"translation", {grid.origin.x, grid.origin.y, grid.origin.z}},
                   {"scale", {grid.step, grid.step, grid.step}}};
        Json& node = json_["nodes"][n];
        if (const auto weights = node.find("weights"); weights != node.end())
            child["weights"] = *weights;
        const auto skin = node.value("skin", none);
        if (skin != none) child["skin"] = placed.at(skin);
        for (const char* key : {"mesh", "weights", "skin"}) node.erase(key);
        const std::size_t to = json_["nodes"].size();
        node["children"].push_back(to);
        json_["nodes"].push_back(std::move(child));
        move_weight_channels(n, to);
    }
    return {};
}

}  // namespace prep::detail
