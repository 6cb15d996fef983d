#include "cost/measure/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cost {
namespace {

// How many of the n + 1 gaps between sorted values, from either end, the median can be left out of:
// the largest k with 2 · P(fewer than k of n fair coins) at most the share of errors; 0: none.
std::size_t gaps_left_out(std::size_t n, Confidence confidence) {
    const double errors = confidence == Confidence::deciding ? 0.01 : 0.05;
    const double size = double(n);
    double tail = 0;
    std::size_t k = 0;
    for (; k < n / 2; ++k) {
        const double i = double(k);
        tail += std::exp(std::lgamma(size + 1) - std::lgamma(i + 1) - std::lgamma(size - i + 1) -
                         size * std::numbers::ln2);
        if (2 * tail > errors) break;
    }
    return k;
}

double middle(std::vector<double>& values) {
    const std::size_t half = values.size() / 2;
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(half), values.end());
    const double upper = values[half];
    if (values.size() % 2 == 1) return upper;
    return (*std::max_element(values.begin(), values.begin() + std::ptrdiff_t(half)) + upper) / 2;
}

}  // namespace

double median(std::span<const double> values) {
    if (values.empty()) return 0;
    std::vector<double> copy(values.begin(), values.end());
    return middle(copy);
}

double quantile(std::span<const double> values, double q) {
    if (values.empty()) return 0;
    std::vector<double> copy(values.begin(), values.end());
    const double rank = std::ceil(q * double(copy.size())) - 1;
    const std::size_t at = std::size_t(std::clamp(rank, 0.0, double(copy.size() - 1)));
    std::nth_element(copy.begin(), copy.begin() + std::ptrdiff_t(at), copy.end());
    return copy[at];
}

double relative_spread(std::span<const double> values) {
    const double m = median(values);
    return m > 0 ? (quantile(values, 0.75) - quantile(values, 0.25)) / m : 0;
}

Estimate median_estimate(std::span<const double> values, Confidence confidence) {
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    const double m = median(values);
    const std::size_t k = gaps_left_out(sorted.size(), confidence);
    if (k == 0) return {m, 0, std::numeric_limits<double>::infinity()};
    return {m, sorted[k - 1], sorted[sorted.size() - k]};
}

Estimate ratio_estimate(std::span<const double> a, std::span<const double> b,
                        Confidence confidence) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        if (b[i] > 0) ratios.push_back(a[i] / b[i]);
    return median_estimate(ratios, confidence);
}

}  // namespace cost
