// The words for what a renderer can be asked for, on the command line and in scene files.
#pragma once

#include "meshprep/options/arguments.h"
#include "meshprep/options/enum_names.h"
#include "rast/render.h"

namespace meshprep {

const Words<rast::Shading>& shading_words();
const Words<rast::Cull>& cull_words();
const Words<rast::TextureFilter>& filter_words();
const Words<rast::Coverage>& coverage_words();
const Words<Buffer>& buffer_words();

}  // namespace meshprep
