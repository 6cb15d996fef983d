// Pictures of a rewritten document.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "formats/gltf/appended_data.h"
#include "formats/gltf/document.h"
#include "prep/scene.h"

namespace prep::detail {

// Pictures beside the source would be lost to an output elsewhere: they move into the buffer. note:
// is told of those that cannot.
void embed_pictures(const std::vector<ImageRef>& images, Json& json, AppendedData& appended,
                    const std::function<void(const std::string&)>& note);

}  // namespace prep::detail
