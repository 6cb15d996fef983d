// Which vertices are one fan, many at once, and their tangents.
#include "base/simd_targets.h"
#include "tangents/accumulate.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tangents/fan_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "base/compress_store-inl.h"

using Index = std::uint32_t;
using Indices = hn::ScalableTag<Index>;

// The K members of a vector's worth of rings.
template <std::size_t K>
struct Members {
    hn::Vec<Indices> previous[K], next[K];
};

#if HWY_TARGET != HWY_SCALAR
#include "base/simd_blocks-inl.h"
#endif

// list: places in the batch, readable to the end of a vector. Two members of four rings at a time
// are a matrix of 4 × 4: loading and turning it is quicker than gathers.
template <std::size_t K>
HWY_INLINE Members<K> members_of(const VertexRing* rings, const Index* slots, const Index* list) {
    Members<K> members;
#if HWY_TARGET == HWY_SCALAR
    const VertexRing& own = rings[slots[*list]];
    for (std::size_t k = 0; k < K; ++k) {
        members.next[k] = hn::Set(Indices(), own.members[k].next);
        members.previous[k] = hn::Set(Indices(), own.members[k].previous);
    }
#else
    const Indices d;
    const hn::FixedTag<Index, 4> four;
    constexpr std::size_t lanes = hn::MaxLanes(d);
    const VertexRing* own[lanes];
    for (std::size_t k = 0; k < lanes; ++k) own[k] = rings + slots[list[k]];
    for (std::size_t k = 0; k < K; k += 2) {
        const auto row = [&](std::size_t r) HWY_ATTR {
            return in_blocks(d, [&](std::size_t j) HWY_ATTR {
                return hn::Load(four, &own[4 * j + r]->members[k].next);
            });
        };
        hn::Vec<Indices> columns[4];
        columns_of_blocks(d, row(0), row(1), row(2), row(3), columns);
        members.next[k] = columns[0];
        members.previous[k] = columns[1];
        if (k + 1 == K) break;
        members.next[k + 1] = columns[2];
        members.previous[k + 1] = columns[3];
    }
#endif
    return members;
}

// From the vertex to which the first member's edge leaves to the member that enters from there, and
// on, a step at a time; it is a ring of all when it comes back to the first in step K and not
// before. (No step is without a member then, none comes to a vertex twice, so each of the K − 1
// steps before has a different one of K − 1 members, and just one.)
template <std::size_t K>
HWY_INLINE hn::Mask<Indices> are_closed(const Members<K>& members) {
    auto vertex = members.next[0];
    auto early = hn::Eq(vertex, hn::Not(vertex));
    for (std::size_t step = 1; step < K; ++step) {
        early = hn::Or(early, hn::Eq(members.previous[0], vertex));
        auto onward = vertex;
        for (std::size_t k = 1; k < K; ++k)
            onward = hn::IfThenElse(hn::Eq(members.previous[k], vertex), members.next[k], onward);
        vertex = onward;
    }
    return hn::AndNot(early, hn::Eq(members.previous[0], vertex));
}

// The same from a member that none leads to: an open fan of all when K − 1 steps find a member each
// and the next one finds none. (Nothing is met twice then: it would go on for ever.)
template <std::size_t K>
HWY_INLINE hn::Mask<Indices> are_open(const Members<K>& members) {
    const auto none = hn::Ne(members.next[0], members.next[0]);
    auto vertex = members.next[0];
    auto open = none;
    for (std::size_t k = 0; k < K; ++k) {
        auto led_to = none;
        for (std::size_t i = 0; i < K; ++i)
            led_to = hn::Or(led_to, hn::Eq(members.next[i], members.previous[k]));
        vertex = hn::IfThenElse(led_to, vertex, members.next[k]);
        open = hn::Or(open, hn::Not(led_to));
    }
    for (std::size_t step = 1; step <= K; ++step) {
        auto found = none;
        auto onward = vertex;
        for (std::size_t k = 0; k < K; ++k) {
            const auto here = hn::Eq(members.previous[k], vertex);
            found = hn::Or(found, here);
            onward = hn::IfThenElse(here, members.next[k], onward);
        }
        open = step < K ? hn::And(open, found) : hn::AndNot(found, open);
        vertex = onward;
    }
    return open;
}

// Sets fans[i] to all bits for those of the list that are one fan.
template <std::size_t K>
HWY_INLINE void tell_fans(const VertexRing* rings, const Index* slots, Index* list,
                          std::size_t count, Index* fans) {
    const Indices d;
    constexpr std::size_t lanes = hn::MaxLanes(d);
    HWY_ALIGN Index told[lanes];
    const auto fill = [&](std::size_t size) HWY_ATTR {
        for (std::size_t k = size; k < size + lanes; ++k) list[k] = list[0];
    };
    fill(count);
    std::size_t rest = 0;  // those not closed, kept at the list's beginning
    for (std::size_t i = 0; i < count; i += lanes) {
        const Members<K> members = members_of<K>(rings, slots, list + i);
        auto closed = are_closed<K>(members);
        // Few members are mostly at borders.
        if constexpr (K <= 3) closed = hn::Or(closed, are_open<K>(members));
        hn::Store(hn::VecFromMask(d, closed), d, told);
        const std::size_t used = std::min(lanes, count - i);
        for (std::size_t k = 0; k < used; ++k) fans[list[i + k]] = told[k];
        if (K <= 3 || HWY_LIKELY(hn::AllTrue(d, closed))) continue;
        for (std::size_t k = 0; k < used; ++k) {
            list[rest] = list[i + k];
            rest += told[k] == 0;
        }
    }
    if (rest == 0) return;
    fill(rest);
    for (std::size_t i = 0; i < rest; i += lanes) {
        hn::Store(hn::VecFromMask(d, are_open<K>(members_of<K>(rings, slots, list + i))), d, told);
        const std::size_t used = std::min(lanes, rest - i);
        for (std::size_t k = 0; k < used; ++k) fans[list[i + k]] = told[k];
    }
}

// The candidates of each number of members, by what can be told without edges; fans of one at once.
HWY_INLINE void sort_candidates(const RingBatch& batch, Index (*lists)[ring_batch + 64],
                                std::size_t* sizes, Index* fans) {
    const Indices d;
    const auto lane = hn::Iota(d, 0);
    for (std::size_t i = 0; i < batch.count; i += hn::Lanes(d)) {
        const auto code = hn::Load(d, batch.codes + i);
        const auto members = hn::Load(d, batch.members + i);
        const auto has = [&](Index bits) HWY_ATTR {
            return hn::Ne(hn::And(code, hn::Set(d, bits)), hn::Zero(d));
        };
        const auto single = hn::Eq(members, hn::Set(d, 1u));
        const auto candidate =
            hn::And(hn::And(has(own_frame), has(orientation_preserving | orientation_mirrored)),
                    hn::And(hn::Or(single, hn::And(has(s_directions), has(t_directions))),
                            hn::FirstN(d, batch.count - i)));
        hn::Store(hn::VecFromMask(d, hn::And(candidate, single)), d, fans + i);
        const auto which = hn::Add(hn::Set(d, Index(i)), lane);
        for (std::size_t count = 2; count <= most_ring_members; ++count) {
            const auto these = hn::And(candidate, hn::Eq(members, hn::Set(d, Index(count))));
            if (hn::AllFalse(d, these)) continue;
            sizes[count] += compress_store(d, which, these, lists[count] + sizes[count]);
        }
    }
}

// Unit, and held against the normals.
HWY_INLINE void finish(std::span<const glm::vec3> normals, const Index* fans, RingBatch& batch) {
    const hn::ScalableTag<float> d;
    const Indices du;
    const hn::RebindToSigned<Indices> di;
    const bool look = !normals.empty();
    const float* const components = look ? &normals[0].x : nullptr;
    const Index last_normal = look ? Index(normals.size() - 1) : 0;
    for (std::size_t i = 0; i < batch.count; i += hn::Lanes(d)) {
        hn::Vec<decltype(d)> x, y, z, unused;
        hn::LoadInterleaved4(d, &batch.sums[i].x, x, y, z, unused);
        const auto least = hn::Set(d, std::numeric_limits<float>::min());
        const auto not_zero = hn::Or(hn::Or(hn::Gt(hn::Abs(x), least), hn::Gt(hn::Abs(y), least)),
                                     hn::Gt(hn::Abs(z), least));
        const auto squared = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
        const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(squared));
        x = hn::IfThenElse(not_zero, hn::Mul(inverse, x), x);
        y = hn::IfThenElse(not_zero, hn::Mul(inverse, y), y);
        z = hn::IfThenElse(not_zero, hn::Mul(inverse, z), z);
        auto code = hn::Or(hn::And(hn::Load(du, batch.codes + i),
                                   hn::Set(du, std::uint32_t(orientation_preserving))),
                           hn::Set(du, sum_is_fan));
        if (look) {
            // Behind the last vertex there may be anything.
            const auto index = hn::IfThenElseZero(hn::FirstN(du, batch.count - i),
                                                  hn::Load(du, batch.normals + i));
            const auto known = hn::Min(index, hn::Set(du, last_normal));
            const auto at = hn::BitCast(di, hn::Add(hn::Add(known, known), known));
            const auto nx = hn::GatherIndex(d, components, at);
            const auto ny = hn::GatherIndex(d, components + 1, at);
            const auto nz = hn::GatherIndex(d, components + 2, at);
            const auto dot = [](const auto& ax, const auto& ay, const auto& az, const auto& bx,
                                const auto& by, const auto& bz) HWY_ATTR {
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
            code = hn::Or(code,
                          hn::IfThenElseZero(hn::RebindMask(du, good), hn::Set(du, sum_has_frame)));
        }
        code = hn::And(code, hn::Load(du, fans + i));
        hn::StoreInterleaved4(x, y, z, hn::BitCast(d, code), d, &batch.sums[i].x);
    }
}

void classify_fans(const VertexRing* rings, std::span<const glm::vec3> normals, RingBatch& batch) {
    static_assert(hn::MaxLanes(Indices()) <= 64);
    HWY_ALIGN Index lists[most_ring_members + 1][ring_batch + 64];
    HWY_ALIGN Index fans[ring_batch];
    std::size_t sizes[most_ring_members + 1] = {};
    sort_candidates(batch, lists, sizes, fans);
    const auto tell = [&]<std::size_t... K>(std::index_sequence<K...>) HWY_ATTR {
        const auto tell_one = [&]<std::size_t count>() HWY_ATTR {
            if (sizes[count] > 0)
                tell_fans<count>(rings, batch.slots, lists[count], sizes[count], fans);
        };
        (tell_one.template operator()<K + 2>(), ...);
    };
    tell(std::make_index_sequence<most_ring_members - 1>());
    finish(normals, fans, batch);
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

FanKernel fan_kernel(SimdLevel level) {
    return SIMD_KERNEL(level, classify_fans);
}

}  // namespace prep::detail
#endif
