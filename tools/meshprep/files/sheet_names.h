// What a page of validation sheets is called, and its pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace meshprep {

// Of each input's page, without an ending; inputs of one stem keep their endings apart. Empty for
// those whose sheets an earlier one has already.
std::vector<std::string> page_stems(const std::vector<std::filesystem::path>& inputs);

// Of a mesh, without an ending: the page's, the mesh's number, and of its name, which may be
// anything, the letters, digits, dots and underscores, as far as all are 60 bytes. The number keeps
// meshes apart, and is never cut.
std::string sheet_stem(const std::string& stem, std::uint32_t number, const std::string& name);

}  // namespace meshprep
