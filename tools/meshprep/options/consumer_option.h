// `--for`: the one picture that a file is prepared for.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "meshprep/options/option_set.h"
#include "prep/calls/calls_for.h"
#include "prep/result.h"
#include "prep/scene_json.h"

namespace meshprep {

struct ConsumerWish {
    prep::Consumer consumer;           // exact where --for was given
    std::optional<bool> lights;        // a scene file's; none: those of each input decide
    std::filesystem::path scene_file;  // empty: the choices were named
    // The scene file's: what it says of mesh files that it draws, and its materials.
    std::vector<prep::JsonMeshFile> mesh_files;
    std::vector<prep::Material> materials;
};

Option add_consumer_option(OptionSet& options, ConsumerWish& to);

// What the wish's scene file says, where it names one.
prep::Result<ConsumerWish> read_scene_file(const ConsumerWish& wish);

// Whether a picture of the scene is lit by more than ambient light. As a plan has it: lights count
// where a node has them, and a scene without any gets some.
bool has_directed_light(const prep::Scene& scene);

// For an input of its own lights. Where the wish's scene file has materials for the input, or for
// the output, those are drawn.
prep::Consumer consumer_for(const ConsumerWish& wish, const prep::Scene& scene,
                            const std::filesystem::path& input,
                            const std::filesystem::path& output);

}  // namespace meshprep
