// A document whose scene was scaled or turned after it was read.
#pragma once

#include "formats/gltf/appended_data.h"
#include "formats/gltf/document.h"
#include "prep/scene.h"

namespace prep::detail {

// Puts what place_scene() set above the scene's nodes above the roots of each of the document's
// scenes, and scales clip planes, ranges of lights, how far light goes in a volume, and the keys of
// animations of these. Nothing where nothing was placed. Errors: unsupported (scenes that share
// roots: a node has one parent), limit (keys).
Result<void> place_document(const Scene& scene, const GltfDocument& document, Json& json,
                            AppendedData& appended);

}  // namespace prep::detail
