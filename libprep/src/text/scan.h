// Reading numbers and words off one line of text.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

namespace prep::detail {

inline bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

class LineScanner {
  public:
    LineScanner(const char* begin, const char* end) : at_(begin), end_(end) {}
    explicit LineScanner(std::string_view line)
        : LineScanner(line.data(), line.data() + line.size()) {}

    void skip_blanks() {
        while (at_ != end_ && is_blank(*at_)) ++at_;
    }
    bool at_end() {
        skip_blanks();
        return at_ == end_;
    }
    char peek() const { return at_ == end_ ? '\0' : *at_; }
    void advance() { ++at_; }

    std::string_view word() {
        skip_blanks();
        const char* begin = at_;
        while (at_ != end_ && !is_blank(*at_)) ++at_;
        return {begin, std::size_t(at_ - begin)};
    }
    // What is left, without blanks at either end.
    std::string_view rest() {
        skip_blanks();
        const char* last = end_;
        while (last != at_ && is_blank(last[-1])) --last;
        const std::string_view text(at_, std::size_t(last - at_));
        at_ = end_;
        return text;
    }

    // A decimal number, "nan" and "inf" included, and "1.#QNAN", "-1.#IND", "1.#INF"; it must end
    // at a blank or the line's end.
    bool number(double& value);

    // A decimal integer; it may be followed by anything. Out of the range of 64 bits is false.
    bool integer(std::int64_t& value) {
        const char* begin = at_;
        if (begin != end_ && *begin == '+') ++begin;
        const auto [after, error] = std::from_chars(begin, end_, value);
        if (error != std::errc{}) return false;
        at_ = after;
        return true;
    }

  private:
    const char* at_;
    const char* end_;
};

// Whether it begins as what stands behind "1." where Microsoft's library has written what is no
// number: "#QNAN", "#SNAN", "#IND" or "#INF".
bool names_no_number(std::string_view text);

// What stands before a # after a blank, without that blank; the whole where there is none.
std::string before_comment(const std::string& text);

// The line, shortened to what fits a message, with quotes.
std::string quoted_line(std::string_view line);

}  // namespace prep::detail
