// Options that several subcommands share.
#pragma once

#include "meshprep/options/common_options.h"
#include "meshprep/options/option_set.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/render_choices.h"

namespace meshprep {

void add_common_options(OptionSet& options, CommonOptions& common);
// For subcommands that read meshes, and for those of them that read several.
void add_input_options(OptionSet& options, CommonOptions& common);
void add_json_lines_option(OptionSet& options, CommonOptions& common);
// How files are read; `threads` is left to CommonOptions. The second for subcommands that have to
// make something of all that is in a file, not just to describe it.
void add_reading_options(OptionSet& options, prep::LoadOptions& load);
void add_loading_options(OptionSet& options, prep::LoadOptions& load);
// Subdivision, displacement and tessellation; add_preparation_options() adds them.
void add_surface_options(OptionSet& options, prep::PrepareOptions& prepare);
// For subcommands that know where the picture is taken from.
Option add_pixel_error_option(OptionSet& options, prep::PrepareOptions& prepare);
void add_preparation_options(OptionSet& options, prep::PrepareOptions& prepare);
// One for each of prep::RenderChoices.
void add_render_choices(OptionSet& options, prep::RenderWishes& wishes);

}  // namespace meshprep
