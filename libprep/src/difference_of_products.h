// a·b − c·d with (nearly) one rounding, without needing fused multiply-add hardware: results must
// be the same on every machine.
#pragma once

#include <glm/glm.hpp>

namespace prep::detail {

struct TwoDoubles {
    double high, low;
};

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

// Relative error at most 2^-52 (two roundings of nearly exact parts).
inline double difference_of_products(double a, double b, double c, double d) {
    const TwoDoubles ab = two_product(a, b), cd = two_product(c, d);
    const TwoDoubles high = two_sum(ab.high, -cd.high);
    return high.high + (high.low + (ab.low - cd.low));
}

inline bool fits_float(const glm::dvec3& v) {
    return double(float(v.x)) == v.x && double(float(v.y)) == v.y && double(float(v.z)) == v.z;
}

// Cross product, each component with a relative error of at most 2^-52. Products of two floats are
// exact in double, so the common case needs no splitting.
inline glm::dvec3 accurate_cross(const glm::dvec3& a, const glm::dvec3& b) {
    if (fits_float(a) && fits_float(b))
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
            difference_of_products(a.x, b.y, a.y, b.x)};
}

}  // namespace prep::detail
