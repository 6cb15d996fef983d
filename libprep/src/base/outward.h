// Doubles as floats that are no less, or no more: for bounds.
//
// Calls of their own: g++ 12's -O2, where it puts such roundings side by side into a vector, goes
// on with the doubles from before them, and the comparison then never sees a float that fell short.
#pragma once

namespace prep::detail {

// Infinite beyond what floats hold, and for what is not a number.
float float_not_below(double value);
float float_not_above(double value);

}  // namespace prep::detail
