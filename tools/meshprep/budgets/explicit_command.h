// The command that does again what was chosen for an error, with the choice in words.
#pragma once

#include <filesystem>
#include <string>

#include "meshprep/options/option_set.h"

namespace meshprep {

// As a shell takes it.
std::string shell_word(const std::string& text);

// "meshprep render in -o out …", with all that was given but what is chosen by an error, then
// `chosen`. Without an output the settings say where it goes.
std::string explicit_command(const std::string& subcommand, const std::filesystem::path& input,
                             const std::filesystem::path& output, const Settings& settings,
                             const std::string& chosen);

}  // namespace meshprep
