// Numbers as text, fast: whole numbers, and floats in few digits that read back as the same float.
#pragma once

#include <cstdint>

namespace prep::detail {

// Room that each of these may need, in characters.
inline constexpr int max_number_text = 48;

// Writes at `to` and returns the end.
char* write_integer(char* to, std::uint64_t value);

// Reading the text as double and rounding to float gives `value` again, in every bit (but a NaN's).
// As short as std::to_chars() for nearly all values, never longer than one digit more than that.
char* write_float(char* to, float value);

// A double in the shortest digits that read back as it.
char* write_double(char* to, double value);

// The v of a UV counted from the bottom, for a `v` counted from the top: short digits d for which
// float(1 − d) is `v` again.
char* write_flipped(char* to, float v);

}  // namespace prep::detail
