// Pictures whose decoders may end the process (image/picture_kind.h), decoded in one of its own.
#pragma once

#include "prep/load.h"
#include "prep/scene.h"

namespace prep::detail {

// Has the scene's pictures, and those that they are put together from, decoded in the process of
// `options`; nothing changes where it has none.
void contain_pictures(Scene& scene, const LoadOptions& options);

}  // namespace prep::detail
