// Text in UTF-16, which Assimp does not read in XML.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace prep::detail {

// In UTF-8, where the bytes start with a byte order mark of UTF-16 or with "<" in it; halves of
// pairs become U+FFFD. Empty: something else.
std::optional<std::string> utf8_of_utf16(std::span<const std::byte> bytes);

}  // namespace prep::detail
