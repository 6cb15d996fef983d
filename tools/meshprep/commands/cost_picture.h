// A file's scene as `render` draws it, for the ladders of `cost` that are of whole scenes.
#pragma once

#include "cost/ladders/scenes.h"
#include "meshprep/options/common_options.h"
#include "prep/scene_json.h"

namespace meshprep {

// With the scene's camera, or a view that fits; its lights, and the exposure that it takes where it
// brings lights of its own; what a scene file says of its picture but for size and samples. Errors:
// those of preparing and planning.
prep::Result<cost::ScenePicture> scene_picture(prep::JsonScene loaded, bool scene_file,
                                               int threads);

}  // namespace meshprep
