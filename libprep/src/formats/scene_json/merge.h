// Putting a loaded file's meshes into a larger scene, once, and instancing them many times.
#pragma once

#include <string>
#include <unordered_set>
#include <vector>

#include "prep/scene.h"

namespace prep::detail {

// What one file brought: its meshes in the larger scene, and its nodes as a template.
struct MergedPart {
    std::uint32_t first_mesh = 0, mesh_count = 0;
    std::vector<Node> nodes;  // parents within this list; meshes in the larger scene
};

// Names of the files that are in into.libraries: a scene may have many.
using ReadFiles = std::unordered_set<std::string>;

// Moves meshes, materials, textures and images over, and notes the files that they were read from;
// lights, cameras, skins, animations, morph targets, attributes of other names and the retained
// document are left behind with a note in into.warnings. `name` is for that note, `files` for all
// parts of one scene.
MergedPart merge_scene(Scene& into, Scene&& part, const std::string& name, ReadFiles& files);

// Adds copies of the part's nodes under `parent` (or at the root).
void instance_part(Scene& scene, const MergedPart& part, std::uint32_t parent);

}  // namespace prep::detail
