#include "formats/gltf/nodes/placed_document.h"

#include <array>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>

namespace prep::detail {
namespace {

void scale_members(Json& object, std::initializer_list<const char*> names, double scale) {
    for (const char* name : names)
        if (object.contains(name) && object[name].is_number())
            object[name] = object[name].get<double>() * scale;
}

Json node_of(const Node& node, Json children) {
    Json out{{"name", node.name}};
    const Trs& t = *node.trs;
    if (t.rotation != glm::dquat(1, 0, 0, 0))
        out["rotation"] = {t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w};
    if (t.scale != glm::dvec3(1.0)) out["scale"] = {t.scale.x, t.scale.y, t.scale.z};
    out["children"] = std::move(children);
    return out;
}

// What a pointer of KHR_animation_pointer is into where that is a length in the scene's unit.
bool is_length(std::string_view pointer) {
    struct Length {
        std::string_view list, member;
    };
    constexpr std::string_view lights = "/extensions/KHR_lights_punctual/lights/";
    constexpr std::array lengths{
        Length{"/cameras/", "/perspective/znear"},
        Length{"/cameras/", "/perspective/zfar"},
        Length{"/cameras/", "/orthographic/znear"},
        Length{"/cameras/", "/orthographic/zfar"},
        Length{"/cameras/", "/orthographic/xmag"},
        Length{"/cameras/", "/orthographic/ymag"},
        Length{lights, "/range"},
        Length{"/materials/", "/extensions/KHR_materials_volume/attenuationDistance"},
    };
    for (const Length& length : lengths) {
        if (!pointer.starts_with(length.list) || !pointer.ends_with(length.member) ||
            pointer.size() <= length.list.size() + length.member.size())
            continue;
        const std::string_view number = pointer.substr(
            length.list.size(), pointer.size() - length.list.size() - length.member.size());
        if (number.find_first_not_of("0123456789") == std::string_view::npos) return true;
    }
    return false;
}

// Keys of lengths. A sampler may move other things as well: scaled ones are new, one for each, and
// samplers of the same keys share what was made of them.
class KeyScaling {
  public:
    KeyScaling(const GltfDocument& document, double scale, Json& json, AppendedData& appended)
        : document_(document), scale_(scale), json_(json), appended_(appended) {}

    Result<void> run() {
        if (!json_.contains("animations")) return {};
        for (Json& animation : json_["animations"]) {
            const auto channels = animation.find("channels"), samplers = animation.find("samplers");
            if (channels == animation.end() || samplers == animation.end()) continue;
            std::unordered_map<std::size_t, std::size_t> scaled;  // samplers, by the one before
            for (Json& channel : *channels) {
                const auto target = channel.find("target");
                if (target == channel.end()) continue;
                const Json* const extension = extension_of(*target, "KHR_animation_pointer");
                if (extension == nullptr || !extension->contains("pointer") ||
                    !(*extension)["pointer"].is_string() ||
                    !is_length((*extension)["pointer"].get<std::string>()))
                    continue;
                const auto own = channel.value("sampler", samplers->size());
                if (own >= samplers->size() || !(*samplers)[own].contains("output")) continue;
                const auto [at, fresh] = scaled.try_emplace(own, samplers->size());
                channel["sampler"] = at->second;
                if (!fresh) continue;
                Json sampler = (*samplers)[own];
                const auto keys = scaled_keys(sampler["output"].get<std::size_t>());
                if (!keys) return keys.error();
                sampler["output"] = *keys;
                samplers->push_back(std::move(sampler));
            }
        }
        return {};
    }

  private:
    // The accessor of what became of another's numbers.
    Result<std::size_t> scaled_keys(std::size_t accessor) {
        const auto known = keys_.find(accessor);
        if (known != keys_.end()) return known->second;
        const auto keys = document_.raw_accessor(accessor);
        if (!keys) return keys.error();
        std::vector<float> values = to_floats(*keys);
        for (float& v : values) v = float(v * scale_);
        const std::size_t count = values.size();
        bytes_ += count * sizeof(float);
        if (bytes_ > decoded_limit(document_.input_bytes))
            return Error{ErrorCode::limit,
                         "scaled keys of animations would fill " +
                             std::to_string(decoded_limit(document_.input_bytes) >> 20) + " MiB",
                         document_.place("/animations")};
        const std::size_t made = appended_.add_accessor(
            Json{{"bufferView", appended_.add_view(SharedBytes::of(std::move(values)), 0, 0)},
                 {"componentType", 5126},
                 {"count", count},
                 {"type", "SCALAR"}});
        keys_.emplace(accessor, made);
        return made;
    }

    const GltfDocument& document_;
    double scale_;
    Json& json_;
    AppendedData& appended_;
    std::unordered_map<std::size_t, std::size_t> keys_;  // accessors, by the one before
    std::uint64_t bytes_ = 0;                            // that they take
};

}  // namespace

Result<void> place_document(const Scene& scene, const GltfDocument& document, Json& json,
                            AppendedData& appended) {
    const std::size_t own = json.contains("nodes") ? json["nodes"].size() : 0;
    if (scene.nodes.size() != own + 1 || !scene.nodes.back().trs) return {};
    const Node& above = scene.nodes.back();
    std::set<std::size_t> placed;
    if (json.contains("scenes"))
        for (Json& shown : json["scenes"]) {
            if (!shown.contains("nodes") || shown["nodes"].empty()) continue;
            for (const Json& root : shown["nodes"])
                if (!placed.insert(root.get<std::size_t>()).second)
                    return Error{
                        ErrorCode::unsupported,
                        "scenes that share nodes cannot be scaled or turned: leave --scale "
                        "and --up away, or write one scene",
                        document.place("/scenes")};
            json["nodes"].push_back(node_of(above, shown["nodes"]));
            shown["nodes"] = Json::array({json["nodes"].size() - 1});
        }
    if (placed.empty() && own > 0)
        return Error{
            ErrorCode::unsupported,
            "a document without scenes shows nothing that could be scaled or turned: leave "
            "--scale and --up away",
            document.place("/scenes")};
    const double scale = above.trs->scale.x;
    if (scale == 1) return {};
    if (json.contains("cameras"))
        for (Json& camera : json["cameras"]) {
            if (camera.contains("perspective"))
                scale_members(camera["perspective"], {"znear", "zfar"}, scale);
            if (camera.contains("orthographic"))
                scale_members(camera["orthographic"], {"znear", "zfar", "xmag", "ymag"}, scale);
        }
    const auto lights = Json::json_pointer("/extensions/KHR_lights_punctual/lights");
    if (json.contains(lights))
        for (Json& light : json[lights]) scale_members(light, {"range"}, scale);
    // How far light goes before a colour is left of it; how thick things are is in their own unit.
    if (json.contains("materials"))
        for (Json& material : json["materials"])
            if (const auto volume = Json::json_pointer("/extensions/KHR_materials_volume");
                material.contains(volume))
                scale_members(material[volume], {"attenuationDistance"}, scale);
    return KeyScaling(document, scale, json, appended).run();
}

}  // namespace prep::detail
