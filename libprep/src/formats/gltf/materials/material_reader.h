// Materials, textures, samplers and images of a glTF document.
#pragma once

#include "formats/gltf/document.h"

namespace prep::detail {

Result<void> read_gltf_materials(const GltfDocument& document, Scene& scene);

}  // namespace prep::detail
