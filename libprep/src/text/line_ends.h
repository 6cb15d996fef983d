// Lines that end with a carriage return alone, as old Mac programs and some exporters write them,
// and the mark that others begin a text with.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace prep::detail {

// How much of a file is looked at: more than any line of text that has other ends.
inline constexpr std::size_t line_end_head = std::size_t(1) << 16;

// UTF-8's, which says nothing of ASCII.
inline std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (text.starts_with(mark)) text.remove_prefix(mark.size());
    return text;
}

inline bool ends_lines_with_cr(std::string_view text) {
    const std::string_view head = text.substr(0, line_end_head);
    return head.find('\r') != std::string_view::npos && head.find('\n') == std::string_view::npos;
}

// The same text, of the same size, with line feeds.
inline std::string with_line_feeds(std::string_view text) {
    std::string out(text);
    std::replace(out.begin(), out.end(), '\r', '\n');
    return out;
}

}  // namespace prep::detail
