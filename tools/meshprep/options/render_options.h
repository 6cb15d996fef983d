// The options of `meshprep render`.
#pragma once

#include "meshprep/options/shared_options.h"

namespace meshprep {

CLI::App* define_render(CLI::App& app, RenderCommand& command);
// What single options cannot see. Ends the parse with a usage error.
void check_render(const RenderCommand& command);

}  // namespace meshprep
