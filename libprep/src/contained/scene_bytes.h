// Scenes as bytes, for the way from a reader's process to the caller's, both of one build: numbers
// stand as they are in memory, so that every bit arrives. What shares values (targets, samplers)
// shares them afterwards.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "prep/result.h"
#include "prep/scene.h"

namespace prep::detail {

// Without Scene::retained_file.
std::vector<std::byte> scene_bytes(const Scene& scene);

// The bytes may be anything: what they say is held against what is there before memory is taken,
// and against what loaders promise (scene_promises.h). Error: invalid, without a location.
Result<Scene> scene_of_bytes(std::span<const std::byte> bytes);

}  // namespace prep::detail
