#include "base/outward.h"

#include <cmath>
#include <limits>

namespace prep::detail {
namespace {

constexpr double largest = double(std::numeric_limits<float>::max());
constexpr float infinity = std::numeric_limits<float>::infinity();

}  // namespace

float float_not_below(double value) {
    if (!(value <= largest)) return infinity;
    if (value < -largest) return std::numeric_limits<float>::lowest();
    const auto near = float(value);
    return double(near) >= value ? near : std::nextafter(near, infinity);
}

float float_not_above(double value) {
    return -float_not_below(-value);
}

}  // namespace prep::detail
