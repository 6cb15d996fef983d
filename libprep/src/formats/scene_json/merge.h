// Putting a loaded file's meshes into a larger scene, once, and instancing them many times.
#pragma once

#include <string>
#include <vector>

#include "prep/scene.h"

namespace prep::detail {

// What one file brought: its meshes in the larger scene, and its nodes as a template.
struct MergedPart {
    std::uint32_t first_mesh = 0, mesh_count = 0;
    std::vector<Node> nodes;  // parents within this list; meshes in the larger scene
};

// Moves meshes, materials, textures and images over; lights, cameras, skins, animations and the
// retained document are left behind with a note in into.warnings. `name` is for that note.
MergedPart merge_scene(Scene& into, Scene&& part, const std::string& name);

// Adds copies of the part's nodes under `parent` (or at the root).
void instance_part(Scene& scene, const MergedPart& part, std::uint32_t parent);

}  // namespace prep::detail
