// The vector form of fans_scalar (tangent_fans.cpp): the same sums in the same order.
#include "simd/targets.h"
#include "tangent_fans.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/tangent_fan_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Index = std::uint32_t;
using Quad = hn::CappedTag<float, 4>;

// Does each member meet all others on its way from successor to successor? The members met within
// 2, 4, 8, 16 steps, as bits.
template <class Indices, class V>
HWY_INLINE bool one_ring(Indices d, V successor, std::size_t count) {
    const auto all = hn::Set(d, (1u << count) - 1);
    auto met = hn::IfThenElse(hn::FirstN(d, count), hn::Shl(hn::Set(d, 1), hn::Iota(d, 0)), all);
    for (std::size_t steps = 1; steps < count; steps *= 2) {
        const auto table = hn::IndicesFromVec(d, successor);
        met = hn::Or(met, hn::TableLookupLanes(met, table));
        successor = hn::TableLookupLanes(successor, table);
    }
    return hn::AllTrue(d, hn::Eq(met, all));
}

// Of several members that enter from one vertex the last is every successor. In a ring the others
// would be missing; an open fan may seem to begin with one, so there its beginning is looked at.
template <class Indices>
HWY_INLINE bool one_fan(Indices d, const FanInput& in, const Index* members, std::size_t count) {
    const hn::RebindToSigned<Indices> di;
    constexpr std::size_t lanes = hn::MaxLanes(d);
    HWY_ALIGN Index next[most_fan_members];
    HWY_ALIGN Index previous[most_fan_members];
    HWY_ALIGN Index successors[most_fan_members];
    for (std::size_t i = 0; i < count; i += lanes) {
        const auto inside = hn::FirstN(d, count - i);
        // In the lanes behind the last: the first corner of the first triangle.
        const auto m = hn::IfThenElseZero(inside, hn::LoadU(d, members + i));
        const auto k = hn::And(m, hn::Set(d, 3));
        const auto corner = hn::Sub(m, hn::ShiftRight<2>(m));
        const auto one = hn::Set(d, 1), two = hn::Set(d, 2);
        const auto after =
            hn::IfThenElse(hn::Eq(k, two), hn::Sub(corner, two), hn::Add(corner, one));
        const auto before =
            hn::IfThenElse(hn::Eq(k, hn::Zero(d)), hn::Add(corner, two), hn::Sub(corner, one));
        const auto n = hn::GatherIndex(d, in.vertices, hn::BitCast(di, after));
        // What nothing equals: vertices are below no_index.
        hn::Store(hn::IfThenElse(inside, n, hn::Set(d, no_index)), d, next + i);
        hn::Store(hn::GatherIndex(d, in.vertices, hn::BitCast(di, before)), d, previous + i);
    }
    const auto none = hn::Set(d, Index(most_fan_members));
    std::size_t open = 0;
    for (std::size_t i = 0; i < count; i += lanes) {
        const auto wanted = hn::Load(d, next + i);
        const auto own = hn::Iota(d, Index(i));
        auto successor = hn::IfThenElse(hn::FirstN(d, count - i), none, own);
        for (std::size_t j = 0; j < count; ++j) {
            const auto equal = hn::Eq(wanted, hn::Set(d, previous[j]));
            successor = hn::IfThenElse(equal, hn::Set(d, Index(j)), successor);
        }
        const std::size_t ends = hn::CountTrue(d, hn::Eq(successor, none));
        if (lanes >= count && ends == 0) return one_ring(d, successor, count);
        open += ends;
        hn::Store(successor, d, successors + i);
    }
    if (open > 1) return false;
    if (open == 1) {
        const Index first = close_fan(successors, count);
        if (first >= count || std::find(next, next + count, previous[first]) != next + count)
            return false;
    }
    return is_one_ring(successors, count);
}

void fans(const FanInput& in, std::size_t begin, std::size_t end, FanSum* sums) {
    const Quad quad;
    const hn::RebindToUnsigned<Quad> bits;
    HWY_ALIGN Index all_lanes[4];
    HWY_ALIGN Index any_lanes[4];
    HWY_ALIGN const Index xyz[4] = {~0u, ~0u, ~0u, 0};
    const auto numbers = hn::Load(bits, xyz);
    for (std::size_t v = begin; v < end; ++v) {
        FanSum& result = sums[v - begin];
        const std::size_t count = in.offsets[v + 1] - in.offsets[v];
        hn::Store(hn::Zero(quad), quad, &result.x);
        if (count == 0 || count > most_fan_members || in.split[v]) continue;
        const Index* members = in.members + in.offsets[v];
        auto sum = hn::Zero(quad);
        auto all = hn::Set(bits, ~0u), any = hn::Zero(bits);
        for (std::size_t i = 0; i < count; ++i) {
            const auto term = hn::Load(quad, &in.planes[members[i] & 3][members[i] >> 2].x);
            const auto code = hn::BitCast(bits, term);
            sum = hn::Add(sum, hn::BitCast(quad, hn::And(code, numbers)));
            all = hn::And(all, code);
            any = hn::Or(any, code);
        }
        hn::Store(all, bits, all_lanes);
        hn::Store(any, bits, any_lanes);
        if (!may_be_fan(all_lanes[3], any_lanes[3], count)) continue;
        if (count > 1 &&
            !(count <= 8 ? one_fan(hn::CappedTag<Index, 8>(), in, members, count)
                         : one_fan(hn::CappedTag<Index, most_fan_members>(), in, members, count)))
            continue;
        hn::Store(sum, quad, &result.x);
        result.code = (any_lanes[3] & orientation_preserving) | fan_found;
    }

    // Unit, and held against the normals, many at once.
    const hn::ScalableTag<float> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    const hn::RebindToSigned<decltype(d)> di;
    const bool look = in.normal_indices != nullptr && !in.normals.empty();
    const float* const normals = look ? &in.normals[0].x : nullptr;
    const Index last_normal = look ? Index(in.normals.size() - 1) : 0;
    const std::size_t count = end - begin;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        hn::Vec<decltype(d)> x, y, z, code;
        hn::LoadInterleaved4(d, &sums[i].x, x, y, z, code);
        const auto least = hn::Set(d, std::numeric_limits<float>::min());
        const auto not_zero = hn::Or(hn::Or(hn::Gt(hn::Abs(x), least), hn::Gt(hn::Abs(y), least)),
                                     hn::Gt(hn::Abs(z), least));
        const auto squared = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
        const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(squared));
        x = hn::IfThenElse(not_zero, hn::Mul(inverse, x), x);
        y = hn::IfThenElse(not_zero, hn::Mul(inverse, y), y);
        z = hn::IfThenElse(not_zero, hn::Mul(inverse, z), z);
        if (look) {
            const auto first = hn::LoadU(du, in.offsets + begin + i);
            const auto m = hn::GatherIndex(du, in.members, hn::BitCast(di, first));
            const auto corner = hn::Sub(m, hn::ShiftRight<2>(m));
            const auto index = hn::GatherIndex(du, in.normal_indices, hn::BitCast(di, corner));
            const auto known = hn::Min(index, hn::Set(du, last_normal));
            const auto at = hn::BitCast(di, hn::Add(hn::Add(known, known), known));
            const auto nx = hn::GatherIndex(d, normals, at);
            const auto ny = hn::GatherIndex(d, normals + 1, at);
            const auto nz = hn::GatherIndex(d, normals + 2, at);
            const auto dot = [](const auto& ax, const auto& ay, const auto& az, const auto& bx,
                                const auto& by, const auto& bz) {
                return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
            };
            const auto one = hn::Set(d, 1.0f);
            const auto off_normal = hn::Abs(hn::Sub(dot(nx, ny, nz, nx, ny, nz), one));
            const auto off_length = hn::Abs(hn::Sub(dot(x, y, z, x, y, z), one));
            const auto along = hn::Abs(dot(nx, ny, nz, x, y, z));
            const auto good = hn::And(
                hn::And(hn::Le(off_normal, hn::Set(d, 2e-3f)),
                        hn::Le(off_length, hn::Set(d, 1e-6f))),
                hn::And(hn::Le(along, hn::Set(d, 5e-7f)), hn::RebindMask(d, hn::Eq(known, index))));
            const auto frame = hn::IfThenElseZero(hn::RebindMask(du, good), hn::Set(du, fan_frame));
            const auto bits_now = hn::BitCast(du, code);
            const auto found = hn::Ne(bits_now, hn::Zero(du));
            code = hn::BitCast(d, hn::Or(bits_now, hn::IfThenElseZero(found, frame)));
        }
        hn::StoreInterleaved4(x, y, z, code, d, &sums[i].x);
    }
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

FanKernel fan_kernel(SimdLevel level, std::size_t triangles, std::size_t normals) {
    // Vectors hold indices of corners and of floats as signed numbers.
    if (3 * std::max(triangles, normals) > std::numeric_limits<std::int32_t>::max())
        return fans_scalar;
    [[maybe_unused]] const std::int64_t usable = HWY_TARGETS & machine_targets();
    const bool any = level == SimdLevel::automatic;
#if HWY_TARGETS & HWY_AVX3
    if ((any || level == SimdLevel::avx512) && (usable & HWY_AVX3)) return N_AVX3::fans;
#endif
#if HWY_TARGETS & HWY_AVX2
    if ((any || level == SimdLevel::avx2) && (usable & HWY_AVX2)) return N_AVX2::fans;
#endif
#if HWY_TARGETS & HWY_SSE4
    if ((any || level == SimdLevel::sse4) && (usable & HWY_SSE4)) return N_SSE4::fans;
#endif
    return fans_scalar;
}

}  // namespace prep::detail
#endif
