#include "meshprep/options/consumer_option.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <set>
#include <utility>

#include "base/atomic_files.h"
#include "meshprep/options/values.h"
#include "rast/view.h"

namespace meshprep {
namespace {

bool on_or_off(const std::string& key, const std::string& word) {
    if (word != "on" && word != "off")
        usage_error("--for", key + " is on or off, found '" + word + "'");
    return word == "on";
}

void parse_choice(const std::string& key, const std::string& value, prep::Consumer& c) {
    if (key == "shading") {
        const prep::Result<prep::Shading> shading = prep::enum_named<prep::Shading>(value);
        if (!shading) usage_error("--for", shading.error().text);
        c.shading = *shading;
    } else if (key == "textures") {
        c.textures = on_or_off(key, value);
    } else if (key == "colors") {
        c.colors = on_or_off(key, value);
    } else if (key == "normals") {
        c.normals = on_or_off(key, value);
    } else if (key == "uvs") {
        c.uvs = on_or_off(key, value);
    } else {
        usage_error("--for", "'" + key +
                                 "' is none of shading, textures, colors, normals, uvs; nor is "
                                 "this the name of a scene file (.json)");
    }
}

void parse(const std::string& text, ConsumerWish& to) {
    to = {};
    to.consumer.exact = true;
    if (text.ends_with(".json")) {
        to.scene_file = text;
        return;
    }
    for (const std::string& word : parse_list(text)) {
        const std::size_t equals = word.find('=');
        parse_choice(word.substr(0, equals),
                     equals == std::string::npos ? "" : word.substr(equals + 1), to.consumer);
    }
}

}  // namespace

Option add_consumer_option(OptionSet& options, ConsumerWish& to) {
    return options.value(
        "--for", "SCENE.json|CHOICES", [&to](const std::string& text) { parse(text, to); },
        "Compute and write only what this one picture reads: by the shading, the lights "
        "and the materials of a scene file, or as in "
        "shading=phong,textures=off; also colors, normals, uvs (kept buffers): on or off (default: "
        "what any renderer could read)");
}

prep::Result<ConsumerWish> read_scene_file(const ConsumerWish& wish) {
    ConsumerWish read = wish;
    if (wish.scene_file.empty()) return read;
    prep::Result<prep::JsonScene> scene = prep::load_scene_json_alone(wish.scene_file);
    if (!scene) return scene.error();
    if (scene->picture.has("shading")) read.consumer.shading = scene->picture.choices.shading;
    read.lights = has_directed_light(scene->scene);
    read.mesh_files = std::move(scene->mesh_files);
    for (prep::JsonMeshFile& of_file : read.mesh_files)
        of_file.file = prep::detail::identity_of(of_file.file);
    read.materials = std::move(scene->scene.materials);
    return read;
}

bool has_directed_light(const prep::Scene& scene) {
    const std::vector<rast::LightInstance> lights = rast::scene_lights(scene);
    return lights.empty() ||
           std::any_of(lights.begin(), lights.end(), [](const rast::LightInstance& light) {
               return light.kind != prep::LightKind::ambient;
           });
}

namespace {

// A material of the input (none: the default one), and of the scene file (none: itself).
using Replacement = std::pair<std::uint32_t, std::uint32_t>;

// What the scene file says of this mesh file. Formats rename materials: a name that the input has
// not could be any of what is written.
void add_replacements(const prep::JsonMeshFile& of_file, const prep::Scene& scene,
                      std::set<Replacement>& to) {
    std::vector<std::uint32_t> own(scene.materials.size());
    std::iota(own.begin(), own.end(), 0u);
    own.push_back(prep::no_index);
    if (of_file.material != prep::no_index) {
        for (const std::uint32_t m : own) to.emplace(m, of_file.material);
        return;
    }
    std::set<std::uint32_t> replaced;
    for (const auto& [name, material] : of_file.replaced) {
        const std::size_t before = replaced.size();
        for (const std::uint32_t m : own)
            if (m != prep::no_index && scene.materials[m].name == name) {
                to.emplace(m, material);
                replaced.insert(m);
            }
        if (replaced.size() == before)
            for (const std::uint32_t m : own) to.emplace(m, material);
    }
    for (const std::uint32_t m : own)
        if (!replaced.contains(m)) to.emplace(m, prep::no_index);
}

}  // namespace

prep::Consumer consumer_for(const ConsumerWish& wish, const prep::Scene& scene,
                            const std::filesystem::path& input,
                            const std::filesystem::path& output) {
    prep::Consumer consumer = wish.consumer;
    if (!consumer.exact) return consumer;
    consumer.lights = wish.lights.value_or(has_directed_light(scene));
    const std::filesystem::path files[] = {prep::detail::identity_of(input),
                                           prep::detail::identity_of(output)};
    std::set<Replacement> replacements;
    for (const prep::JsonMeshFile& of_file : wish.mesh_files)
        if (std::count(std::begin(files), std::end(files), of_file.file) > 0)
            add_replacements(of_file, scene, replacements);
    for (const auto& [material, drawn] : replacements)
        consumer.stand_ins.push_back({material, drawn == prep::no_index
                                                    ? std::nullopt
                                                    : std::optional(wish.materials[drawn])});
    return consumer;
}

}  // namespace meshprep
