// How subcommands read files: readers of other libraries in a process of their own, and what they
// print on standard error where that is asked for.
#pragma once

#include "meshprep/output/console.h"
#include "prep/load.h"
#include "prep/prepare.h"

namespace meshprep {

// The console outlives them.
prep::LoadOptions load_options(const CommonOptions& common, Console& console);
// The command line's options with these threads; a height map that they name is read as they say.
prep::PrepareOptions prepare_options(const prep::PrepareOptions& given,
                                     const prep::LoadOptions& load, int threads);

}  // namespace meshprep
