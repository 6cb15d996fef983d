// Lower case of ASCII's letters, in every locale; other bytes (UTF-8's) as they are.
#pragma once

#include <string>
#include <string_view>

namespace prep::detail {

constexpr char lower_case(char c) {
    return c >= 'A' && c <= 'Z' ? char(c + ('a' - 'A')) : c;
}

inline std::string lower_case(std::string_view text) {
    std::string lowered(text);
    for (char& c : lowered) c = lower_case(c);
    return lowered;
}

}  // namespace prep::detail
