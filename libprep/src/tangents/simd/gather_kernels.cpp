#include "base/simd_targets.h"
#include "tangents/gather.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tangents/simd/gather_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Index = std::uint32_t;
using Floats = hn::ScalableTag<float>;
using F = hn::Vec<Floats>;
using Indices = hn::RebindToUnsigned<Floats>;

#include "base/simd_blocks-inl.h"

// Blocks of four lanes of a and b are the rows of 4 × 4 matrices with those of c and e: their
// first three columns.
HWY_INLINE void store_columns(F a, F b, F c, F e, float (*to)[TermBlock::size], std::size_t i) {
    const Floats d;
    const hn::RepartitionToWide<Floats> pairs;
    const auto ab = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
    const auto ce = hn::BitCast(pairs, hn::InterleaveLower(d, c, e));
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, ab, ce)), d, to[0] + i);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, ab, ce)), d, to[1] + i);
    const auto upper_ab = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
    const auto upper_ce = hn::BitCast(pairs, hn::InterleaveUpper(d, c, e));
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, upper_ab, upper_ce)), d, to[2] + i);
}

// Values of one corner of as many triangles as a vector has lanes. Reads four bytes behind each.
HWY_INLINE void stage_vectors(const glm::vec3* values, const Index* indices,
                              float (*to)[TermBlock::size], std::size_t i) {
    const hn::FixedTag<float, 4> four;
    const auto row = [&](std::size_t r) HWY_ATTR {
        return in_blocks(Floats(), [&](std::size_t j) HWY_ATTR {
            return hn::LoadU(four, &values[indices[12 * j + 3 * r]].x);
        });
    };
    store_columns(row(0), row(1), row(2), row(3), to, i);
}

HWY_INLINE void stage_uvs(const glm::vec2* values, const Index* indices,
                          float (*to)[TermBlock::size], std::size_t i) {
    const Floats d;
    const hn::RepartitionToWide<Floats> pairs;
    const hn::FixedTag<float, 4> four;
    const hn::FixedTag<float, 2> two;
    const auto row = [&](std::size_t r) HWY_ATTR {
        return in_blocks(Floats(), [&](std::size_t j) HWY_ATTR {
            const auto at = [&](std::size_t k) HWY_ATTR {
                return hn::LoadU(two, &values[indices[12 * j + 3 * k]].x);
            };
            return hn::Combine(four, at(r + 2), at(r));
        });
    };
    const F a = row(0), b = row(1);
    const auto lower = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
    const auto upper = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, lower, upper)), d, to[0] + i);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, lower, upper)), d, to[1] + i);
}

// Are the indices of as many triangles as a vector has lanes all below the limit?
HWY_INLINE bool all_below(const Index* indices, std::size_t limit) {
    const Indices d;
    const std::size_t n = hn::Lanes(d);
    const auto largest = hn::Max(hn::Max(hn::LoadU(d, indices), hn::LoadU(d, indices + n)),
                                 hn::LoadU(d, indices + 2 * n));
    return hn::AllTrue(d,
                       hn::Lt(largest, hn::Set(d, Index(std::min<std::size_t>(limit, no_index)))));
}

std::size_t stage(const StageInput& in, std::size_t first, std::size_t count, std::size_t to,
                  TermBlock& block) {
    const std::size_t lanes = hn::Lanes(Floats());
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        const Index* const p = in.position_indices + 3 * (first + i);
        const Index* const n = in.normal_indices + 3 * (first + i);
        const Index* const uv = in.uv_indices + 3 * (first + i);
        if (HWY_UNLIKELY(!all_below(p, in.positions.size() - 1) ||
                         !all_below(n, in.normals.size() - 1) || !all_below(uv, in.uvs.size())))
            break;
        for (std::size_t k = 0; k < 3; ++k) {
            stage_vectors(in.positions.data(), p + k, block.p[k], to + i);
            stage_vectors(in.normals.data(), n + k, block.n[k], to + i);
            stage_uvs(in.uvs.data(), uv + k, block.uv[k], to + i);
        }
    }
    return i;
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

StageKernel stage_kernel(SimdLevel level) {
    [[maybe_unused]] const std::int64_t usable = HWY_TARGETS & machine_targets();
    [[maybe_unused]] const bool any = level == SimdLevel::automatic;
#if HWY_TARGETS & HWY_AVX3
    if ((any || level == SimdLevel::avx512) && (usable & HWY_AVX3)) return N_AVX3::stage;
#endif
#if HWY_TARGETS & HWY_AVX2
    if ((any || level == SimdLevel::avx2) && (usable & HWY_AVX2)) return N_AVX2::stage;
#endif
#if HWY_TARGETS & HWY_SSE4
    if ((any || level == SimdLevel::sse4) && (usable & HWY_SSE4)) return N_SSE4::stage;
#endif
    return nullptr;
}

}  // namespace prep::detail
#endif
