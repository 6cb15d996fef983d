// Unsigned integers and plain decimals off text, eight characters at a time. The text must be
// readable for 8 bytes behind its end (little-endian machines).
#pragma once

#include <cstdint>
#include <cstring>

namespace prep::detail {

// The digits at the beginning of `at`, eight at most; their value.
inline unsigned digit_run(const char* at, std::uint32_t& value) {
    std::uint64_t x;
    std::memcpy(&x, at, 8);
    x ^= 0x3030303030303030u;
    // The high bit of each byte that is over 9; a carry can only reach bytes behind the first.
    const std::uint64_t stop = ((x + 0x7676767676767676u) | x) & 0x8080808080808080u;
    const unsigned count = stop ? unsigned(__builtin_ctzll(stop)) >> 3 : 8;
    if (count == 0) {
        value = 0;
        return 0;
    }
    // First digit last: missing ones are zeros in front. Then pairs, fours and eights are joined.
    x <<= 64 - 8 * count;
    x = (x * 2561) >> 8;
    x = ((x & 0x00ff00ff00ff00ffu) * 6553601) >> 16;
    x = ((x & 0x0000ffff0000ffffu) * 42949672960001u) >> 32;
    value = std::uint32_t(x);
    return count;
}

// A positive integer up to `limit` (below 10^15); 0 where there is none or it is larger.
inline std::uint32_t positive_integer(const char*& at, std::uint64_t limit) {
    std::uint32_t value;
    const unsigned count = digit_run(at, value);
    at += count;
    if (count < 8) return value;
    std::uint32_t more;
    const unsigned rest = digit_run(at, more);
    at += rest;
    std::uint64_t whole = value;
    for (unsigned k = 0; k < rest; ++k) whole *= 10;
    whole += more;
    return rest < 8 && whole <= limit ? std::uint32_t(whole) : 0;
}

// A decimal without an exponent whose value is one division of exact doubles (Clinger 1990): at
// most 2^53 without its point, at most 22 digits behind it. False otherwise: not a number, or one
// for the general reader; `at` has not moved then.
inline bool plain_decimal(const char*& at, double& value) {
    static constexpr double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                        1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                        1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    static constexpr std::uint64_t scale[] = {1,      10,      100,      1000,     10000,
                                              100000, 1000000, 10000000, 100000000};
    const char* p = at;
    const bool negative = *p == '-';
    p += negative;
    std::uint64_t mantissa = 0;
    unsigned digits = 0, behind = 0;
    for (int part = 0; part < 2; ++part) {
        for (unsigned count = 8; count == 8;) {
            std::uint32_t run;
            count = digit_run(p, run);
            digits += count;
            if (digits > 19) return false;
            mantissa = mantissa * scale[count] + run;
            p += count;
            if (part == 1) behind += count;
        }
        if (part == 1 || *p != '.') break;
        ++p;
    }
    if (digits == 0 || mantissa > (std::uint64_t(1) << 53)) return false;
    const double magnitude = double(mantissa) / powers[behind];
    value = negative ? -magnitude : magnitude;
    at = p;
    return true;
}

}  // namespace prep::detail
