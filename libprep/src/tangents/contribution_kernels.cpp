// Gathers the inputs of triangles, component by component, and computes what the triangles
// contribute to their corners: the definition's operations in its order, on many triangles at once,
// so that all instruction sets give the same bits. Multiplications and additions stay separate,
// square roots and quotients are true ones.
#include "base/simd_targets.h"
#include "tangents/contributions.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tangents/contribution_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Doubles = hn::ScalableTag<double>;
using F = hn::Vec<Floats>;
using D = hn::Vec<Doubles>;
using Mask = hn::Mask<Floats>;

using Index = std::uint32_t;

#if HWY_TARGET != HWY_SCALAR
#include "base/simd_blocks-inl.h"
#endif

// Positions or normals of one corner of as many triangles as a vector has lanes. Reads four bytes
// behind each.
HWY_INLINE void gather_vectors(const glm::vec3* values, const Index* indices,
                               float (*to)[TriangleBlock::size], std::size_t i) {
#if HWY_TARGET == HWY_SCALAR
    for (int d = 0; d < 3; ++d) to[d][i] = values[*indices][d];
#else
    const Floats d;
    const auto row = [&](std::size_t r) HWY_ATTR {
        return in_blocks(d, [&](std::size_t j) HWY_ATTR {
            return hn::LoadU(hn::FixedTag<float, 4>(), &values[indices[12 * j + 3 * r]].x);
        });
    };
    F columns[4];
    columns_of_blocks(d, row(0), row(1), row(2), row(3), columns);
    for (int k = 0; k < 3; ++k) hn::StoreU(columns[k], d, to[k] + i);
#endif
}

HWY_INLINE void gather_uvs(const glm::vec2* values, const Index* indices,
                           float (*to)[TriangleBlock::size], std::size_t i) {
#if HWY_TARGET == HWY_SCALAR
    for (int d = 0; d < 2; ++d) to[d][i] = values[*indices][d];
#else
    const Floats d;
    const hn::RepartitionToWide<Floats> pairs;
    const auto row = [&](std::size_t r) HWY_ATTR {
        return in_blocks(d, [&](std::size_t j) HWY_ATTR {
            const auto at = [&](std::size_t k) HWY_ATTR {
                return hn::LoadU(hn::FixedTag<float, 2>(), &values[indices[12 * j + 3 * k]].x);
            };
            return hn::Combine(hn::FixedTag<float, 4>(), at(r + 2), at(r));
        });
    };
    const F a = row(0), b = row(1);
    const auto lower = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
    const auto upper = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, lower, upper)), d, to[0] + i);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, lower, upper)), d, to[1] + i);
#endif
}

// Are the indices of as many triangles as a vector has lanes all below the limit?
HWY_INLINE bool all_below(const Index* indices, std::size_t limit) {
    const hn::RebindToUnsigned<Floats> d;
    const std::size_t n = hn::Lanes(d);
    const auto largest = hn::Max(hn::Max(hn::LoadU(d, indices), hn::LoadU(d, indices + n)),
                                 hn::LoadU(d, indices + 2 * n));
    return hn::AllTrue(d,
                       hn::Lt(largest, hn::Set(d, Index(std::min<std::size_t>(limit, no_index)))));
}

std::size_t gather(const GatherInput& in, std::size_t first, std::size_t count, std::size_t to,
                   TriangleBlock& block) {
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
            gather_vectors(in.positions.data(), p + k, block.p[k], to + i);
            gather_vectors(in.normals.data(), n + k, block.n[k], to + i);
            gather_uvs(in.uvs.data(), uv + k, block.uv[k], to + i);
        }
    }
    return i;
}

struct Vec3 {
    F x, y, z;
};
struct Vec2 {
    F x, y;
};

HWY_INLINE F zero() {
    return hn::Zero(Floats());
}
HWY_INLINE F set(float x) {
    return hn::Set(Floats(), x);
}
HWY_INLINE Vec3 operator_sub(const Vec3& a, const Vec3& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vec3 scaled(F s, const Vec3& v) {
    return {hn::Mul(s, v.x), hn::Mul(s, v.y), hn::Mul(s, v.z)};
}
HWY_INLINE F dot(const Vec3& a, const Vec3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Mask not_zero(F x) {
    return hn::Gt(hn::Abs(x), set(std::numeric_limits<float>::min()));
}
HWY_INLINE Mask not_zero(const Vec3& v) {
    return hn::Or(hn::Or(not_zero(v.x), not_zero(v.y)), not_zero(v.z));
}
HWY_INLINE Vec3 off_normal(const Vec3& n, const Vec3& v) {
    return operator_sub(v, scaled(dot(n, v), n));
}
HWY_INLINE F inverse_root(F x) {
    return hn::Div(set(1.0f), hn::Sqrt(x));
}
// Vectors whose squares are larger are not zero.
constexpr float certainly_not_zero = 1e-30f;
HWY_INLINE Vec3 normalized_or_zero(const Vec3& v) {
    const Vec3 unit = scaled(inverse_root(dot(v, v)), v);
    const Mask m = not_zero(v);
    return {hn::IfThenElse(m, unit.x, v.x), hn::IfThenElse(m, unit.y, v.y),
            hn::IfThenElse(m, unit.z, v.z)};
}

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE F acos_rounded(F x) {
    return F(float(std::acos(double(x.raw))));
}
#else
// acos in double: asin(z)/z = 1 + z² P(z²) for z² ≤ 1/4, P of degree 9 (a Chebyshev fit, 1.5e-14 of
// the quotient), z = |x| or, above 1/2, √y with y = (1 − |x|)/2. inverse_root: 1/√y to 4e-7 of it,
// which one Newton step takes to 3e-13. (In all 1400 last places of the result.)
HWY_INLINE D approximate_acos(D x, D inverse_root) {
    const Doubles d;
    const auto c = [&](double value) { return hn::Set(d, value); };
    const D ax = hn::Abs(x);
    const auto big = hn::Gt(ax, c(0.5));
    const D half = hn::Mul(hn::Sub(c(1.0), ax), c(0.5));
    const D root = hn::Mul(half, inverse_root);
    const D better =
        hn::MulAdd(hn::NegMulAdd(root, inverse_root, c(1.0)), hn::Mul(root, c(0.5)), root);
    const D y = hn::IfThenElse(big, half, hn::Mul(x, x));
    const D z = hn::IfThenElse(big, better, ax);
    const D y2 = hn::Mul(y, y), y4 = hn::Mul(y2, y2);
    const D p01 = hn::MulAdd(y, c(0x1.33333335a9cd6p-4), c(0x1.5555555554f05p-3));
    const D p23 = hn::MulAdd(y, c(0x1.f1c81c59ea536p-6), c(0x1.6db6d8e71341bp-5));
    const D p45 = hn::MulAdd(y, c(0x1.1dc2ef640046fp-6), c(0x1.6e72146fda29ep-6));
    const D p67 = hn::MulAdd(y, c(0x1.00d47e7966d94p-6), c(0x1.b02442413f6b9p-7));
    const D p89 = hn::MulAdd(y, c(0x1.c93a92d53b4f2p-6), c(-0x1.815314c864b10p-9));
    const D p03 = hn::MulAdd(y2, p23, p01), p47 = hn::MulAdd(y2, p67, p45);
    const D p49 = hn::MulAdd(y4, p89, p47);
    const D p = hn::MulAdd(y4, p49, p03);
    const D s = hn::MulAdd(hn::Mul(z, y), p, z);  // asin(z)
    constexpr double pi = 3.14159265358979323846;
    const D twice = hn::Add(s, s);
    const D from_big = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(c(pi), twice), twice);
    return hn::IfThenElse(big, from_big, hn::Sub(c(0.5 * pi), hn::CopySign(s, x)));
}

// Is the value within 2^13 of its last places of the midpoint between two floats? Only there can
// an error of 1400 of them change what it rounds to.
HWY_INLINE auto near_midpoint(D value) {
    const hn::RebindToSigned<Doubles> di;
    const auto low = hn::And(hn::Add(hn::BitCast(di, value), hn::Set(di, 0x2000 - 0x10000000)),
                             hn::Set(di, 0x1fffffff));
    return hn::Lt(low, hn::Set(di, 0x4000));
}

// float(acos(double(x))) with the C library's bits, for x in [−1, 1]; NaN for NaN.
HWY_INLINE F acos_rounded(F x) {
    const Floats df;
    const hn::Half<Floats> dh;
    const Doubles dd;
    // At ±1 the root is 0 whatever it is multiplied by.
    const F half = hn::Max(hn::Mul(hn::Sub(set(1.0f), hn::Abs(x)), set(0.5f)), set(1e-30f));
    const F rough = hn::ApproximateReciprocalSqrt(half);
    const F root = hn::Mul(half, rough);
    const F inverse = hn::Mul(rough, hn::Sub(set(1.5f), hn::Mul(set(0.5f), hn::Mul(root, rough))));
    const D low = approximate_acos(hn::PromoteTo(dd, hn::LowerHalf(dh, x)),
                                   hn::PromoteTo(dd, hn::LowerHalf(dh, inverse)));
    const D high = approximate_acos(hn::PromoteTo(dd, hn::UpperHalf(dh, x)),
                                    hn::PromoteTo(dd, hn::UpperHalf(dh, inverse)));
    const F result = hn::Combine(df, hn::DemoteTo(dh, high), hn::DemoteTo(dh, low));
    if (HWY_LIKELY(hn::AllFalse(hn::RebindToSigned<Doubles>(),
                                hn::Or(near_midpoint(low), near_midpoint(high)))))
        return result;
    HWY_ALIGN float values[hn::MaxLanes(df)];
    hn::Store(x, df, values);
    for (float& value : values) value = float(std::acos(double(value)));
    return hn::Load(df, values);
}
#endif

// Of the angle between two unit vectors, between −1 and 1.
HWY_INLINE F cosine_of(const Vec3& a, const Vec3& b) {
    const F cosine = dot(a, b);
#if HWY_TARGET == HWY_SCALAR
    return F(cosine.raw > 1.0f ? 1.0f : cosine.raw < -1.0f ? -1.0f : cosine.raw);
#else
    // The second operand where one is NaN.
    return hn::Max(set(-1.0f), hn::Min(set(1.0f), cosine));
#endif
}

using Codes = hn::Vec<hn::RebindToUnsigned<Floats>>;

HWY_INLINE Codes bits_where(Mask m, std::uint32_t bits) {
    const hn::RebindToUnsigned<Floats> du;
    return hn::IfThenElseZero(hn::RebindMask(du, m), hn::Set(du, bits));
}

// Adds bits in the lanes of a mask.
HWY_INLINE Codes or_where(Codes bits, Mask m, std::uint32_t more) {
#if HWY_TARGET == HWY_AVX3
    const hn::RebindToUnsigned<Floats> du;
    return hn::IfThenElse(hn::RebindMask(du, m), hn::Or(bits, hn::Set(du, more)), bits);
#else
    return hn::Or(bits, bits_where(m, more));
#endif
}

HWY_INLINE Codes with_directions(Codes bits, const Vec3& v, std::uint32_t first_bit,
                                 float least = direction_bound) {
    const F components[3] = {v.x, v.y, v.z}, bound = set(least), below = set(-least);
    for (int k = 0; k < 3; ++k) {
        bits = or_where(bits, hn::Gt(components[k], bound), first_bit << k);
        bits = or_where(bits, hn::Lt(components[k], below), first_bit << (k + 3));
    }
    return bits;
}

HWY_INLINE Mask equal(const Vec3& a, const Vec3& b) {
    return hn::And(hn::And(hn::Eq(a.x, b.x), hn::Eq(a.y, b.y)), hn::Eq(a.z, b.z));
}

// What the passes over a block leave to each other. A pass is short enough for the processor to
// work on several vectors at once: all of a corner at a stretch is one long chain.
struct Between {
    HWY_ALIGN float s[3][TriangleBlock::size], t[3][TriangleBlock::size];
    HWY_ALIGN std::uint32_t flags[TriangleBlock::size];
    // And with bits of directions that S and T have on any plane off which they are by no more than
    // most_off_plane.
    HWY_ALIGN std::uint32_t told[TriangleBlock::size];
    // By corner: the angle's cosine, S on the plane of the normal, the code.
    HWY_ALIGN float cosines[3][TriangleBlock::size];
    HWY_ALIGN float on_s[3][3][TriangleBlock::size];
    HWY_ALIGN std::uint32_t codes[3][TriangleBlock::size];
    // By vector: is it full, of triangles that all add something?
    bool plain[TriangleBlock::size];
};
constexpr float most_off_plane = 0.2f;
constexpr float safe_bound = direction_bound + 1.01f * most_off_plane;

HWY_INLINE Vec3 load3(const float (*from)[TriangleBlock::size], std::size_t i) {
    const Floats d;
    return {hn::Load(d, from[0] + i), hn::Load(d, from[1] + i), hn::Load(d, from[2] + i)};
}
HWY_INLINE void store3(const Vec3& v, float (*to)[TriangleBlock::size], std::size_t i) {
    const Floats d;
    hn::Store(v.x, d, to[0] + i);
    hn::Store(v.y, d, to[1] + i);
    hn::Store(v.z, d, to[2] + i);
}

// S, T and flags.
HWY_INLINE void make_frames(const TriangleBlock& block, std::size_t count, Between& between,
                            BlockResult& result) {
    const Floats df;
    const hn::RebindToUnsigned<Floats> du;
    Mask nan = hn::MaskFromVec(zero());
    for (std::size_t i = 0; i < count; i += hn::Lanes(df)) {
        const Vec3 p[3] = {load3(block.p[0], i), load3(block.p[1], i), load3(block.p[2], i)};
        const auto load2 = [&](const float(*from)[TriangleBlock::size]) HWY_ATTR {
            return Vec2{hn::Load(df, from[0] + i), hn::Load(df, from[1] + i)};
        };
        const Vec2 uv[3] = {load2(block.uv[0]), load2(block.uv[1]), load2(block.uv[2])};
        const Vec3 d1 = operator_sub(p[1], p[0]), d2 = operator_sub(p[2], p[0]);
        const F ax = hn::Sub(uv[1].x, uv[0].x), ay = hn::Sub(uv[1].y, uv[0].y);
        const F bx = hn::Sub(uv[2].x, uv[0].x), by = hn::Sub(uv[2].y, uv[0].y);
        const F area2 = hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx));
        const Mask preserving = hn::Gt(area2, zero());
        const Mask has_area = not_zero(area2);
        const Vec3 raw_s = operator_sub(scaled(by, d1), scaled(ay, d2));
        const Vec3 minus_t1 = scaled(hn::Neg(bx), d1), plus_t2 = scaled(ax, d2);
        const Vec3 raw_t = {hn::Add(minus_t1.x, plus_t2.x), hn::Add(minus_t1.y, plus_t2.y),
                            hn::Add(minus_t1.z, plus_t2.z)};
        const F magnitude = hn::Abs(area2);
        const F sign = hn::IfThenElse(preserving, set(1.0f), set(-1.0f));
        const F s_length = hn::Sqrt(dot(raw_s, raw_s)), t_length = hn::Sqrt(dot(raw_t, raw_t));
        const F s_scale = hn::Div(sign, s_length), t_scale = hn::Div(sign, t_length);
        Vec3 unit_s = scaled(s_scale, raw_s), unit_t = scaled(t_scale, raw_t);
        // Both magnitudes, length / |area2|, are far from zero but for extreme triangles.
        const F least =
            hn::Mul(set(4 * std::numeric_limits<float>::min()), hn::Max(magnitude, set(1.0f)));
        // One by one: the lesser of a NaN and a number would be the number.
        Mask healthy = hn::And(has_area, hn::And(hn::Gt(s_length, least), hn::Gt(t_length, least)));
        const Mask degenerate =
            hn::Or(equal(p[0], p[1]), hn::Or(equal(p[0], p[2]), equal(p[1], p[2])));

        // A UV that is NaN leaves no area. What is divided by an infinite length vanishes.
        const Mask finite =
            hn::Le(hn::Max(s_length, t_length), set(std::numeric_limits<float>::max()));
        const bool plain = i + hn::Lanes(df) <= count &&
                           hn::AllTrue(df, hn::And(finite, hn::AndNot(degenerate, healthy)));
        between.plain[i / hn::Lanes(df)] = plain;
        Codes flags;
        if (HWY_LIKELY(plain)) {
            flags = hn::IfThenElse(
                hn::RebindMask(du, preserving),
                hn::Set(du, std::uint32_t(code_float | own_frame | orientation_preserving)),
                hn::Set(du, std::uint32_t(code_float | own_frame | orientation_mirrored)));
            result.counts.mirrored += hn::Lanes(df) - hn::CountTrue(df, preserving);
        } else {
            const Mask s_set = not_zero(s_length), t_set = not_zero(t_length);
            unit_s = {hn::IfThenElseZero(s_set, unit_s.x), hn::IfThenElseZero(s_set, unit_s.y),
                      hn::IfThenElseZero(s_set, unit_s.z)};
            unit_t = {hn::IfThenElseZero(t_set, unit_t.x), hn::IfThenElseZero(t_set, unit_t.y),
                      hn::IfThenElseZero(t_set, unit_t.z)};
            if (!hn::AllTrue(df, healthy))
                healthy = hn::And(has_area, hn::And(not_zero(hn::Div(s_length, magnitude)),
                                                    not_zero(hn::Div(t_length, magnitude))));
            flags = hn::IfThenElse(hn::RebindMask(du, preserving),
                                   hn::Set(du, std::uint32_t(orientation_preserving)),
                                   hn::Set(du, std::uint32_t(orientation_mirrored)));
            flags = hn::Or(
                flags,
                hn::IfThenElse(hn::RebindMask(du, healthy),
                               hn::Set(du, std::uint32_t(code_float | own_frame)),
                               hn::Set(du, std::uint32_t(code_float | group_with_anything))));
            flags = or_where(flags, degenerate, degenerate_triangle);
            const Mask inside = hn::FirstN(df, count - i);
            result.counts.degenerate += hn::CountTrue(df, hn::And(inside, degenerate));
            result.counts.anything +=
                hn::CountTrue(df, hn::And(inside, hn::AndNot(degenerate, hn::Not(healthy))));
            result.counts.mirrored += hn::CountTrue(
                df, hn::And(inside, hn::AndNot(preserving, hn::AndNot(degenerate, healthy))));
            const F uv_sum = hn::Add(hn::Add(hn::Add(uv[0].x, uv[0].y), hn::Add(uv[1].x, uv[1].y)),
                                     hn::Add(uv[2].x, uv[2].y));
            nan = hn::Or(nan, hn::And(inside, hn::IsNaN(uv_sum)));
        }
        store3(unit_s, between.s, i);
        store3(unit_t, between.t, i);
        hn::Store(flags, du, between.flags + i);
        hn::Store(with_directions(with_directions(flags, unit_s, 1, safe_bound), unit_t, 1u << 6,
                                  safe_bound),
                  du, between.told + i);
    }
    result.counts.nan |= !hn::AllFalse(df, nan);
}

// All that needs quotients and roots, so that other work can be done while they take their time.
HWY_INLINE void make_corners(const TriangleBlock& block, std::size_t count, bool check_unit,
                             Between& between, BlockResult& result) {
    const Floats df;
    const hn::RebindToUnsigned<Floats> du;
    const F minus_zero = set(-0.0f);
    Mask far_from_unit = hn::MaskFromVec(zero()), nan = far_from_unit;
    F cosines = zero();  // a sum, NaN where one is
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < count; i += hn::Lanes(df)) {
            const Vec3 n = load3(block.n[k], i), p = load3(block.p[k], i);
            const Vec3 to_previous = operator_sub(load3(block.p[(k + 2) % 3], i), p);
            const Vec3 to_next = operator_sub(load3(block.p[(k + 1) % 3], i), p);
            const Vec3 previous = off_normal(n, to_previous), next = off_normal(n, to_next);
            const F previous2 = dot(previous, previous), next2 = dot(next, next);
            F cosine = cosine_of(scaled(inverse_root(previous2), previous),
                                 scaled(inverse_root(next2), next));

            const F off = hn::Abs(hn::Sub(dot(n, n), set(1.0f)));
            const Mask unit = hn::Le(off, set(most_off_unit));
            const Vec3 s = load3(between.s, i), t = load3(between.t, i);
            const F off_s = dot(n, s), off_t = dot(n, t);
            const Vec3 on_plane = operator_sub(s, scaled(off_s, n));
            Vec3 on_s = scaled(inverse_root(dot(on_plane, on_plane)), on_plane);
            const Mask near = hn::And(hn::Le(hn::Abs(off_s), set(most_off_plane)),
                                      hn::Le(hn::Abs(off_t), set(most_off_plane)));
            // Where S is that near the plane it is not zero on it.
            const Mask long_edges = hn::And(hn::Gt(previous2, set(certainly_not_zero)),
                                            hn::Gt(next2, set(certainly_not_zero)));
            if (HWY_LIKELY(between.plain[i / hn::Lanes(df)] &&
                           hn::AllTrue(df, hn::And(hn::And(unit, near), long_edges)))) {
                cosines = hn::Add(cosines, cosine);
                hn::Store(cosine, df, between.cosines[k] + i);
                store3(on_s, between.on_s[k], i);
                hn::Store(hn::Load(du, between.told + i), du, between.codes[k] + i);
                continue;
            }
            cosine = cosine_of(normalized_or_zero(previous), normalized_or_zero(next));
            on_s = normalized_or_zero(on_plane);
            const Mask inside = hn::FirstN(df, count - i);
            nan = hn::Or(nan, hn::And(inside, hn::IsNaN(cosine)));
            if (check_unit) far_from_unit = hn::Or(far_from_unit, hn::AndNot(unit, inside));
            const Codes flags = hn::Load(du, between.flags + i);
            const Mask adds = hn::RebindMask(
                df,
                hn::Eq(hn::And(flags, hn::Set(du, std::uint32_t(own_frame | degenerate_triangle))),
                       hn::Set(du, std::uint32_t(own_frame))));
            // The angle becomes 0, and 0 times −0 is −0.
            hn::Store(hn::IfThenElse(adds, cosine, set(1.0f)), df, between.cosines[k] + i);
            store3(
                {hn::IfThenElse(adds, on_s.x, minus_zero), hn::IfThenElse(adds, on_s.y, minus_zero),
                 hn::IfThenElse(adds, on_s.z, minus_zero)},
                between.on_s[k], i);
            const Vec3 on_t = operator_sub(t, scaled(off_t, n));
            const Codes none = hn::Zero(du);
            const Codes told = hn::IfThenElseZero(
                hn::RebindMask(du, unit),
                with_directions(with_directions(none, on_plane, 1), on_t, 1u << 6));
            const Codes code =
                hn::IfThenElse(hn::RebindMask(du, adds), told,
                               hn::Set(du, std::uint32_t(s_directions | t_directions)));
            hn::Store(hn::Or(flags, code), du, between.codes[k] + i);
        }
    }
    result.far_from_unit = !hn::AllFalse(df, far_from_unit);
    result.counts.nan |= !hn::AllFalse(df, hn::Or(nan, hn::IsNaN(cosines)));
}

HWY_INLINE void store_contributions(const Between& between, std::size_t count,
                                    Contribution* const planes[3]) {
    const Floats df;
    const hn::RebindToUnsigned<Floats> du;
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < count; i += hn::Lanes(df)) {
            const F angle = acos_rounded(hn::Load(df, between.cosines[k] + i));
            const Vec3 contribution = scaled(angle, load3(between.on_s[k], i));
            hn::StoreInterleaved4(contribution.x, contribution.y, contribution.z,
                                  hn::BitCast(df, hn::Load(du, between.codes[k] + i)), df,
                                  &planes[k][i].x);
        }
    }
}

BlockResult contributions(const TriangleBlock& block, std::size_t count, bool check_unit,
                          Contribution* const planes[3]) {
    BlockResult result;
    Between between;
    make_frames(block, count, between, result);
    make_corners(block, count, check_unit, between, result);
    store_contributions(between, count, planes);
    return result;
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

GatherKernel gather_kernel(SimdLevel level) {
    return SIMD_KERNEL(level, gather);
}

ContributionKernel contribution_kernel(SimdLevel level) {
    return SIMD_KERNEL(level, contributions);
}

}  // namespace prep::detail
#endif
