// One lane, in plain C++: what every vector kernel means. The kernels (*-inl.h) are written once
// against these names; lanes_highway-inl.h gives the same names to 4, 8 or 16 lanes. Each operation
// is a single IEEE operation, so that all of them give the same bits.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace rast::detail::scalar_lanes {

inline constexpr int lane_count = 1;

struct F {
    float v;
};
struct I {
    std::int32_t v;
};
struct D {  // as many lanes as F
    double v;
};
struct M {
    bool v;
};

inline F set(float v) {
    return {v};
}
inline I set(std::int32_t v) {
    return {v};
}
inline I iota() {
    return {0};
}

inline D set_double(double v) {
    return {v};
}

inline F operator+(F a, F b) {
    return {a.v + b.v};
}
inline F operator-(F a, F b) {
    return {a.v - b.v};
}
inline F operator*(F a, F b) {
    return {a.v * b.v};
}
inline F operator/(F a, F b) {
    return {a.v / b.v};
}
inline F operator-(F a) {
    return {-a.v};
}
inline M operator<(F a, F b) {
    return {a.v < b.v};
}
inline M operator>(F a, F b) {
    return {a.v > b.v};
}
inline M operator<=(F a, F b) {
    return {a.v <= b.v};
}
inline M operator>=(F a, F b) {
    return {a.v >= b.v};
}
inline M operator==(F a, F b) {
    return {a.v == b.v};
}

inline D operator+(D a, D b) {
    return {a.v + b.v};
}
inline D operator-(D a, D b) {
    return {a.v - b.v};
}
inline D operator*(D a, D b) {
    return {a.v * b.v};
}
inline D operator/(D a, D b) {
    return {a.v / b.v};
}
// 1 where a < b, else 0.
inline I less(D a, D b) {
    return {a.v < b.v ? 1 : 0};
}
inline D min(D a, D b) {
    return {a.v < b.v ? a.v : b.v};
}
inline D max(D a, D b) {
    return {a.v > b.v ? a.v : b.v};
}
inline D sqrt(D a) {
    return {std::sqrt(a.v)};
}
inline D floor(D a) {
    return {std::floor(a.v)};
}
inline D to_double(F a) {
    return {double(a.v)};
}
inline D to_double(I a) {
    return {double(a.v)};
}
inline F to_float(D a) {
    return {float(a.v)};
}
// Towards zero. Precondition: |a| < 2^31.
inline I to_int(D a) {
    return {std::int32_t(a.v)};
}

// Wraps around, as vector units do.
inline I operator+(I a, I b) {
    return {std::int32_t(std::uint32_t(a.v) + std::uint32_t(b.v))};
}
inline I operator-(I a, I b) {
    return {std::int32_t(std::uint32_t(a.v) - std::uint32_t(b.v))};
}
inline I operator*(I a, I b) {
    return {std::int32_t(std::uint32_t(a.v) * std::uint32_t(b.v))};
}
inline I operator&(I a, I b) {
    return {a.v & b.v};
}
inline I operator|(I a, I b) {
    return {a.v | b.v};
}
inline M operator<(I a, I b) {
    return {a.v < b.v};
}
inline M operator>(I a, I b) {
    return {a.v > b.v};
}
inline M operator==(I a, I b) {
    return {a.v == b.v};
}
template <int n>
I shift_left(I a) {
    return {std::int32_t(std::uint32_t(a.v) << n)};
}
template <int n>
I shift_right(I a) {  // arithmetic
    return {a.v >> n};
}
template <int n>
I shift_right_unsigned(I a) {
    return {std::int32_t(std::uint32_t(a.v) >> n)};
}

inline M operator&(M a, M b) {
    return {a.v && b.v};
}
inline M operator|(M a, M b) {
    return {a.v || b.v};
}
inline M operator!(M a) {
    return {!a.v};
}
inline bool any(M a) {
    return a.v;
}
inline bool all(M a) {
    return a.v;
}
// Bit i is lane i.
inline std::uint32_t bits_of(M a) {
    return a.v ? 1u : 0u;
}

inline M mask_of(std::uint32_t bits) {
    return {(bits & 1u) != 0};
}

inline F select(M m, F yes, F no) {
    return m.v ? yes : no;
}
inline I min(I a, I b) {
    return {a.v < b.v ? a.v : b.v};
}
inline I max(I a, I b) {
    return {a.v > b.v ? a.v : b.v};
}
inline I select(M m, I yes, I no) {
    return m.v ? yes : no;
}
// The second operand where they do not compare (NaN, or zeros of different sign).
inline F min(F a, F b) {
    return {a.v < b.v ? a.v : b.v};
}
inline F max(F a, F b) {
    return {a.v > b.v ? a.v : b.v};
}
inline F abs(F a) {
    return {std::fabs(a.v)};
}
inline F sqrt(F a) {
    return {std::sqrt(a.v)};
}
inline F floor(F a) {
    return {std::floor(a.v)};
}
inline F to_float(I a) {
    return {float(a.v)};
}
// Towards zero. Precondition: |a| < 2^31.
inline I to_int(F a) {
    return {std::int32_t(a.v)};
}
inline I bits(F a) {
    I out;
    std::memcpy(&out.v, &a.v, 4);
    return out;
}
inline F from_bits(I a) {
    F out;
    std::memcpy(&out.v, &a.v, 4);
    return out;
}

inline F load(const float* p) {
    return {*p};
}
inline I load(const std::int32_t* p) {
    return {*p};
}
inline I load(const std::uint32_t* p) {
    return {std::int32_t(*p)};
}
inline I load(const std::uint16_t* p) {
    return {std::int32_t(*p)};
}
inline D load(const double* p) {
    return {*p};
}
inline void store(D a, double* p) {
    *p = a.v;
}
inline void store(F a, float* p) {
    *p = a.v;
}
inline void store(I a, std::int32_t* p) {
    *p = a.v;
}
inline void store(I a, std::uint32_t* p) {
    *p = std::uint32_t(a.v);
}
inline F gather(const float* p, I index) {
    return {p[index.v]};
}
inline I gather(const std::int32_t* p, I index) {
    return {p[index.v]};
}
inline I gather(const std::uint32_t* p, I index) {
    return {std::int32_t(p[index.v])};
}
// Three floats of each lane, one lane after the other.
inline void load3(const float* p, F& x, F& y, F& z) {
    x.v = p[0];
    y.v = p[1];
    z.v = p[2];
}

// The lanes of the mask, the others stay; all are readable and writable, and nobody else's.
inline void store_where(M m, F a, float* p) {
    if (m.v) *p = a.v;
}
inline void store_where(M m, I a, std::uint32_t* p) {
    if (m.v) *p = std::uint32_t(a.v);
}
// The largest lane.
inline std::int32_t largest(I a) {
    return a.v;
}
// The lanes of the mask one after the other; returns how many. Writable up to the lane count.
inline std::size_t compress_store(M m, F a, float* p) {
    *p = a.v;
    return m.v ? 1 : 0;
}
inline std::size_t compress_store(M m, I a, std::int32_t* p) {
    *p = a.v;
    return m.v ? 1 : 0;
}

// Four words at p + 4 · index of each lane; indices are `stride` apart.
template <int stride>
void load_each4(const std::int32_t* p, const std::uint32_t* index, I& a, I& b, I& c, I& d) {
    p += std::size_t(*index) * 4;
    a = {p[0]};
    b = {p[1]};
    c = {p[2]};
    d = {p[3]};
}
// Four words of each lane, one lane after the other.
inline void store_interleaved4(I a, I b, I c, I d, std::int32_t* p) {
    p[0] = a.v;
    p[1] = b.v;
    p[2] = c.v;
    p[3] = d.v;
}

// Texels: red, green, blue and alpha of a lane side by side, so many lanes at a time that they fill
// a vector. part_count parts hold all lanes.
struct Quads {
    float v[4];
};
inline constexpr int part_count = 1;
inline Quads operator+(const Quads& a, const Quads& b) {
    return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3] + b.v[3]}};
}
inline Quads operator-(const Quads& a, const Quads& b) {
    return {{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2], a.v[3] - b.v[3]}};
}
inline Quads operator*(const Quads& a, const Quads& b) {
    return {{a.v[0] * b.v[0], a.v[1] * b.v[1], a.v[2] * b.v[2], a.v[3] * b.v[3]}};
}
inline Quads operator/(const Quads& a, const Quads& b) {
    return {{a.v[0] / b.v[0], a.v[1] / b.v[1], a.v[2] / b.v[2], a.v[3] / b.v[3]}};
}
// `yes` where `m` is above 0.
inline Quads select_positive(const Quads& m, const Quads& yes, const Quads& no) {
    Quads out;
    for (int k = 0; k < 4; ++k) out.v[k] = m.v[k] > 0 ? yes.v[k] : no.v[k];
    return out;
}
// A lane's value four times.
template <int part>
Quads spread(F v) {
    return {{v.v, v.v, v.v, v.v}};
}
template <int part>
Quads load_texels(const float* texels, const std::uint32_t* at) {
    Quads out;
    std::memcpy(out.v, texels + std::size_t(*at) * 4, sizeof out.v);
    return out;
}
// Texels `top` and the one beside it times the low half of a lane's weights, plus those of `bottom`
// times the high half.
inline Quads load_column(const std::int16_t* top, const std::int16_t* bottom, I weights) {
    const std::int32_t low = std::int16_t(weights.v), high = weights.v >> 16;
    Quads out;
    for (int k = 0; k < 4; ++k) out.v[k] = float(top[k] * low + bottom[k] * high);
    return out;
}
template <int part>
void load_columns(const std::int16_t* texels, const std::uint32_t* top, const std::uint32_t* bottom,
                  I weights, Quads& left, Quads& right) {
    const std::int16_t* const a = texels + std::size_t(*top) * 4;
    const std::int16_t* const b = texels + std::size_t(*bottom) * 4;
    left = load_column(a, b, weights);
    right = load_column(a + 4, b + 4, weights);
}
// The same of two textures that lie together.
template <int part>
void load_pair_columns(const std::int16_t* texels, const std::uint32_t* top,
                       const std::uint32_t* bottom, I weights, Quads left[2], Quads right[2]) {
    for (std::size_t i = 0; i < 2; ++i) {
        const std::int16_t* const a = texels + std::size_t(*top) * 8 + i * 4;
        const std::int16_t* const b = texels + std::size_t(*bottom) * 8 + i * 4;
        left[i] = load_column(a, b, weights);
        right[i] = load_column(a + 8, b + 8, weights);
    }
}
inline void channels_of(const Quads parts[], F out[4]) {
    for (int k = 0; k < 4; ++k) out[k].v = parts[0].v[k];
}

// Eight bytes of each lane, as two halves.
inline void gather_pairs(const std::int16_t* p, I index, I& low, I& high) {
    std::uint64_t pair;
    std::memcpy(&pair, p + std::ptrdiff_t(index.v) * 4, sizeof pair);
    low = {std::int32_t(std::uint32_t(pair))};
    high = {std::int32_t(std::uint32_t(pair >> 32))};
}
// As halves of 16 bits: low · low + high · high.
inline I sum_of_products(I a, I b) {
    const auto low = [](I v) { return std::int32_t(std::int16_t(v.v)); };
    const auto high = [](I v) { return v.v >> 16; };
    return {low(a) * low(b) + high(a) * high(b)};
}
// Lanes of the same place overwrite each other.
inline void scatter(I v, std::uint32_t* p, I index) {
    p[index.v] = std::uint32_t(v.v);
}

// Past the caches; `p` at a multiple of the vector's size. stream_end() comes before others look.
inline void stream(I v, std::uint32_t* p) {
    *p = std::uint32_t(v.v);
}
inline void stream_end() {}

// first, first + 1, … What is behind them stays; it is readable and writable, and nobody else's, up
// to a vector of 16-bit numbers.
inline void store_sequence(std::uint16_t first, std::size_t count, std::uint16_t* p) {
    for (std::size_t k = 0; k < count; ++k) p[k] = std::uint16_t(first + k);
}

// Which entry of tables with lane_count entries each lane reads.
struct Pick {
    std::int32_t v;
};
inline Pick pick_of(I index) {
    return {index.v};
}
inline F pick(const float* table, Pick at) {
    return {table[at.v]};
}
inline I pick(const std::int32_t* table, Pick at) {
    return {table[at.v]};
}

}  // namespace rast::detail::scalar_lanes
