// Files in which nothing could be seen.
#pragma once

#include "prep/load.h"
#include "prep/scene.h"

namespace prep::detail {

// Where all materials that faces have are wholly transparent (opacity 0): a warning, and unless the
// file is to be taken at its word, or its document is kept (glTF), they become opaque. Opacity 0 of
// some materials among others is what it says.
void settle_transparency(Scene& scene, Transparency choice);

}  // namespace prep::detail
