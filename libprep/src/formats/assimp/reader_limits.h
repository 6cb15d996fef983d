// What Assimp 5.2 gets wrong without a word.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace prep::detail {

// XML without its comments.
std::string without_comments(std::string_view xml);

// Whether an element of that name is in XML without comments.
bool has_element(std::string_view xml, std::string_view name);

// How many references to blocks of a DXF text are turned or scaled: Assimp reads no rotation of
// them, and scales their place too.
std::uint64_t misplaced_dxf_inserts(std::string_view text);

// Of a file with this ending (".x3d", lower case) and text, XML without comments: a sentence for
// each statement in it that the reader passes over or misunderstands.
std::vector<std::string> misread_statements(std::string_view ending, std::string_view xml);

}  // namespace prep::detail
