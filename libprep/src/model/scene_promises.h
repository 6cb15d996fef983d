// What every loader promises of a scene (mesh.h, scene.h), and everything after it relies on.
#pragma once

#include "prep/scene.h"

namespace prep::detail {

// The first list whose indices, sizes or offsets break a promise; null: none does. O(scene).
const char* broken_promise(const Scene& scene);

}  // namespace prep::detail
