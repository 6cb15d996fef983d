#include "meshprep/output/conventions_text.h"

#include <fmt/format.h>

#include <set>

#include "meshprep/output/console.h"
#include "prep/requirements.h"

namespace meshprep {
namespace {

using prep::GreenDirection;
using prep::TangentMethod;
using prep::TangentSign;

double percent(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

std::string method_text(const prep::TangentConventions& t) {
    const char* verdict = t.method == TangentMethod::mikktspace ? "MikkTSpace"
                          : t.method == TangentMethod::similar  ? "similar to MikkTSpace"
                          : t.method == TangentMethod::other    ? "not MikkTSpace"
                                                                : "too few to tell by";
    std::string text = fmt::format(
        "tangents: {} ({:.1f} % of {} corners within 1°, {:.1f} % within 5°, {:.1f} % to the last "
        "bit; median {:.3g}°, largest {:.3g}°)",
        verdict, percent(t.within_1, t.compared), with_commas(t.compared),
        percent(t.within_5, t.compared), percent(t.identical, t.compared), t.median_degrees,
        t.largest_degrees);
    if (2 * t.opposite > t.compared)
        text += fmt::format("; {:.1f} % point the other way", percent(t.opposite, t.compared));
    return text;
}

std::string sign_text(const prep::TangentConventions& t) {
    const char* verdict = t.sign == TangentSign::as_gltf    ? "as glTF's"
                          : t.sign == TangentSign::inverted ? "looks inverted"
                          : t.sign == TangentSign::mixed    ? "agrees with no convention"
                                                            : "too few to tell by";
    return fmt::format("tangent sign: {} (w is glTF's at {:.1f} % of the corners)", verdict,
                       percent(t.same_sign, t.compared));
}

std::string green_text(const MapConventions& map) {
    if (!map.unreadable.empty())
        return fmt::format("normal map {}: not readable: {}", map.image, map.unreadable);
    const prep::GreenChannel& g = map.green;
    const char* verdict = "no telling where green points";
    if (g.direction == GreenDirection::up)
        verdict = map.marked_down ? "green points up, though the material says down"
                                  : "green points up, as glTF has it";
    if (g.direction == GreenDirection::down)
        verdict = map.marked_down ? "green points down, as the material says"
                                  : "green looks flipped: it points down, as in DirectX";
    std::vector<std::string> sizes;
    for (std::size_t s = 0; s < prep::GreenChannel::scales; ++s)
        sizes.push_back(g.texels[s] > 0 ? fmt::format("{:+.2f}", g.correlations[s]) : "–");
    return fmt::format(
        "normal map {}: {} (slopes correlate by {:+.2f}; at full size to 1/16: {}; {} bumpy "
        "texels)",
        map.image, verdict, g.correlation, fmt::join(sizes, " "), with_commas(g.texels[0]));
}

std::string image_name(const prep::Scene& scene, const prep::TextureRef& ref) {
    const prep::ImageRef& image = scene.images[scene.textures[ref.texture].image];
    if (!image.path.empty()) return image.path.filename().string();
    return image.name.empty() ? fmt::format("image {}", scene.textures[ref.texture].image)
                              : image.name;
}

std::string mesh_name(const prep::Scene& scene, std::uint32_t mesh) {
    const std::string& name = scene.meshes[mesh].name;
    return name.empty() ? fmt::format("mesh {}", mesh) : name;
}

}  // namespace

SceneConventions scene_conventions(const prep::Scene& scene, int threads) {
    SceneConventions out;
    prep::Request request;
    request.tangents = prep::Request::Level::always;
    const auto requirements = prep::requirements(scene, request);
    std::set<std::uint32_t> used;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
        const prep::Mesh& mesh = scene.meshes[m];
        used.insert(mesh.face_materials.begin(), mesh.face_materials.end());
        if (mesh.tangents.empty()) continue;
        const std::uint32_t uv_set = requirements[m].tangent_uv_set;
        const auto mixed = prep::mixed_tangent_uvs(mesh, requirements[m]);
        out.meshes.push_back({m, uv_set,
                              mixed.empty() ? prep::tangent_conventions(mesh, uv_set, threads)
                                            : prep::tangent_conventions(mesh, mixed, threads)});
    }
    std::set<std::uint32_t> seen;
    for (std::uint32_t m = 0; m < scene.materials.size(); ++m) {
        const prep::Material& material = scene.materials[m];
        const prep::TextureRef& ref = material.normal_map;
        if (!ref || used.count(m) == 0 ||
            material.normal_map_space != prep::NormalMapSpace::tangent)
            continue;
        if (ref.texture >= scene.textures.size()) continue;
        const std::uint32_t image = scene.textures[ref.texture].image;
        if (image >= scene.images.size() || !seen.insert(image).second) continue;
        MapConventions map;
        map.material = m;
        map.image = image_name(scene, ref);
        map.marked_down = material.normal_map_flip_green;
        const auto pixels = prep::load_image(scene.images[image]);
        if (pixels)
            map.green = prep::green_channel(*pixels);
        else
            map.unreadable = pixels.error().text;
        out.maps.push_back(std::move(map));
    }
    return out;
}

std::vector<std::string> conventions_text(const SceneConventions& conventions,
                                          const prep::Scene& scene) {
    std::vector<std::string> lines;
    bool inverted = false, flipped = false;
    for (const MeshConventions& mesh : conventions.meshes) {
        const std::string name = mesh_name(scene, mesh.mesh);
        if (mesh.tangents.compared == 0) {
            lines.push_back(name +
                            ": tangents: nothing to hold them against (they need normals, "
                            "and UVs with a gradient)");
            continue;
        }
        lines.push_back(name + ": " + method_text(mesh.tangents));
        lines.push_back(name + ": " + sign_text(mesh.tangents));
        inverted |= mesh.tangents.sign == TangentSign::inverted;
    }
    for (const MapConventions& map : conventions.maps) {
        lines.push_back(green_text(map));
        flipped |= map.green.direction == GreenDirection::down && !map.marked_down;
    }
    if (inverted && flipped)
        lines.emplace_back(
            "inverted signs and flipped green undo each other: computing new tangents needs the "
            "map's green turned as well");
    return lines;
}

Json to_json(const SceneConventions& conventions, const prep::Scene& scene) {
    Json json;
    json["tangents"] = Json::array();
    for (const MeshConventions& mesh : conventions.meshes) {
        const prep::TangentConventions& t = mesh.tangents;
        json["tangents"].push_back({{"mesh", mesh_name(scene, mesh.mesh)},
                                    {"uv_set", mesh.uv_set},
                                    {"method", prep::name_of(t.method)},
                                    {"sign", prep::name_of(t.sign)},
                                    {"compared", t.compared},
                                    {"identical", t.identical},
                                    {"within_1_degree", t.within_1},
                                    {"within_5_degrees", t.within_5},
                                    {"opposite", t.opposite},
                                    {"same_sign", t.same_sign},
                                    {"median_degrees", t.median_degrees},
                                    {"largest_degrees", t.largest_degrees}});
    }
    json["normal_maps"] = Json::array();
    for (const MapConventions& map : conventions.maps) {
        Json entry = {{"image", map.image},
                      {"material", scene.materials[map.material].name},
                      {"green", prep::name_of(map.green.direction)},
                      {"correlation", map.green.correlation},
                      {"correlations", map.green.correlations},
                      {"texels", map.green.texels}};
        if (!map.unreadable.empty()) entry["unreadable"] = map.unreadable;
        json["normal_maps"].push_back(std::move(entry));
    }
    return json;
}

}  // namespace meshprep
