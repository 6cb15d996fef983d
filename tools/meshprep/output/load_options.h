// How subcommands read files: readers of other libraries in a process of their own, and what they
// print on standard error where that is asked for.
#pragma once

#include "meshprep/output/console.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/scene_json.h"

namespace meshprep {

// The console outlives them.
prep::LoadOptions load_options(const CommonOptions& common, Console& console);
// With what a scene file (.json) says of its picture; of others nothing is said.
prep::Result<prep::JsonScene> load_json_scene(const std::filesystem::path& path,
                                              const prep::LoadOptions& options);
// The command line's options with these threads; a height map that they name is read as they say.
prep::PrepareOptions prepare_options(const prep::PrepareOptions& given,
                                     const prep::LoadOptions& load, int threads);

}  // namespace meshprep
