// Medians, intervals and ratios of measured times.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace cost {

// A number and the interval that holds it with 95 % confidence.
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

// The median with a bootstrap percentile interval (Efron 1979), expanded for small samples
// (Hesterberg 2015, "What Teachers Should Know About the Bootstrap", sec. 3.3: the tails of a
// normal interval as wide as Student's). 2,000 resamples from a seed of its own: the same values
// give the same interval. One value: the interval is unbounded (0 to infinity).
Estimate median_estimate(std::span<const double> values, Confidence = Confidence::shown);

// The median of a[i] / b[i], measured in the same round i, and its interval. Pairs cancel what
// slowed down a whole round. Sizes are equal.
Estimate ratio_estimate(std::span<const double> a, std::span<const double> b,
                        Confidence = Confidence::shown);

}  // namespace cost
