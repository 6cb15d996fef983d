// Options that several subcommands share.
#pragma once

#include "meshprep/options/common_options.h"
#include "meshprep/options/option_set.h"
#include "prep/prepare.h"
#include "prep/render_choices.h"

namespace meshprep {

void add_common_options(OptionSet& options, CommonOptions& common);
void add_preparation_options(OptionSet& options, prep::PrepareOptions& prepare);
// One for each of prep::RenderChoices.
void add_render_choices(OptionSet& options, prep::RenderWishes& wishes);

}  // namespace meshprep
