// Logarithms and powers with the same bits on every instruction set.
// Included once per instruction set, inside the namespace that has its lanes.

// m = f · 2^e with f in [½, 1). Precondition: m is positive, normal and finite.
struct Parts {
    F fraction, exponent;
};
RAST_INLINE Parts split_exponent(F m) {
    const I b = bits(m);
    return {from_bits((b & set(0x007fffff)) | set(0x3f000000)),
            to_float(shift_right<23>(b) - set(126))};
}

// log2(a / b) for (a − b) / (a + b) = t in [−1/3, 1/3], by the series of the inverse hyperbolic
// tangent: log(a / b) = 2 artanh(t); the first term left out is below 4e-9.
// Pairs of terms first: one chain of eight would take twice as long.
RAST_INLINE F log2_of_ratio(F t) {
    const F s = t * t, s2 = s * s;
    const F p0 = set(2.0f / 3.0f) * s + set(2.0f);
    const F p2 = set(2.0f / 7.0f) * s + set(2.0f / 5.0f);
    const F p4 = set(2.0f / 11.0f) * s + set(2.0f / 9.0f);
    const F p6 = set(2.0f / 15.0f) * s + set(2.0f / 13.0f);
    const F p = ((p6 * s2 + p4) * (s2 * s2)) + (p2 * s2 + p0);
    return p * t * set(1.44269504088896341f);
}

// Precondition as for split_exponent. Absolute error below 3.1e-7 + 1 ulp of the result.
RAST_INLINE F log2(F m) {
    const Parts parts = split_exponent(m);
    const F f = parts.fraction - set(1.0f);
    return parts.exponent + log2_of_ratio(f / (set(2.0f) + f));
}

// 2^y for y ≤ 0; 0 below −126 (the result would be denormal). Relative error below 3e-7.
RAST_INLINE F exp2_negative(F y) {
    const F kept = max(y, set(-126.0f));
    const F whole = floor(kept + set(0.5f));
    const F f = kept - whole;  // −½ … ½
    // Σ (f ln 2)^n / n!, in pairs as above.
    const F f2 = f * f;
    const F p0 = set(6.93147181e-1f) * f + set(1.0f);
    const F p2 = set(5.55041087e-2f) * f + set(2.40226507e-1f);
    const F p4 = set(1.33335581e-3f) * f + set(9.61812911e-3f);
    const F p6 = set(1.52527338e-5f) * f + set(1.54035304e-4f);
    const F p = ((p6 * f2 + p4) * (f2 * f2)) + (p2 * f2 + p0);
    const F scale = from_bits(shift_left<23>(to_int(whole) + set(127)));
    return select(y < set(-126.0f), set(0.0f), p * scale);
}

// y of (cos)^shininess = 2^y for the angle whose sine and cosine, squared and times one positive
// number, are given with that number, each with its own full relative precision: near the
// highlight's centre the power is taken from the sine, because the cosine has lost its digits there
// (Kahan's advice for log1p).
RAST_INLINE F specular_exponent(F sine2, F cosine2, F number, F shininess) {
    const M close = sine2 < set(0.5f) * number;
    const Parts c = split_exponent(max(cosine2, set(1.0e-37f))), n = split_exponent(number);
    const F above = select(close, -sine2, c.fraction - n.fraction);
    const F below = select(close, (number + number) - sine2, c.fraction + n.fraction);
    const F whole = select(close, set(0.0f), c.exponent - n.exponent);
    return (whole + log2_of_ratio(above / below)) * (set(0.5f) * shininess);
}
