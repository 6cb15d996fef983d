// Names of files that are not in UTF-8, for formats that hold nothing else.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace prep::detail {

// Well-formed, without surrogates and overlong forms (RFC 3629, 3).
inline bool is_utf8(std::string_view text) {
    const auto byte = [&](std::size_t at) {
        return at < text.size() ? static_cast<unsigned char>(text[at]) : 0u;
    };
    for (std::size_t at = 0; at < text.size();) {
        const unsigned first = byte(at), second = byte(at + 1);
        const std::size_t more = first < 0x80                    ? 0
                                 : first >= 0xc2 && first < 0xe0 ? 1
                                 : first >= 0xe0 && first < 0xf0 ? 2
                                 : first >= 0xf0 && first < 0xf5 ? 3
                                                                 : 4;
        if (more == 4) return false;
        for (std::size_t k = 1; k <= more; ++k)
            if ((byte(at + k) & 0xc0u) != 0x80u) return false;
        if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
            (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f))
            return false;
        at += more + 1;
    }
    return true;
}

// What is no UTF-8 is taken for Latin-1, whose characters have their bytes for numbers: different
// names stay different.
inline std::string as_utf8(const std::string& text) {
    if (is_utf8(text)) return text;
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80) {
            out += c;
        } else {
            out += char(0xc0 | byte >> 6);
            out += char(0x80 | (byte & 0x3f));
        }
    }
    return out;
}

}  // namespace prep::detail
