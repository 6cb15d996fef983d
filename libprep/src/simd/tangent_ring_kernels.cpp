// The vector form of rings_scalar (tangent_rings.cpp): the same sums.
#include "simd/targets.h"
#include "tangent_rings.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/tangent_ring_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Index = std::uint32_t;
using Indices = hn::ScalableTag<Index>;

// Tells closed rings of K members, as many at once as a vector has lanes: from the vertex to which
// the first member's edge leaves to the member that enters from there, and on. The walk takes a
// step at a time; it is a ring of all when it comes back to the first in step K and not before.
// (No step is without a member then, none comes to a vertex twice, so each of the K − 1 steps
// before has a different one of K − 1 members, and just one.) Calls told(i, is a ring) for all of
// the list; slots[i] is the vertex' slot.
template <std::size_t K, class Told>
HWY_INLINE void tell_rings(const VertexRing* rings, const Index* slots, const Index* list,
                           std::size_t count, const Told& told) {
    const Indices d;
    const hn::RebindToSigned<Indices> di;
    constexpr std::size_t lanes = hn::MaxLanes(d);
    constexpr int ring_words_shift = 4;
    static_assert(sizeof(VertexRing) == sizeof(Index) << ring_words_shift);
    HWY_ALIGN Index closed_lanes[lanes];
    const Index* const words = rings[0].previous;
    for (std::size_t i = 0; i < count; i += lanes) {
        // Lists are readable to the end of a vector, and have numbers of slots there.
        const auto own = hn::BitCast(di, hn::LoadU(d, list + i));
        const auto at = hn::ShiftLeft<ring_words_shift>(hn::GatherIndex(d, slots, own));
        hn::Vec<Indices> previous[K], next[K];
        for (std::size_t k = 0; k < K; ++k) {
            const auto here = hn::Add(at, hn::Set(d, Index(k)));
            const auto behind = hn::Add(here, hn::Set(d, Index(most_ring_members)));
            previous[k] = hn::GatherIndex(d, words, hn::BitCast(di, here));
            next[k] = hn::GatherIndex(d, words, hn::BitCast(di, behind));
        }
        auto vertex = next[0];
        auto early = hn::Eq(vertex, hn::Not(vertex));
        for (std::size_t step = 1; step < K; ++step) {
            early = hn::Or(early, hn::Eq(previous[0], vertex));
            auto onward = vertex;
            for (std::size_t k = 1; k < K; ++k)
                onward = hn::IfThenElse(hn::Eq(previous[k], vertex), next[k], onward);
            vertex = onward;
        }
        const auto closed = hn::AndNot(early, hn::Eq(previous[0], vertex));
        hn::Store(hn::VecFromMask(d, closed), d, closed_lanes);
        const std::size_t used = std::min(lanes, count - i);
        for (std::size_t k = 0; k < used; ++k) told(list[i + k], closed_lanes[k] != 0);
    }
}

void rings(const RingInput& in, StarSum* stars) {
    const std::span<const Index> slots = in.slots;
    const hn::CappedTag<float, 4> quad;
    constexpr std::size_t lanes = hn::MaxLanes(Indices());
    // Those that may be fans, by their number of members.
    HWY_ALIGN Index lists[most_ring_members + 1][ring_batch + lanes];
    std::size_t sizes[most_ring_members + 1] = {};
    const std::size_t n = slots.size();
    for (std::size_t i = 0; i < n; ++i) {
        const VertexSum& sum = in.sums[slots[i]];
        const std::size_t count = in.counts[i];
        hn::Store(hn::Load(quad, &sum.x), quad, &stars[i].x);
        stars[i].code = 0;
        if (!may_be_fan(sum, count)) continue;
        lists[count][sizes[count]++] = Index(i);
    }
    const auto fan = [&](Index i) {
        stars[i].code = (in.sums[slots[i]].code & orientation_preserving) | star_is_fan;
    };
    const auto told = [&](Index i, bool ring) {
        if (ring || is_one_fan(in.rings[slots[i]], in.counts[i])) fan(i);
    };
    for (std::size_t i = 0; i < sizes[1]; ++i) fan(lists[1][i]);
    for (std::size_t count = 2; count <= most_ring_members; ++count) {
        Index* const list = lists[count];
        const std::size_t size = sizes[count];
        if (size == 0) continue;
        std::fill(list + size, list + size + lanes, list[0]);
        const auto tell = [&](auto members) {
            tell_rings<decltype(members)::value>(in.rings, slots.data(), list, size, told);
        };
        switch (count) {
            case 2:
                tell(std::integral_constant<std::size_t, 2>());
                break;
            case 3:
                tell(std::integral_constant<std::size_t, 3>());
                break;
            case 4:
                tell(std::integral_constant<std::size_t, 4>());
                break;
            case 5:
                tell(std::integral_constant<std::size_t, 5>());
                break;
            case 6:
                tell(std::integral_constant<std::size_t, 6>());
                break;
            case 7:
                tell(std::integral_constant<std::size_t, 7>());
                break;
            default:
                tell(std::integral_constant<std::size_t, most_ring_members>());
        }
    }

    // Unit, and held against the normals, many at once.
    const hn::ScalableTag<float> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    const hn::RebindToSigned<decltype(d)> di;
    const bool look = !in.normals.empty();
    const float* const normals = look ? &in.normals[0].x : nullptr;
    const Index last_normal = look ? Index(in.normals.size() - 1) : 0;
    const Index* const uses = &in.sums[0].normal;
    constexpr int sum_words_shift = 3;
    static_assert(sizeof(VertexSum) == sizeof(Index) << sum_words_shift);
    for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
        hn::Vec<decltype(d)> x, y, z, code;
        hn::LoadInterleaved4(d, &stars[i].x, x, y, z, code);
        const auto least = hn::Set(d, std::numeric_limits<float>::min());
        const auto not_zero = hn::Or(hn::Or(hn::Gt(hn::Abs(x), least), hn::Gt(hn::Abs(y), least)),
                                     hn::Gt(hn::Abs(z), least));
        const auto squared = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
        const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(squared));
        x = hn::IfThenElse(not_zero, hn::Mul(inverse, x), x);
        y = hn::IfThenElse(not_zero, hn::Mul(inverse, y), y);
        z = hn::IfThenElse(not_zero, hn::Mul(inverse, z), z);
        if (look) {
            // Behind the last: the last.
            const auto which = hn::Min(hn::Iota(du, Index(i)), hn::Set(du, Index(n - 1)));
            const auto slot = hn::GatherIndex(du, slots.data(), hn::BitCast(di, which));
            const auto index =
                hn::GatherIndex(du, uses, hn::BitCast(di, hn::ShiftLeft<sum_words_shift>(slot)));
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
            const auto frame =
                hn::IfThenElseZero(hn::RebindMask(du, good), hn::Set(du, star_has_frame));
            const auto bits_now = hn::BitCast(du, code);
            const auto found = hn::Ne(bits_now, hn::Zero(du));
            code = hn::BitCast(d, hn::Or(bits_now, hn::IfThenElseZero(found, frame)));
        }
        hn::StoreInterleaved4(x, y, z, code, d, &stars[i].x);
    }
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

RingKernel ring_kernel(SimdLevel level, std::size_t normals) {
    // Vectors hold indices of floats as signed numbers.
    if (3 * normals > std::numeric_limits<std::int32_t>::max()) return rings_scalar;
    [[maybe_unused]] const std::int64_t usable = HWY_TARGETS & machine_targets();
    const bool any = level == SimdLevel::automatic;
#if HWY_TARGETS & HWY_AVX3
    if ((any || level == SimdLevel::avx512) && (usable & HWY_AVX3)) return N_AVX3::rings;
#endif
#if HWY_TARGETS & HWY_AVX2
    if ((any || level == SimdLevel::avx2) && (usable & HWY_AVX2)) return N_AVX2::rings;
#endif
#if HWY_TARGETS & HWY_SSE4
    if ((any || level == SimdLevel::sse4) && (usable & HWY_SSE4)) return N_SSE4::rings;
#endif
    return rings_scalar;
}

}  // namespace prep::detail
#endif
