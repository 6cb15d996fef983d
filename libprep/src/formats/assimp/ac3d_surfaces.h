// What Assimp leaves out of AC3D's surfaces.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace prep::detail {

// The names of the materials that some surface seen from both sides has: `SURF` with the bit 0x20.
// Here sides are a material's, in AC3D a surface's: one that has both kinds shows both sides of
// all.
std::set<std::string> two_sided_ac3d_materials(std::string_view text);

}  // namespace prep::detail
