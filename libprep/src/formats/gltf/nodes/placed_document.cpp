#include "formats/gltf/nodes/placed_document.h"

#include <set>

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

}  // namespace

Result<void> place_document(const Scene& scene, const GltfDocument& document, Json& json) {
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
    return {};
}

}  // namespace prep::detail
