// Materials of a glTF document beyond what Material holds.
#pragma once

#include <map>
#include <set>
#include <string>

#include "prep/scene.h"

namespace prep {

// Extensions of materials in the document that the scene came from, if it came from any, of which
// Material holds nothing, or no maps: other formats lose them. Each once, ascending.
std::set<std::string> extensions_beyond_materials(const Scene& scene);

// Numbers of one material's extensions of which Material holds nothing, by their JSON pointer below
// "extensions": true is 1, false 0, a texture that is there 1. Empty where there are none.
std::map<std::string, double> numbers_beyond_material(const Scene& scene, std::uint32_t material);

}  // namespace prep
