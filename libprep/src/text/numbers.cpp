#include "text/numbers.h"

#include <charconv>
#include <cmath>
#include <cstring>

#include "text/digits.h"

namespace prep::detail {
namespace {

struct Pairs {
    char text[200];
    constexpr Pairs() : text() {
        for (int i = 0; i < 100; ++i) {
            text[2 * i] = char('0' + i / 10);
            text[2 * i + 1] = char('0' + i % 10);
        }
    }
};
constexpr Pairs pairs;

// Exactly `count` digits, zeros in front.
void write_digits(char* to, std::uint64_t value, int count) {
    char* at = to + count;
    for (; count >= 2; count -= 2) {
        at -= 2;
        std::memcpy(at, pairs.text + 2 * (value % 100), 2);
        value /= 100;
    }
    if (count == 1) at[-1] = char('0' + value % 10);
}

constexpr std::uint64_t powers[] = {1,           10,           100,          1000,      10000,
                                    100000,      1000000,      10000000,     100000000, 1000000000,
                                    10000000000, 100000000000, 1000000000000};

}  // namespace

char* write_integer(char* to, std::uint64_t value) {
    if (value >= powers[12]) return std::to_chars(to, to + max_number_text, value).ptr;
    int digits = 1;
    while (value >= powers[digits]) ++digits;
    write_digits(to, value, digits);
    return to + digits;
}

char* write_double(char* to, double value) {
    return std::to_chars(to, to + max_number_text, value).ptr;
}

char* write_float(char* to, float value) {
    const float size = std::fabs(value);
    // Outside, digits behind the point are too many or none. Zero keeps its sign below.
    if (!(size >= 1e-4f && size < 1e7f)) return std::to_chars(to, to + max_number_text, value).ptr;
    // A multiple of 10^-d lies in the interval that rounds to this float when 10^-d is at most the
    // distance of its neighbours, 2^(exponent − 23); one digit less often does. The product is
    // exact: 24 bits of the float, 28 of 5^12.
    const int d = std::min(12, int(std::ceil((23 - std::ilogb(size)) * 0.30103)));
    for (int digits = d > 0 ? d - 1 : 0; digits <= d; ++digits) {
        const double power = double(powers[digits]);
        const std::uint64_t scaled = std::uint64_t(double(size) * power + 0.5);
        if (float(double(scaled) / power) != size) continue;
        if (value < 0) *to++ = '-';
        const std::uint64_t whole = scaled / powers[digits];
        std::uint64_t rest = scaled - whole * powers[digits];
        to = write_integer(to, whole);
        if (rest == 0) return to;
        *to++ = '.';
        write_digits(to, rest, digits);
        to += digits;
        while (to[-1] == '0') --to;
        return to;
    }
    return std::to_chars(to, to + max_number_text, value).ptr;
}

char* write_flipped(char* to, float v) {
    const double exact = 1.0 - double(v);
    char* const end = write_float(to, float(exact));
    std::memset(end, 0, 8);  // plain_decimal() may look at it
    const char* at = to;
    double read;
    if (plain_decimal(at, read) && at == end && float(1.0 - read) == v) return end;
    return write_double(to, exact);
}

}  // namespace prep::detail
