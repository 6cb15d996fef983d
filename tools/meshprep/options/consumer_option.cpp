#include "meshprep/options/consumer_option.h"

#include <algorithm>

#include "meshprep/options/values.h"
#include "prep/scene_json.h"
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
        "Compute and write only what this one picture reads: by the shading and the lights of a "
        "scene file, or as in "
        "shading=phong,textures=off; also colors, normals, uvs (kept buffers): on or off (default: "
        "what any renderer could read)");
}

prep::Result<ConsumerWish> read_scene_file(const ConsumerWish& wish) {
    ConsumerWish read = wish;
    if (wish.scene_file.empty()) return read;
    const prep::Result<prep::JsonScene> scene = prep::load_scene_json(wish.scene_file);
    if (!scene) return scene.error();
    if (scene->picture.has("shading")) read.consumer.shading = scene->picture.choices.shading;
    read.lights = has_directed_light(scene->scene);
    return read;
}

bool has_directed_light(const prep::Scene& scene) {
    const std::vector<rast::LightInstance> lights = rast::scene_lights(scene);
    return lights.empty() ||
           std::any_of(lights.begin(), lights.end(), [](const rast::LightInstance& light) {
               return light.kind != prep::LightKind::ambient;
           });
}

prep::Consumer consumer_for(const ConsumerWish& wish, const prep::Scene& scene) {
    prep::Consumer consumer = wish.consumer;
    if (consumer.exact) consumer.lights = wish.lights.value_or(has_directed_light(scene));
    return consumer;
}

}  // namespace meshprep
