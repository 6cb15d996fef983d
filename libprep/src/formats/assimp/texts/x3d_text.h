// X3D (ISO/IEC 19775-1, in XML) in words that Assimp 5.2 understands.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace prep::detail {

// Files stand in lists of quoted names (MFString), of which Assimp reads none: the text with the
// first of each alone, unquoted, its blanks as %20. Nothing where there are none.
std::optional<std::string> with_plain_urls(std::string_view xml);

// A sentence for each statement that the reader passes over or misunderstands.
std::vector<std::string> misread_of_x3d(std::string_view xml);

// Whether some surface is to be seen from both sides (solid="false").
bool has_open_surfaces(std::string_view xml);

}  // namespace prep::detail
