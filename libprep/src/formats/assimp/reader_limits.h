// What Assimp 5.2 gets wrong without a word.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace prep::detail {

// Of a file with this ending (".x3d", lower case) and text: a sentence for each statement in it that
// the reader passes over or misunderstands. XML alone, by the words that are there.
std::vector<std::string> misread_statements(std::string_view ending, std::string_view text);

}  // namespace prep::detail
