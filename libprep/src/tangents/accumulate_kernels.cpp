#include "base/simd_targets.h"
#include "tangents/accumulate.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tangents/accumulate_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Index = std::uint32_t;

#include "base/compress_store-inl.h"

struct Corner {
    std::uint64_t next_previous;  // vertices, as VertexRing has them
    Index normal, uv;             // indices
};

HWY_INLINE std::uint64_t two(const Index* vertices) {
    std::uint64_t pair;
    std::memcpy(&pair, vertices, sizeof pair);
    return pair;
}
HWY_INLINE std::uint64_t two(Index first, Index second) {
    const Index pair[2] = {first, second};
    return two(pair);
}

// Adds a contribution's numbers; of its bits those are kept that both have.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void add_numbers(const Contribution& contribution, VertexSum& sum) {
    sum.x += contribution.x;
    sum.y += contribution.y;
    sum.z += contribution.z;
    sum.code &= contribution.code;
}
HWY_INLINE void add_numbers(const CornerRecord& record, VertexSum& sum) {
    const std::uint32_t code = (record.code & CornerRecord::code_mask) | code_float;
    add_numbers(Contribution{record.x, record.y, record.z, code}, sum);
}
#else
using Numbers = hn::Vec<hn::FixedTag<float, 4> >;
HWY_INLINE void add_numbers(Numbers more, VertexSum& sum) {
    const hn::FixedTag<float, 4> d;
    HWY_ALIGN constexpr Index xyz[4] = {~0u, ~0u, ~0u, 0};
    const auto is_number =
        hn::MaskFromVec(hn::BitCast(d, hn::Load(hn::RebindToUnsigned<decltype(d)>(), xyz)));
    const auto old = hn::Load(d, &sum.x);
    hn::Store(hn::IfThenElse(is_number, hn::Add(old, more), hn::And(old, more)), d, &sum.x);
}
HWY_INLINE void add_numbers(const Contribution& contribution, VertexSum& sum) {
    add_numbers(hn::Load(hn::FixedTag<float, 4>(), &contribution.x), sum);
}
HWY_INLINE void add_numbers(const CornerRecord& record, VertexSum& sum) {
    const hn::FixedTag<float, 4> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    HWY_ALIGN constexpr Index kept[4] = {~0u, ~0u, ~0u, CornerRecord::code_mask};
    HWY_ALIGN constexpr Index added[4] = {0, 0, 0, code_float};
    const auto all = hn::BitCast(du, hn::Load(d, &record.x));
    add_numbers(hn::BitCast(d, hn::Or(hn::And(all, hn::Load(du, kept)), hn::Load(du, added))), sum);
}
#endif

// True where normal or UV are not the first corner's.
template <class Numbered>
HWY_INLINE bool add_to(const Corner& corner, const Numbered& contribution, Index met,
                       VertexSum& sum, VertexRing& ring) {
    add_numbers(contribution, sum);
    static_assert(offsetof(VertexSum, uv) == offsetof(VertexSum, normal) + sizeof(Index));
    const std::uint64_t own = std::uint64_t(corner.uv) << 32 | corner.normal;
    std::uint64_t first;
    std::memcpy(&first, &sum.normal, sizeof first);
    first = met == 0 ? own : first;
    std::memcpy(&sum.normal, &first, sizeof first);
    std::memcpy(&ring.members[met % most_ring_members], &corner.next_previous,
                sizeof corner.next_previous);
    return own != first;
}

// What a block's corners find, one after the other: the vertex' word afterwards; `none` where a
// vertex is not counted, or the triangle degenerate.
struct Met {
    static constexpr std::size_t size = 3 * TriangleBlock::size;
    static constexpr Index none = ~0u;
    HWY_ALIGN Index corners[size];
};

// Counts the corners off and gives new vertices their slots. Apart from what follows: a processor
// that has seen loads depend on earlier stores makes them wait until it knows where all of these
// go, and here nothing that is loaded says where a store goes.
HWY_INLINE void count_off(const Index* HWY_RESTRICT vertices, std::size_t corners,
                          AccumulateState& state, Met& met, AccumulateLists& lists) {
    Index* HWY_RESTRICT const words = state.words;
    const Index* HWY_RESTRICT const free = state.free;
    Index* HWY_RESTRICT const to = met.corners;
    std::size_t free_count = state.free_count;
    for (std::size_t c = 0; c < corners; ++c) {
        const Index v = vertices[c], word = words[v];
        if (HWY_UNLIKELY(word & VertexWord::apart)) {
            to[c] = Met::none;
            lists.left[lists.left_count++] = Index(c + c / 3);
            continue;
        }
        // A branch: what follows would wait for the slot, and on for the next one, else.
        Index after = word + (VertexWord::met_one - 1);
        if (HWY_UNLIKELY(word < VertexWord::met_one)) after += free[--free_count];
        words[v] = after;
        to[c] = after;
    }
    state.free_count = free_count;
}

// The same where some triangles are degenerate: those are counted off without being met.
HWY_NOINLINE void count_off_some(const Index* vertices, std::size_t triangles,
                                 const Contribution* contributions, AccumulateState& state,
                                 Met& met, AccumulateLists& lists) {
    for (std::size_t i = 0; i < triangles; ++i) {
        const bool out = (contributions[i].code & degenerate_triangle) != 0;
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const Index v = vertices[c];
            Index& word = state.words[v];
            met.corners[c] = Met::none;
            if (word & VertexWord::apart) {
                if (!out) lists.left[lists.left_count++] = Index(c + i);
                continue;
            }
            if (out) {
                --word;
                if ((word & VertexWord::to_come) != 0) continue;
                state.done_vertices[state.done_count] = v;
                state.done_words[state.done_count++] = word;
                continue;
            }
            if (word < VertexWord::met_one) word += state.free[--state.free_count];
            word += VertexWord::met_one - 1;
            met.corners[c] = word;
        }
    }
}

// Vertices that have met all their triangles.
HWY_INLINE void find_done(const Index* vertices, std::size_t corners, const Met& met,
                          AccumulateState& state) {
    const hn::ScalableTag<Index> d;
    for (std::size_t c = 0; c < corners; c += hn::Lanes(d)) {
        const auto after = hn::Load(d, met.corners + c);
        const auto done = hn::Eq(hn::And(after, hn::Set(d, VertexWord::to_come)), hn::Zero(d));
        const std::size_t rest = corners - c;
        if (rest >= hn::Lanes(d)) {
            compress_store(d, after, done, state.done_words + state.done_count);
            state.done_count += compress_store(d, hn::LoadU(d, vertices + c), done,
                                               state.done_vertices + state.done_count);
            continue;
        }
        for (std::size_t k = c; k < corners; ++k) {
            if ((met.corners[k] & VertexWord::to_come) != 0) continue;
            state.done_vertices[state.done_count] = vertices[k];
            state.done_words[state.done_count++] = met.corners[k];
        }
    }
}

template <bool own_corners>
HWY_INLINE void add_all(const AccumulateInput& in, std::size_t first, std::size_t count,
                        const Contribution* const planes[3], const Met& met, AccumulateState& state,
                        AccumulateLists& lists) {
    // Local copies of all pointers: writing to vertices could change what is reached through
    // others.
    VertexSum* const sums = state.sums;
    VertexRing* const rings = state.rings;
    const Index *const vertices = in.vertices + 3 * first, *const normals = in.normals,
                       *const uvs = in.uvs;
    const Index* const corners = own_corners ? in.corners + 3 * first : nullptr;
    const Contribution *const term0 = planes[0], *const term1 = planes[1], *const term2 = planes[2];
    for (std::size_t i = 0; i < count; ++i) {
        const Index* const v = vertices + 3 * i;
        const auto add = [&](std::size_t k, std::uint64_t next_previous,
                             const Contribution& contribution) HWY_ATTR {
            const std::size_t at = 3 * i + k, c = own_corners ? corners[at] : 3 * first + at;
            const Index found = met.corners[at];
            if (HWY_UNLIKELY(found == Met::none)) return;
            const Index slot = found / VertexWord::slot_one;
            const Index before = (found / VertexWord::met_one & 0x0f) - 1;
            if (HWY_UNLIKELY(add_to({next_previous, normals[c], uvs[c]}, contribution, before,
                                    sums[slot], rings[slot])))
                lists.different[lists.different_count++] = Index(4 * i + k);
        };
        add(0, two(v + 1), term0[i]);
        add(1, two(v[2], v[0]), term1[i]);
        add(2, two(v), term2[i]);
    }
}

void add(const AccumulateInput& in, std::size_t first, std::size_t count, bool any_degenerate,
         const Contribution* const planes[3], AccumulateState& state, AccumulateLists& lists) {
    Met met;
    lists.left_count = lists.different_count = 0;
    const Index* const vertices = in.vertices + 3 * first;
    if (any_degenerate)
        count_off_some(vertices, count, planes[0], state, met, lists);
    else
        count_off(vertices, 3 * count, state, met, lists);
    find_done(vertices, 3 * count, met, state);
    if (in.corners == nullptr)
        add_all<false>(in, first, count, planes, met, state, lists);
    else
        add_all<true>(in, first, count, planes, met, state, lists);
}

void add_records(const CornerRecord* records, std::size_t count, std::uint8_t* HWY_RESTRICT met,
                 VertexSum* sums, VertexRing* rings, AccumulateLists& lists) {
    lists.different_count = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const CornerRecord& record = records[i];
        const Index v = record.vertex(), before = met[v];
        met[v] = std::uint8_t(before + (before <= most_ring_members));
        if (HWY_UNLIKELY(add_to({two(&record.next), record.normal, record.uv}, record, before,
                                sums[v], rings[v])))
            lists.different[lists.different_count++] = Index(i);
    }
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

AccumulateKernel accumulate_kernel(SimdLevel level) {
    return SIMD_KERNEL(level, add);
}

AddRecordsKernel add_records_kernel(SimdLevel level) {
    return SIMD_KERNEL(level, add_records);
}

bool add_contribution(const AccumulateInput& in, std::size_t triangle, std::size_t k,
                      const Contribution& contribution, std::uint32_t met, VertexSum& sum,
                      VertexRing& ring) {
    const std::uint32_t* const v = in.vertices + 3 * triangle;
    const std::size_t at = 3 * triangle + k, c = in.corners == nullptr ? at : in.corners[at];
    return HWY_STATIC_DISPATCH(add_to)(
        {HWY_STATIC_DISPATCH(two)(v[(k + 1) % 3], v[(k + 2) % 3]), in.normals[c], in.uvs[c]},
        contribution, met, sum, ring);
}

}  // namespace prep::detail
#endif
