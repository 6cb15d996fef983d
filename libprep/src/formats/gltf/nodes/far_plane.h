// The far plane of orthographic cameras, without which glTF has none.
#pragma once

#include <cstddef>

#include "prep/prepared_scene.h"

namespace prep::detail {

// Of that camera: its own; one without is given one behind everything that is drawn, wherever the
// camera looks. O(vertices) for the latter.
double orthographic_far_plane(const PreparedScene& prepared, std::size_t camera);

}  // namespace prep::detail
