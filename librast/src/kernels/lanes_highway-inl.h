// The names of lanes_scalar.h for 4, 8 or 16 lanes, by Highway.
// Included once per instruction set, inside its namespace.

namespace hn = hwy::HWY_NAMESPACE;

#include "base/compress_store-inl.h"

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Unsigned = hn::RebindToUnsigned<Floats>;
using Doubles = hn::RepartitionToWide<Floats>;
using HalfFloats = hn::Half<Floats>;
using HalfInts = hn::Half<Ints>;
using MF = hn::Mask<Floats>;

inline constexpr int lane_count = int(hn::MaxLanes(Floats()));

struct F {
    hn::Vec<Floats> v;
};
struct I {
    hn::Vec<Ints> v;
};
struct D {
    hn::Vec<Doubles> low, high;
};
struct M {
    MF v;
};

HWY_INLINE F set(float v) {
    return {hn::Set(Floats(), v)};
}
HWY_INLINE I set(std::int32_t v) {
    return {hn::Set(Ints(), v)};
}
HWY_INLINE I iota() {
    return {hn::Iota(Ints(), 0)};
}
HWY_INLINE D set_double(double v) {
    const auto x = hn::Set(Doubles(), v);
    return {x, x};
}

HWY_INLINE F operator+(F a, F b) {
    return {hn::Add(a.v, b.v)};
}
HWY_INLINE F operator-(F a, F b) {
    return {hn::Sub(a.v, b.v)};
}
HWY_INLINE F operator*(F a, F b) {
    return {hn::Mul(a.v, b.v)};
}
HWY_INLINE F operator/(F a, F b) {
    return {hn::Div(a.v, b.v)};
}
HWY_INLINE F operator-(F a) {
    return {hn::Neg(a.v)};
}
HWY_INLINE M operator<(F a, F b) {
    return {hn::Lt(a.v, b.v)};
}
HWY_INLINE M operator>(F a, F b) {
    return {hn::Gt(a.v, b.v)};
}
HWY_INLINE M operator<=(F a, F b) {
    return {hn::Le(a.v, b.v)};
}
HWY_INLINE M operator>=(F a, F b) {
    return {hn::Ge(a.v, b.v)};
}
HWY_INLINE M operator==(F a, F b) {
    return {hn::Eq(a.v, b.v)};
}

HWY_INLINE D operator+(D a, D b) {
    return {hn::Add(a.low, b.low), hn::Add(a.high, b.high)};
}
HWY_INLINE D operator-(D a, D b) {
    return {hn::Sub(a.low, b.low), hn::Sub(a.high, b.high)};
}
HWY_INLINE D operator*(D a, D b) {
    return {hn::Mul(a.low, b.low), hn::Mul(a.high, b.high)};
}
HWY_INLINE D operator/(D a, D b) {
    return {hn::Div(a.low, b.low), hn::Div(a.high, b.high)};
}
HWY_INLINE D min(D a, D b) {
    return {hn::Min(a.low, b.low), hn::Min(a.high, b.high)};
}
HWY_INLINE D max(D a, D b) {
    return {hn::Max(a.low, b.low), hn::Max(a.high, b.high)};
}
HWY_INLINE D sqrt(D a) {
    return {hn::Sqrt(a.low), hn::Sqrt(a.high)};
}
HWY_INLINE D floor(D a) {
    return {hn::Floor(a.low), hn::Floor(a.high)};
}
HWY_INLINE D to_double(F a) {
    return {hn::PromoteTo(Doubles(), hn::LowerHalf(HalfFloats(), a.v)),
            hn::PromoteTo(Doubles(), hn::UpperHalf(HalfFloats(), a.v))};
}
HWY_INLINE D to_double(I a) {
    return {hn::PromoteTo(Doubles(), hn::LowerHalf(HalfInts(), a.v)),
            hn::PromoteTo(Doubles(), hn::UpperHalf(HalfInts(), a.v))};
}
HWY_INLINE F to_float(D a) {
    return {hn::Combine(Floats(), hn::DemoteTo(HalfFloats(), a.high),
                        hn::DemoteTo(HalfFloats(), a.low))};
}
HWY_INLINE I to_int(D a) {
    return {hn::Combine(Ints(), hn::DemoteTo(HalfInts(), a.high), hn::DemoteTo(HalfInts(), a.low))};
}
HWY_INLINE I less(D a, D b) {
    const auto one = hn::Set(Doubles(), 1.0);
    return to_int(D{hn::IfThenElseZero(hn::Lt(a.low, b.low), one),
                    hn::IfThenElseZero(hn::Lt(a.high, b.high), one)});
}

HWY_INLINE I operator+(I a, I b) {
    return {hn::Add(a.v, b.v)};
}
HWY_INLINE I operator-(I a, I b) {
    return {hn::Sub(a.v, b.v)};
}
HWY_INLINE I operator*(I a, I b) {
    return {hn::Mul(a.v, b.v)};
}
HWY_INLINE I operator&(I a, I b) {
    return {hn::And(a.v, b.v)};
}
HWY_INLINE I operator|(I a, I b) {
    return {hn::Or(a.v, b.v)};
}
HWY_INLINE M operator<(I a, I b) {
    return {hn::RebindMask(Floats(), hn::Lt(a.v, b.v))};
}
HWY_INLINE M operator>(I a, I b) {
    return {hn::RebindMask(Floats(), hn::Gt(a.v, b.v))};
}
HWY_INLINE M operator==(I a, I b) {
    return {hn::RebindMask(Floats(), hn::Eq(a.v, b.v))};
}
template <int n>
HWY_INLINE I shift_left(I a) {
    return {hn::ShiftLeft<n>(a.v)};
}
template <int n>
HWY_INLINE I shift_right(I a) {
    return {hn::ShiftRight<n>(a.v)};
}
template <int n>
HWY_INLINE I shift_right_unsigned(I a) {
    return {hn::BitCast(Ints(), hn::ShiftRight<n>(hn::BitCast(Unsigned(), a.v)))};
}

HWY_INLINE M operator&(M a, M b) {
    return {hn::And(a.v, b.v)};
}
HWY_INLINE M operator|(M a, M b) {
    return {hn::Or(a.v, b.v)};
}
HWY_INLINE M operator!(M a) {
    return {hn::Not(a.v)};
}
HWY_INLINE bool any(M a) {
    return !hn::AllFalse(Floats(), a.v);
}
HWY_INLINE bool all(M a) {
    return hn::AllTrue(Floats(), a.v);
}
// StoreMaskBits would go through memory.
HWY_INLINE std::uint32_t bits_of(M a) {
#if HWY_TARGET <= HWY_AVX3
    return a.v.raw;
#elif HWY_TARGET <= HWY_AVX2
    return std::uint32_t(_mm256_movemask_ps(a.v.raw));
#elif HWY_ARCH_X86
    return std::uint32_t(_mm_movemask_ps(a.v.raw));
#else
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Floats(), a.v, bytes);
    return std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8;
#endif
}

HWY_INLINE M mask_of(std::uint32_t bits) {
    const std::uint8_t bytes[8] = {std::uint8_t(bits), std::uint8_t(bits >> 8)};
    return {hn::LoadMaskBits(Floats(), bytes)};
}

HWY_INLINE F select(M m, F yes, F no) {
    return {hn::IfThenElse(m.v, yes.v, no.v)};
}
HWY_INLINE I min(I a, I b) {
    return {hn::Min(a.v, b.v)};
}
HWY_INLINE I max(I a, I b) {
    return {hn::Max(a.v, b.v)};
}
HWY_INLINE I select(M m, I yes, I no) {
    return {hn::IfThenElse(hn::RebindMask(Ints(), m.v), yes.v, no.v)};
}
HWY_INLINE F min(F a, F b) {
    return {hn::Min(a.v, b.v)};
}
HWY_INLINE F max(F a, F b) {
    return {hn::Max(a.v, b.v)};
}
HWY_INLINE F abs(F a) {
    return {hn::Abs(a.v)};
}
HWY_INLINE F sqrt(F a) {
    return {hn::Sqrt(a.v)};
}
HWY_INLINE F floor(F a) {
    return {hn::Floor(a.v)};
}
HWY_INLINE F to_float(I a) {
    return {hn::ConvertTo(Floats(), a.v)};
}
// ConvertTo would mend what is out of range, which no caller asks for.
HWY_INLINE I to_int(F a) {
#if HWY_TARGET <= HWY_AVX3
    return {hn::Vec<Ints>{_mm512_cvttps_epi32(a.v.raw)}};
#elif HWY_TARGET <= HWY_AVX2
    return {hn::Vec<Ints>{_mm256_cvttps_epi32(a.v.raw)}};
#elif HWY_ARCH_X86
    return {hn::Vec<Ints>{_mm_cvttps_epi32(a.v.raw)}};
#else
    return {hn::ConvertTo(Ints(), a.v)};
#endif
}
HWY_INLINE I bits(F a) {
    return {hn::BitCast(Ints(), a.v)};
}
HWY_INLINE F from_bits(I a) {
    return {hn::BitCast(Floats(), a.v)};
}

HWY_INLINE F load(const float* p) {
    return {hn::LoadU(Floats(), p)};
}
HWY_INLINE I load(const std::int32_t* p) {
    return {hn::LoadU(Ints(), p)};
}
HWY_INLINE I load(const std::uint32_t* p) {
    return {hn::BitCast(Ints(), hn::LoadU(Unsigned(), p))};
}
HWY_INLINE I load(const std::uint16_t* p) {
    const hn::Rebind<std::uint16_t, Ints> d;
    return {hn::PromoteTo(Ints(), hn::LoadU(d, p))};
}
HWY_INLINE D load(const double* p) {
    return {hn::LoadU(Doubles(), p), hn::LoadU(Doubles(), p + lane_count / 2)};
}
HWY_INLINE void store(D a, double* p) {
    hn::StoreU(a.low, Doubles(), p);
    hn::StoreU(a.high, Doubles(), p + lane_count / 2);
}
HWY_INLINE void store(F a, float* p) {
    hn::StoreU(a.v, Floats(), p);
}
HWY_INLINE void store(I a, std::int32_t* p) {
    hn::StoreU(a.v, Ints(), p);
}
HWY_INLINE void store(I a, std::uint32_t* p) {
    hn::StoreU(hn::BitCast(Unsigned(), a.v), Unsigned(), p);
}
HWY_INLINE F gather(const float* p, I index) {
    return {hn::GatherIndex(Floats(), p, index.v)};
}
HWY_INLINE I gather(const std::int32_t* p, I index) {
    return {hn::GatherIndex(Ints(), p, index.v)};
}
HWY_INLINE I gather(const std::uint32_t* p, I index) {
    return {hn::BitCast(Ints(), hn::GatherIndex(Unsigned(), p, index.v))};
}
// Lanes outside the mask keep what they were. Below AVX-512 they are written as well, which
// hn::BlendedStore avoids, as they may not be the caller's: AMD's Zen 3 takes seven cycles to store
// by a mask (vpmaskmovd), two to load, blend and store; and where there is no such instruction, for
// 16 bits and with SSE4, it stores lane by lane.
template <class Tag>
HWY_INLINE void store_lanes(Tag d, hn::Vec<Tag> v, hn::Mask<Tag> m, hn::TFromD<Tag>* p) {
#if HWY_TARGET <= HWY_AVX3
    hn::BlendedStore(v, m, d, p);
#else
    hn::StoreU(hn::IfThenElse(m, v, hn::LoadU(d, p)), d, p);
#endif
}
HWY_INLINE void store_where(M m, F a, float* p) {
    store_lanes(Floats(), a.v, m.v, p);
}
HWY_INLINE void store_where(M m, I a, std::uint32_t* p) {
    store_lanes(Unsigned(), hn::BitCast(Unsigned(), a.v), hn::RebindMask(Unsigned(), m.v), p);
}
HWY_INLINE std::int32_t largest(I a) {
    return hn::GetLane(hn::MaxOfLanes(Ints(), a.v));
}
HWY_INLINE std::size_t compress_store(M m, F a, float* p) {
    return compress_store(Floats(), a.v, m.v, p);
}
HWY_INLINE std::size_t compress_store(M m, I a, std::int32_t* p) {
    return compress_store(Ints(), a.v, hn::RebindMask(Ints(), m.v), p);
}
HWY_INLINE void load3(const float* p, F& x, F& y, F& z) {
    hn::LoadInterleaved3(Floats(), p, x.v, y.v, z.v);
}
HWY_INLINE void gather_pairs(const std::int16_t* p, I index, I& low, I& high) {
    const hn::RepartitionToWide<Ints> wide;
    const hn::Repartition<std::uint64_t, Ints> pairs;
    const auto* const from = reinterpret_cast<const std::uint64_t*>(p);
    const auto first =
        hn::GatherIndex(pairs, from, hn::PromoteTo(wide, hn::LowerHalf(HalfInts(), index.v)));
    const auto last =
        hn::GatherIndex(pairs, from, hn::PromoteTo(wide, hn::UpperHalf(HalfInts(), index.v)));
    const auto a = hn::BitCast(Ints(), first), b = hn::BitCast(Ints(), last);
    low = {hn::ConcatEven(Ints(), b, a)};
    high = {hn::ConcatOdd(Ints(), b, a)};
}
HWY_INLINE void scatter(I v, std::uint32_t* p, I index) {
    hn::ScatterIndex(hn::BitCast(Unsigned(), v.v), Unsigned(), p, index.v);
}

HWY_INLINE void stream(I v, std::uint32_t* p) {
    hn::Stream(hn::BitCast(Unsigned(), v.v), Unsigned(), p);
}
HWY_INLINE void stream_end() {
    hwy::FlushStream();
}

// The products of 16-bit numbers, each two neighbours' added up.
template <class V>
HWY_INLINE hn::Vec<Ints> sums_of_pairs(V a, V b) {
#if HWY_TARGET <= HWY_AVX3
    return hn::Vec<Ints>{_mm512_madd_epi16(a.raw, b.raw)};
#elif HWY_TARGET <= HWY_AVX2
    return hn::Vec<Ints>{_mm256_madd_epi16(a.raw, b.raw)};
#elif HWY_ARCH_X86
    return hn::Vec<Ints>{_mm_madd_epi16(a.raw, b.raw)};
#else
    const Ints words;
    const auto low = [&](V v) {
        return hn::ShiftRight<16>(hn::ShiftLeft<16>(hn::BitCast(words, v)));
    };
    const auto high = [&](V v) { return hn::ShiftRight<16>(hn::BitCast(words, v)); };
    return hn::Add(hn::Mul(low(a), low(b)), hn::Mul(high(a), high(b)));
#endif
}

// As halves of 16 bits: low · low + high · high.
HWY_INLINE I sum_of_products(I a, I b) {
    const hn::Repartition<std::int16_t, Ints> halves;
    return {sums_of_pairs(hn::BitCast(halves, a.v), hn::BitCast(halves, b.v))};
}

// A vector from one of 16 bytes of each of the lanes `first`, 4 + first, …
template <class D, class At>
HWY_INLINE hn::Vec<D> blocks_of(D d, int first, const At& at) {
#if HWY_TARGET <= HWY_AVX3
    const hn::Half<D> half;
    return hn::Combine(d, hn::Combine(half, at(12 + first), at(8 + first)),
                       hn::Combine(half, at(4 + first), at(first)));
#elif HWY_TARGET <= HWY_AVX2
    return hn::Combine(d, at(4 + first), at(first));
#else
    (void)d;
    return at(first);
#endif
}
// Words 0, 1, 2 and 3 of each lane's 16 bytes, which lie as blocks_of(0 … 3) puts them.
template <class V>
HWY_INLINE void transpose_blocks(V r0, V r1, V r2, V r3, V& a, V& b, V& c, V& d) {
    const hn::DFromV<V> words;
    const auto ab02 = hn::InterleaveLower(words, r0, r2), cd02 = hn::InterleaveUpper(words, r0, r2);
    const auto ab13 = hn::InterleaveLower(words, r1, r3), cd13 = hn::InterleaveUpper(words, r1, r3);
    a = hn::InterleaveLower(words, ab02, ab13);
    b = hn::InterleaveUpper(words, ab02, ab13);
    c = hn::InterleaveLower(words, cd02, cd13);
    d = hn::InterleaveUpper(words, cd02, cd13);
}

template <int stride>
HWY_INLINE void load_each4(const std::int32_t* p, const std::uint32_t* index, I& a, I& b, I& c,
                           I& d) {
    const auto quarter = [&](int r) {
        return blocks_of(Ints(), r, [&](int lane) {
            return hn::LoadU(hn::FixedTag<std::int32_t, 4>(),
                             p + std::size_t(index[lane * stride]) * 4);
        });
    };
    transpose_blocks(quarter(0), quarter(1), quarter(2), quarter(3), a.v, b.v, c.v, d.v);
}

// Part r: lanes r, 4 + r, …
using Quads = F;
inline constexpr int part_count = 4;
HWY_INLINE Quads select_positive(Quads m, Quads yes, Quads no) {
    return {hn::IfThenElse(hn::Gt(m.v, hn::Zero(Floats())), yes.v, no.v)};
}
template <int part>
HWY_INLINE Quads spread(F v) {
    return {hn::Broadcast<part>(v.v)};
}
template <int part>
HWY_INLINE Quads load_texels(const float* texels, const std::uint32_t* at) {
    return {blocks_of(Floats(), part, [&](int lane) {
        return hn::LoadU(hn::FixedTag<float, 4>(), texels + std::size_t(at[lane]) * 4);
    })};
}
// Of two rows of texels, channel by channel.
template <class V>
HWY_INLINE hn::Vec<Floats> column_of(V interleaved, V weights) {
    return hn::ConvertTo(Floats(), sums_of_pairs(interleaved, weights));
}
template <int part>
HWY_INLINE void load_columns(const std::int16_t* texels, const std::uint32_t* top,
                             const std::uint32_t* bottom, I weights, Quads& left, Quads& right) {
    const hn::Repartition<std::int16_t, Ints> shorts;
    const auto row = [&](const std::uint32_t* at) {
        return blocks_of(shorts, part, [&](int lane) {
            return hn::LoadU(hn::FixedTag<std::int16_t, 8>(), texels + std::size_t(at[lane]) * 4);
        });
    };
    const auto a = row(top), b = row(bottom);
    const auto w = hn::BitCast(shorts, hn::Broadcast<part>(weights.v));
    left = {column_of(hn::InterleaveLower(shorts, a, b), w)};
    right = {column_of(hn::InterleaveUpper(shorts, a, b), w)};
}
template <int part>
HWY_INLINE void load_pair_columns(const std::int16_t* texels, const std::uint32_t* top,
                                  const std::uint32_t* bottom, I weights, Quads left[2],
                                  Quads right[2]) {
    const hn::Repartition<std::int16_t, Ints> shorts;
    const auto w = hn::BitCast(shorts, hn::Broadcast<part>(weights.v));
#if HWY_TARGET <= HWY_AVX2
    // Both textures' texels and those beside them are 32 bytes: one lane in a half of a vector.
    const auto row = [&](const std::uint32_t* at, int lane) {
        const hn::FixedTag<std::int16_t, 16> one;
        const auto first = hn::LoadU(one, texels + std::size_t(at[lane]) * 8);
#if HWY_TARGET <= HWY_AVX3
        const auto second = hn::LoadU(one, texels + std::size_t(at[lane + 4]) * 8);
        return hn::Vec<decltype(shorts)>{
            _mm512_inserti64x4(_mm512_castsi256_si512(first.raw), second.raw, 1)};
#else
        return first;
#endif
    };
#if HWY_TARGET <= HWY_AVX3
    constexpr int lanes_apart = 8;
    const auto w0 = hn::Vec<decltype(shorts)>{_mm512_shuffle_i32x4(w.raw, w.raw, 0x50)};
    const auto w1 = hn::Vec<decltype(shorts)>{_mm512_shuffle_i32x4(w.raw, w.raw, 0xfa)};
    // Every second block of 16 bytes of both.
    const auto even = [](auto a, auto b) {
        return hn::Vec<Floats>{_mm512_shuffle_f32x4(a.raw, b.raw, 0x88)};
    };
    const auto odd = [](auto a, auto b) {
        return hn::Vec<Floats>{_mm512_shuffle_f32x4(a.raw, b.raw, 0xdd)};
    };
#else
    constexpr int lanes_apart = 4;
    const auto w0 = hn::ConcatLowerLower(shorts, w, w), w1 = hn::ConcatUpperUpper(shorts, w, w);
    const auto even = [](auto a, auto b) { return hn::ConcatLowerLower(Floats(), b, a); };
    const auto odd = [](auto a, auto b) { return hn::ConcatUpperUpper(Floats(), b, a); };
#endif
    const auto a0 = row(top, part), b0 = row(bottom, part);
    const auto a1 = row(top, part + lanes_apart), b1 = row(bottom, part + lanes_apart);
    const auto first0 = column_of(hn::InterleaveLower(shorts, a0, b0), w0);
    const auto first1 = column_of(hn::InterleaveLower(shorts, a1, b1), w1);
    const auto second0 = column_of(hn::InterleaveUpper(shorts, a0, b0), w0);
    const auto second1 = column_of(hn::InterleaveUpper(shorts, a1, b1), w1);
    left[0] = {even(first0, first1)};
    right[0] = {odd(first0, first1)};
    left[1] = {even(second0, second1)};
    right[1] = {odd(second0, second1)};
#else
    const auto load = [&](const std::uint32_t* at, std::size_t beside) {
        return hn::LoadU(hn::FixedTag<std::int16_t, 8>(),
                         texels + (std::size_t(at[part]) + beside) * 8);
    };
    const auto columns = [&](std::size_t beside, Quads& first, Quads& second) {
        const auto a = load(top, beside), b = load(bottom, beside);
        first = {column_of(hn::InterleaveLower(shorts, a, b), w)};
        second = {column_of(hn::InterleaveUpper(shorts, a, b), w)};
    };
    columns(0, left[0], left[1]);
    columns(1, right[0], right[1]);
#endif
}
HWY_INLINE void channels_of(const Quads parts[], F out[4]) {
    transpose_blocks(parts[0].v, parts[1].v, parts[2].v, parts[3].v, out[0].v, out[1].v, out[2].v,
                     out[3].v);
}
HWY_INLINE void store_interleaved4(I a, I b, I c, I d, std::int32_t* p) {
    hn::StoreInterleaved4(a.v, b.v, c.v, d.v, Ints(), p);
}

HWY_INLINE void store_sequence(std::uint16_t first, std::size_t count, std::uint16_t* p) {
    const hn::ScalableTag<std::uint16_t> d;
    const auto from_first = hn::Iota(d, 0);
    const std::size_t step = hn::Lanes(d);
    static_assert(HWY_TARGET <= HWY_AVX3 || hn::MaxLanes(d) <= tile_padding);
    for (std::size_t k = 0; k < count; k += step)
        store_lanes(d, hn::Add(hn::Set(d, std::uint16_t(first + k)), from_first),
                    hn::FirstN(d, count - k), p + k);
}

struct Pick {
    decltype(hn::IndicesFromVec(Floats(), hn::Zero(Ints()))) v;
};
HWY_INLINE Pick pick_of(I index) {
    return {hn::IndicesFromVec(Floats(), index.v)};
}
HWY_INLINE F pick(const float* table, Pick at) {
    return {hn::TableLookupLanes(hn::LoadU(Floats(), table), at.v)};
}
HWY_INLINE I pick(const std::int32_t* table, Pick at) {
    const auto as_floats = hn::BitCast(Floats(), hn::LoadU(Ints(), table));
    return {hn::BitCast(Ints(), hn::TableLookupLanes(as_floats, at.v))};
}
