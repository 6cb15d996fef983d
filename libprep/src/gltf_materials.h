// Materials, textures, samplers and images of a glTF document.
#pragma once

#include "gltf_document.h"

namespace prep::detail {

Result<void> read_gltf_materials(const GltfDocument& document, Scene& scene);

}  // namespace prep::detail
