// How textures are filtered, in words.
#pragma once

#include <string>
#include <vector>

#include "rast/render.h"

namespace rast::detail {

// `used`: the filter of each texture that is sampled.
std::string filter_words(const RenderRequest& request, const std::vector<TextureFilter>& used);

}  // namespace rast::detail
