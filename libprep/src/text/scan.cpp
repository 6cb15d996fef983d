#include "text/scan.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace prep::detail {

bool LineScanner::number(double& value) {
    skip_blanks();
    const char* begin = at_;
    if (begin != end_ && *begin == '+') ++begin;
    const auto [after, error] = fast_float::from_chars(begin, end_, value);
    if (error != std::errc{} || after == begin) return false;
    const bool ends = after == end_ || is_blank(*after);
    if (!ends && !names_no_number({after, std::size_t(end_ - after)})) return false;
    at_ = after;
    if (ends) return true;
    const std::string_view what = word();
    value = std::copysign(what.starts_with("#INF") ? std::numeric_limits<double>::infinity()
                                                   : std::numeric_limits<double>::quiet_NaN(),
                          value);
    return true;
}

bool names_no_number(std::string_view text) {
    return text.starts_with("#QNAN") || text.starts_with("#SNAN") || text.starts_with("#IND") ||
           text.starts_with("#INF");
}

std::string before_comment(const std::string& text) {
    for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#', at + 1))
        if (at > 0 && is_blank(text[at - 1]))
            return text.substr(0, text.find_last_not_of(" \t\f\v", at - 1) + 1);
    return text;
}

std::string quoted_line(std::string_view line) {
    constexpr std::size_t limit = 60;
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    std::string text = "'";
    for (const char c : line.substr(0, limit))
        text += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
    return text + (line.size() > limit ? "…'" : "'");
}

}  // namespace prep::detail
