// Error-free transformations and a·b − c·d with (nearly) one rounding, without needing fused
// multiply-add hardware: results must be the same on every machine.
#pragma once

#include <glm/glm.hpp>

namespace prep::detail {

// x = high + low, |low| at most half an ulp of high: unique for a given x.
struct TwoDoubles {
    double high, low;
};
inline bool operator==(const TwoDoubles& a, const TwoDoubles& b) {
    return a.high == b.high && a.low == b.low;
}

// Exact product as an unevaluated sum (Dekker 1971, with Veltkamp's splitting). No overflow while
// |a|, |b| < 2^996; exact unless the low part underflows (|a·b| < 2^-969).
inline TwoDoubles two_product(double a, double b) {
    constexpr double splitter = 134217729.0;  // 2^27 + 1
    const double p = a * b;
    const double ta = splitter * a, tb = splitter * b;
    const double ah = ta - (ta - a), bh = tb - (tb - b);
    const double al = a - ah, bl = b - bh;
    return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

inline TwoDoubles two_sum(double a, double b) {  // Knuth 1969
    const double s = a + b;
    const double bb = s - a;
    return {s, (a - (s - bb)) + (b - bb)};
}

inline TwoDoubles difference_of_products_parts(double a, double b, double c, double d) {
    const TwoDoubles ab = two_product(a, b), cd = two_product(c, d);
    if (ab == cd) return {0, 0};
    const TwoDoubles high = two_sum(ab.high, -cd.high);
    return two_sum(high.high, high.low + (ab.low - cd.low));
}

// Error at most 2^-53 of the result plus 2^-103 of the larger product; zero where the exact value
// is.
inline double difference_of_products(double a, double b, double c, double d) {
    return difference_of_products_parts(a, b, c, d).high;
}

}  // namespace prep::detail
