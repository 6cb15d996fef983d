#include "tangent_terms.h"

#include <hwy/highway.h>

#include <algorithm>
#include <mutex>

#include "parallel.h"
#include "tangent_math.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
// A multiple of TermBlock::size, about 1 ms of work.
constexpr std::size_t triangle_grain = 128 * TermBlock::size;

// Up to this many normals are copied, so that the last is like the others.
constexpr std::size_t few_normals = 1024;

// See TermCode. Below the first bound squares lose their precision; above the second they overflow.
std::uint32_t directions(const glm::vec3& v) {
    const float length2 = mikk::length_squared(v);
    if (!(length2 > 1e-20f && length2 < 1e20f)) return 0;
    const float bound = 0.0025f * length2;
    std::uint32_t bits = 0;
    for (int k = 0; k < 3; ++k) {
        const float square = v[k] * std::abs(v[k]);
        bits |= (square > bound ? 1u : 0u) << k | (square < -bound ? 1u : 0u) << (k + 3);
    }
    return bits;
}

glm::vec3 off_normal(const glm::vec3& n, const glm::vec3& v) {
    return v - mikk::scaled(mikk::dot(n, v), n);
}

void stage_one(const CornerReader& read, const TangentTriangles& triangles, std::size_t triangle,
               std::size_t i, TermBlock& block) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Index corner = triangles.corner(triangle, k);
        const glm::vec3 p = read.position(corner), n = read.normal(corner);
        const glm::vec2 uv = read.uv(corner);
        for (int d = 0; d < 3; ++d) block.p[k][d][i] = p[d];
        for (int d = 0; d < 3; ++d) block.n[k][d][i] = n[d];
        for (int d = 0; d < 2; ++d) block.uv[k][d][i] = uv[d];
    }
}

namespace hn = hwy::HWY_NAMESPACE;
using Four = hn::FixedTag<float, 4>;
using FourIndices = hn::FixedTag<Index, 4>;

// Are all of twelve indices below the limit?
bool all_below(const Index* indices, std::size_t limit) {
    const FourIndices d;
    const auto largest = hn::Max(hn::Max(hn::LoadU(d, indices), hn::LoadU(d, indices + 4)),
                                 hn::LoadU(d, indices + 8));
    return hn::AllTrue(d,
                       hn::Lt(largest, hn::Set(d, Index(std::min<std::size_t>(limit, no_index)))));
}

// Four vectors of three components, component by component. Reads four bytes behind each.
void stage_vectors(const glm::vec3* values, const Index* indices, float (*to)[TermBlock::size],
                   std::size_t i) {
    const Four d;
    const hn::RepartitionToWide<Four> pairs;
    const auto a = hn::LoadU(d, &values[indices[0]].x);
    const auto b = hn::LoadU(d, &values[indices[3]].x);
    const auto c = hn::LoadU(d, &values[indices[6]].x);
    const auto e = hn::LoadU(d, &values[indices[9]].x);
    const auto ab = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
    const auto ce = hn::BitCast(pairs, hn::InterleaveLower(d, c, e));
    hn::Store(hn::BitCast(d, hn::InterleaveLower(pairs, ab, ce)), d, to[0] + i);
    hn::Store(hn::BitCast(d, hn::InterleaveUpper(pairs, ab, ce)), d, to[1] + i);
    const auto upper_ab = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
    const auto upper_ce = hn::BitCast(pairs, hn::InterleaveUpper(d, c, e));
    hn::Store(hn::BitCast(d, hn::InterleaveLower(pairs, upper_ab, upper_ce)), d, to[2] + i);
}

void stage_uvs(const glm::vec2* values, const Index* indices, float (*to)[TermBlock::size],
               std::size_t i) {
    const Four d;
    const hn::Half<Four> half;
    const auto at = [&](std::size_t k) { return hn::LoadU(half, &values[indices[3 * k]].x); };
    const auto ab = hn::Combine(d, at(1), at(0)), ce = hn::Combine(d, at(3), at(2));
    hn::Store(hn::ConcatEven(d, ce, ab), d, to[0] + i);
    hn::Store(hn::ConcatOdd(d, ce, ab), d, to[1] + i);
}

// normals: the input's, of which all but the last have something to read behind them.
void stage(const CornerReader& read, std::span<const glm::vec3> normals,
           const TangentTriangles& triangles, std::size_t first, std::size_t count,
           TermBlock& block) {
    const TangentInput& in = read.in;
    const bool plain = triangles.implicit() && read.representatives.empty() &&
                       !in.positions.empty() && !normals.empty();
    std::size_t i = 0;
    while (i < count) {
        const Index* p = in.corner_vertices.data() + 3 * (first + i);
        const Index* n = in.normals.indices.data() + 3 * (first + i);
        const Index* uv = in.uv.indices.data() + 3 * (first + i);
        // The last position and the last normal have nothing behind them to read.
        if (plain && count - i >= 4 && all_below(p, in.positions.size() - 1) &&
            all_below(n, normals.size() - 1) && all_below(uv, in.uv.values.size())) {
            for (std::size_t k = 0; k < 3; ++k) {
                stage_vectors(in.positions.data(), p + k, block.p[k], i);
                stage_vectors(normals.data(), n + k, block.n[k], i);
                stage_uvs(in.uv.values.data(), uv + k, block.uv[k], i);
            }
            i += 4;
        } else {
            const std::size_t end = std::min(count, i + 4);
            for (; i < end; ++i) stage_one(read, triangles, first + i, i, block);
        }
    }
}

void make_normals_unit(std::size_t count, TermBlock& block) {
    for (auto& corner : block.n) {
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3 n = unit_normal({corner[0][i], corner[1][i], corner[2][i]});
            for (int d = 0; d < 3; ++d) corner[d][i] = n[d];
        }
    }
}

float uv_area2(const CornerReader& read, const TangentTriangles& triangles, std::size_t t) {
    const glm::vec2 t0 = read.uv(triangles.corner(t, 0));
    const glm::vec2 a = read.uv(triangles.corner(t, 1)) - t0;
    const glm::vec2 b = read.uv(triangles.corner(t, 2)) - t0;
    return a.x * b.y - a.y * b.x;
}

// The halves of a quad must agree on their orientation: the one of the larger UV area decides.
void settle_quads(const CornerReader& read, const TangentTriangles& triangles, Terms& terms) {
    const auto set = [&](std::size_t t, std::uint32_t keep, std::uint32_t bits) {
        for (auto& plane : terms.planes) plane[t].code = (plane[t].code & keep) | bits;
    };
    for (std::size_t t = 0; t < triangles.count; ++t) {
        if (triangles.halves[t] == 0) continue;
        set(t, ~0u, triangles.halves[t] == 1 ? quad_first : quad_second);
        if (triangles.halves[t] == 1) continue;
        const std::uint32_t first = terms.flags(t - 1), second = terms.flags(t);
        if ((first ^ second) & degenerate_triangle) {
            set(t - 1, ~0u, half_degenerate_quad);
            set(t, ~0u, half_degenerate_quad);
        }
        if ((first | second) & degenerate_triangle) continue;
        if (((first ^ second) & orientation_preserving) == 0) continue;
        const bool first_decides =
            (second & group_with_anything) ||
            std::abs(uv_area2(read, triangles, t - 1)) >= std::abs(uv_area2(read, triangles, t));
        const std::uint32_t orientation = (first_decides ? first : second) & orientation_preserving;
        set(t - 1, ~std::uint32_t(orientation_preserving), orientation);
        set(t, ~std::uint32_t(orientation_preserving), orientation);
    }
}

}  // namespace

TriangleFrame triangle_frame(const glm::vec3 p[3], const glm::vec2 uv[3]) {
    TriangleFrame frame;
    const glm::vec3 d1 = p[1] - p[0], d2 = p[2] - p[0];
    const glm::vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
    const float area2 = a.x * b.y - a.y * b.x;
    frame.preserving = area2 > 0;
    if (!mikk::not_zero(area2)) return frame;
    const glm::vec3 s = mikk::scaled(b.y, d1) - mikk::scaled(a.y, d2);
    const glm::vec3 t = mikk::scaled(-b.x, d1) + mikk::scaled(a.x, d2);
    const float magnitude = std::abs(area2), sign = area2 > 0 ? 1.0f : -1.0f;
    const float s_length = mikk::length(s), t_length = mikk::length(t);
    if (mikk::not_zero(s_length)) frame.s = mikk::scaled(sign / s_length, s);
    if (mikk::not_zero(t_length)) frame.t = mikk::scaled(sign / t_length, t);
    frame.s_length = s_length / magnitude;
    frame.t_length = t_length / magnitude;
    frame.healthy = mikk::not_zero(frame.s_length) && mikk::not_zero(frame.t_length);
    return frame;
}

TriangleFrame triangle_frame(const CornerReader& read, const TangentTriangles& triangles,
                             std::size_t triangle) {
    glm::vec3 p[3];
    glm::vec2 uv[3];
    for (std::size_t k = 0; k < 3; ++k) {
        p[k] = read.position(triangles.corner(triangle, k));
        uv[k] = read.uv(triangles.corner(triangle, k));
    }
    return triangle_frame(p, uv);
}

TermBlockResult terms_scalar(const TermBlock& block, std::size_t count, bool check_unit,
                             CornerTerm* const planes[3]) {
    TermBlockResult result;
    for (std::size_t i = 0; i < count; ++i) {
        glm::vec3 p[3], n[3];
        glm::vec2 uv[3];
        for (int k = 0; k < 3; ++k) {
            p[k] = {block.p[k][0][i], block.p[k][1][i], block.p[k][2][i]};
            n[k] = {block.n[k][0][i], block.n[k][1][i], block.n[k][2][i]};
            uv[k] = {block.uv[k][0][i], block.uv[k][1][i]};
            if (check_unit && far_from_unit(n[k])) result.far_from_unit = true;
        }
        const TriangleFrame frame = triangle_frame(p, uv);
        std::uint32_t flags = frame.preserving ? orientation_preserving : 0u;
        if (!frame.healthy) flags |= group_with_anything;
        if (p[0] == p[1] || p[0] == p[2] || p[1] == p[2]) {
            flags |= degenerate_triangle;
            ++result.counts.degenerate;
        } else if (!frame.healthy) {
            ++result.counts.anything;
        } else if (!frame.preserving) {
            ++result.counts.mirrored;
        }
        bool nan = std::isnan(uv[0].x + uv[0].y + uv[1].x + uv[1].y + uv[2].x + uv[2].y);
        for (int k = 0; k < 3; ++k) {
            CornerTerm& term = planes[k][i];
            const float angle = mikk::corner_angle(n[k], p[k], p[(k + 2) % 3], p[(k + 1) % 3]);
            nan |= std::isnan(angle);
            if (flags & (group_with_anything | degenerate_triangle)) {
                term = {-0.0f, -0.0f, -0.0f, flags | s_directions | t_directions};
                continue;
            }
            const glm::vec3 s = off_normal(n[k], frame.s);
            const glm::vec3 weighted = mikk::scaled(angle, mikk::normalized_or_zero(s));
            term = {weighted.x, weighted.y, weighted.z,
                    flags | directions(s) | directions(off_normal(n[k], frame.t)) << 6};
        }
        result.counts.nan |= nan;
    }
    return result;
}

Terms compute_terms(const CornerReader& read, const TangentTriangles& triangles,
                    const TangentOptions& options) {
    Terms terms;
    // Kernels write whole vectors.
    const std::size_t padded =
        (triangles.count + TermBlock::size - 1) / TermBlock::size * TermBlock::size;
    for (auto& plane : terms.planes) plane = ScratchBuffer<CornerTerm>(padded);
    // A flat mesh may have a single normal.
    std::span<const glm::vec3> normals = read.in.normals.values;
    std::vector<glm::vec3> few(normals.begin(),
                               normals.size() <= few_normals ? normals.end() : normals.begin());
    if (!few.empty()) {
        few.emplace_back(0.0f);
        normals = few;
    }
    const TermKernel kernel = term_kernel(options.simd);
    const bool check_unit = options.mode == TangentMode::mikktspace;
    std::mutex merging;
    parallel_blocks(triangles.count, triangle_grain, options.threads,
                    [&](std::size_t begin, std::size_t end) {
                        TermBlock block{};
                        TermCounts counts;
                        for (std::size_t t = begin; t < end; t += TermBlock::size) {
                            const std::size_t count = std::min(TermBlock::size, end - t);
                            stage(read, normals, triangles, t, count, block);
                            CornerTerm* const planes[3] = {&terms.planes[0][t], &terms.planes[1][t],
                                                           &terms.planes[2][t]};
                            TermBlockResult done = kernel(block, count, check_unit, planes);
                            if (done.far_from_unit) {
                                make_normals_unit(count, block);
                                done = kernel(block, count, false, planes);
                            }
                            counts.mirrored += done.counts.mirrored;
                            counts.anything += done.counts.anything;
                            counts.degenerate += done.counts.degenerate;
                            counts.nan |= done.counts.nan;
                        }
                        const std::lock_guard lock(merging);
                        terms.counts.mirrored += counts.mirrored;
                        terms.counts.anything += counts.anything;
                        terms.counts.degenerate += counts.degenerate;
                        terms.counts.nan |= counts.nan;
                    });
    if (!triangles.halves.empty()) settle_quads(read, triangles, terms);
    return terms;
}

}  // namespace prep::detail
