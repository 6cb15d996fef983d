#include "base/simd_targets.h"
#include "tangents/worklist.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tangents/simd/worklist_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

std::size_t leading_fans(const std::uint8_t* states, const std::uint32_t* vertices,
                         std::size_t triangles) {
    const hn::ScalableTag<std::uint32_t> d;
    const hn::RebindToSigned<decltype(d)> di;
    const std::size_t lanes = hn::Lanes(d);
    const auto* const words = reinterpret_cast<const std::uint32_t*>(states);
    std::size_t t = 0;
    for (; t + lanes <= triangles; t += lanes) {
        const auto state = [&](std::size_t part) HWY_ATTR {
            const auto v = hn::LoadU(d, vertices + 3 * t + part * lanes);
            return hn::Xor(hn::GatherOffset(d, words, hn::BitCast(di, v)),
                           hn::Set(d, std::uint32_t(fan_vertex)));
        };
        const auto other = hn::And(hn::Or(hn::Or(state(0), state(1)), state(2)), hn::Set(d, 0xffu));
        if (!hn::AllTrue(d, hn::Eq(other, hn::Zero(d)))) break;
    }
    return t;
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

FanSearch fan_search() {
    [[maybe_unused]] const std::int64_t usable = HWY_TARGETS & machine_targets();
#if HWY_TARGETS & HWY_AVX3
    if (usable & HWY_AVX3) return N_AVX3::leading_fans;
#endif
#if HWY_TARGETS & HWY_AVX2
    if (usable & HWY_AVX2) return N_AVX2::leading_fans;
#endif
    return nullptr;
}

}  // namespace prep::detail
#endif
