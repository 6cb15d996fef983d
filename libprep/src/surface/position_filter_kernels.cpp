#include "base/simd_targets.h"
#include "surface/position_filter.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/position_filter_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Index = std::uint32_t;

#include "base/compress_store-inl.h"

using Floats = hn::ScalableTag<float>;
using Indices = hn::RebindToUnsigned<Floats>;
using I = hn::Vec<Indices>;

struct Bits {
    I word, bits;
};

// filter_bits of a vector's positions.
HWY_INLINE Bits bits_of(const float* positions, I last_word) {
    const Floats df;
    const Indices d;
    hn::Vec<Floats> x, y, z;
    hn::LoadInterleaved3(df, positions, x, y, z);
    const auto value = [&](hn::Vec<Floats> v)
                           HWY_ATTR { return hn::BitCast(d, hn::Add(v, hn::Zero(df))); };
    I h = hn::Mul(value(x), hn::Set(d, 0x9e3779b1u));
    h = hn::Mul(hn::Add(hn::Xor(h, hn::ShiftRight<15>(h)), value(y)), hn::Set(d, 0x85ebca6bu));
    h = hn::Mul(hn::Add(hn::Xor(h, hn::ShiftRight<13>(h)), value(z)), hn::Set(d, 0xc2b2ae35u));
    h = hn::Xor(h, hn::ShiftRight<16>(h));
    const I other = hn::Mul(h, hn::Set(d, 0x27d4eb2fu)), one = hn::Set(d, 1u);
    const I second = hn::And(hn::ShiftRight<22>(other), hn::Set(d, 31u));
    return {hn::And(h, last_word),
            hn::Or(hn::Shl(one, hn::ShiftRight<27>(other)), hn::Shl(one, second))};
}

void bits(const glm::vec3* positions, std::size_t count, Index last_word, Index* words,
          Index* bits_to) {
    const Indices d;
    const I last = hn::Set(d, last_word);
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
        const Bits found = bits_of(&positions[i].x, last);
        hn::StoreU(found.word, d, words + i);
        hn::StoreU(found.bits, d, bits_to + i);
    }
    for (; i < count; ++i) {
        const FilterBits found = filter_bits(positions[i], last_word);
        words[i] = found.word;
        bits_to[i] = found.bits;
    }
}

std::size_t find(const glm::vec3* positions, std::size_t count, Index last_word,
                 const Index* filter, Index first, Index* found) {
    const Indices d;
    const hn::RebindToSigned<Indices> di;
    static_assert(hn::MaxLanes(d) <= most_filter_lanes);
    const I last = hn::Set(d, last_word), lane = hn::Iota(d, 0);
    std::size_t i = 0, n = 0;
    for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
        const Bits at = bits_of(&positions[i].x, last);
        const I word = hn::GatherIndex(d, filter, hn::BitCast(di, at.word));
        const auto set = hn::Eq(hn::And(word, at.bits), at.bits);
        if (HWY_LIKELY(hn::AllFalse(d, set))) continue;
        n += compress_store(d, hn::Add(hn::Set(d, first + Index(i)), lane), set, found + n);
    }
    for (; i < count; ++i) {
        const FilterBits at = filter_bits(positions[i], last_word);
        if ((filter[at.word] & at.bits) == at.bits) found[n++] = first + Index(i);
    }
    return n;
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

FilterKernels filter_kernels(SimdLevel level) {
    return {SIMD_KERNEL(level, bits), SIMD_KERNEL(level, find)};
}

}  // namespace prep::detail
#endif
