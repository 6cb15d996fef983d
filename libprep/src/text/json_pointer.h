// Keys in JSON pointers (RFC 6901).
#pragma once

#include <string>
#include <string_view>

namespace prep::detail {

// A key as one part of a pointer: ~ and / escaped.
inline std::string pointer_key(std::string_view key) {
    std::string out;
    for (const char c : key) {
        if (c == '~')
            out += "~0";
        else if (c == '/')
            out += "~1";
        else
            out += c;
    }
    return out;
}

}  // namespace prep::detail
