// Medians, intervals and ratios of measured times.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace cost {

// A number and the interval that holds it.
struct Estimate {
    double value = 0, low = 0, high = 0;
};

// Sorted or not; 0 where there is none. Of an even number the mean of the middle two.
double median(std::span<const double> values);
// The smallest value that a share `q` (0 … 1) of the values does not exceed (nearest rank).
double quantile(std::span<const double> values, double q);
// (upper − lower quartile) / median: how far times scatter.
double relative_spread(std::span<const double> values);

// How sure an interval is. Fronts are decided by `deciding` ones: they are looked at after every
// round, and for many pairs, so that one in twenty would be wrong too often.
enum class Confidence { shown /* 95 % */, deciding /* 99 % */ };

// The median with its interval between order statistics (Thompson 1936): from the k-th smallest to
// the k-th largest of n values, k as large as 2 · P(Binomial(n, ½) < k) allows. It holds the median
// of any continuous distribution at least as often as it says, whatever n. The extremes themselves
// miss it in a share 2^(1 − n), so that below 6 values (deciding: below 8) there is no interval but
// 0 to infinity.
Estimate median_estimate(std::span<const double> values, Confidence = Confidence::shown);

// The median of a[i] / b[i], measured in the same round i, and its interval. Pairs cancel what
// slowed down a whole round. Sizes are equal.
Estimate ratio_estimate(std::span<const double> a, std::span<const double> b,
                        Confidence = Confidence::shown);

}  // namespace cost
