// Which channels of which pictures are put together: MTL and FBX name a picture for each quantity,
// glTF one whose green is the roughness and whose blue is the metalness. packed_channels.h reads
// them.
#pragma once

#include <memory>

#include "prep/scene.h"

namespace prep::detail {

// Metalness and roughness of two pictures (either may be null: 1 everywhere), as glTF packs them.
ImageRef packed_metallic_roughness(std::shared_ptr<const ImageRef> metallic,
                                   std::shared_ptr<const ImageRef> roughness, bool glossiness);

// The colours of one picture with the other for its alpha: that one's alpha where it has one, else
// its first channel. `color` null: white.
ImageRef packed_with_opacity(std::shared_ptr<const ImageRef> color,
                             std::shared_ptr<const ImageRef> opacity);

}  // namespace prep::detail
