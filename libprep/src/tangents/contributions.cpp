#include "tangents/contributions.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <mutex>

#include "base/parallel.h"
#include "tangents/math.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
// A multiple of TermBlock::size, about 1 ms of work.
constexpr std::size_t triangle_grain = 128 * TermBlock::size;

// Bits of the components above the bound, and below its negative.
std::uint32_t directions(const glm::vec3& v, float bound) {
    std::uint32_t bits = 0;
    for (int k = 0; k < 3; ++k)
        bits |= (v[k] > bound ? 1u : 0u) << k | (v[k] < -bound ? 1u : 0u) << (k + 3);
    return bits;
}

glm::vec3 off_normal(const glm::vec3& n, const glm::vec3& v) {
    return v - mikk::scaled(mikk::dot(n, v), n);
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

std::uint32_t direction_code(const glm::vec3& n, const glm::vec3& s, const glm::vec3& t) {
    const auto told = [](const glm::vec3& v) {
        // Below the first bound squares lose their precision; above the second they overflow.
        const float length2 = mikk::length_squared(v);
        return length2 > 1e-20f && length2 < 1e20f ? directions(v, 0.05f * std::sqrt(length2)) : 0u;
    };
    return told(off_normal(n, s)) | told(off_normal(n, t)) << 6;
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
        std::uint32_t flags =
            code_float | (frame.preserving ? orientation_preserving : orientation_mirrored);
        flags |= frame.healthy ? own_frame : group_with_anything;
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
            term = {weighted.x, weighted.y, weighted.z, flags};
            if (!far_from_unit(n[k]))
                term.code |= directions(s, direction_bound) |
                             directions(off_normal(n[k], frame.t), direction_bound) << 6;
        }
        result.counts.nan |= nan;
    }
    return result;
}

TermMaker::TermMaker(const CornerReader& read, const TangentTriangles& triangles,
                     const TangentOptions& options)
    : read_(read),
      triangles_(triangles),
      stager_(read, triangles, options.simd),
      kernel_(term_kernel(options.simd)),
      check_unit_(options.mode == TangentMode::mikktspace) {}

std::size_t TermMaker::run(std::size_t first, std::size_t end, Room& room,
                           TermCounts& counts) const {
    const std::size_t count = triangles_.cut(std::min(first + TermBlock::size, end)) - first;
    stager_.stage(first, count, room.inputs);
    counts.add(finish(count, room));
    if (!triangles_.halves.empty()) settle_quads(first, count, room);
    return count;
}

void TermMaker::run(std::span<const Index> list, Room& room) const {
    stager_.stage(list, room.inputs);
    finish(list.size(), room);
}

TermCounts TermMaker::finish(std::size_t count, Room& room) const {
    CornerTerm* const planes[3] = {room.planes[0], room.planes[1], room.planes[2]};
    TermBlockResult done = kernel_(room.inputs, count, check_unit_, planes);
    if (done.far_from_unit) {
        make_normals_unit(count, room.inputs);
        done = kernel_(room.inputs, count, false, planes);
    }
    return done.counts;
}

// The halves of a quad must agree on their orientation: the one of the larger UV area decides.
void TermMaker::settle_quads(std::size_t first, std::size_t count, Room& room) const {
    const auto set = [&](std::size_t i, std::uint32_t keep, std::uint32_t bits) {
        for (auto& plane : room.planes) plane[i].code = (plane[i].code & keep) | bits;
    };
    constexpr std::uint32_t both = orientation_preserving | orientation_mirrored;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t t = first + i;
        if (triangles_.halves[t] == 0) continue;
        set(i, ~0u, triangles_.halves[t] == 1 ? quad_first : quad_second);
        if (triangles_.halves[t] == 1) continue;
        const std::uint32_t one = room.planes[0][i - 1].code, two = room.planes[0][i].code;
        if ((one ^ two) & degenerate_triangle) {
            set(i - 1, ~0u, half_degenerate_quad);
            set(i, ~0u, half_degenerate_quad);
        }
        if ((one | two) & degenerate_triangle) continue;
        if (((one ^ two) & orientation_preserving) == 0) continue;
        const bool first_decides =
            (two & group_with_anything) || std::abs(uv_area2(read_, triangles_, t - 1)) >=
                                               std::abs(uv_area2(read_, triangles_, t));
        const std::uint32_t orientation = (first_decides ? one : two) & both;
        set(i - 1, ~both, orientation);
        set(i, ~both, orientation);
    }
}

std::size_t Terms::place(std::size_t triangle) const {
    if (chosen.empty()) return triangle;
    const std::uint64_t below = (std::uint64_t(1) << (triangle % 64)) - 1;
    return chosen_before[triangle / 64] + std::size_t(std::popcount(chosen[triangle / 64] & below));
}

void compute_all_terms(const TermMaker& maker, const TangentTriangles& triangles, int threads,
                       Terms& terms) {
    for (auto& plane : terms.planes) plane = ScratchBuffer<CornerTerm>(triangles.count);
    terms.triangle_flags = ScratchBuffer<std::uint8_t>(triangles.count);
    terms.counts = {};
    terms.complete = true;
    terms.chosen.clear();
    std::mutex merging;
    parallel_blocks(triangles.count, triangle_grain, threads,
                    [&](std::size_t begin, std::size_t end) {
                        const auto room = std::make_unique<TermMaker::Room>();
                        TermCounts counts;
                        const std::size_t last = triangles.cut(end);
                        for (std::size_t t = triangles.cut(begin); t < last;) {
                            const std::size_t n = maker.run(t, last, *room, counts);
                            for (std::size_t k = 0; k < 3; ++k)
                                std::copy_n(room->planes[k], n, &terms.planes[k][t]);
                            for (std::size_t i = 0; i < n; ++i)
                                terms.triangle_flags[t + i] =
                                    std::uint8_t(room->planes[0][i].code >> triangle_flags_shift);
                            t += n;
                        }
                        const std::lock_guard lock(merging);
                        terms.counts.add(counts);
                    });
}

void compute_terms(const TermMaker& maker, std::vector<std::uint64_t> chosen, int threads,
                   Terms& terms) {
    terms.chosen = std::move(chosen);
    terms.chosen_before.clear();
    std::size_t count = 0;
    for (const std::uint64_t word : terms.chosen) {
        terms.chosen_before.push_back(Index(count));
        count += std::size_t(std::popcount(word));
    }
    for (auto& plane : terms.planes) plane = ScratchBuffer<CornerTerm>(count);
    parallel_blocks(
        terms.chosen.size(), triangle_grain / 64, threads, [&](std::size_t begin, std::size_t end) {
            const auto room = std::make_unique<TermMaker::Room>();
            std::vector<Index> list;
            std::size_t to = terms.chosen_before[begin];
            const auto flush = [&] {
                maker.run(list, *room);
                for (std::size_t k = 0; k < 3; ++k)
                    std::copy_n(room->planes[k], list.size(), terms.planes[k].data() + to);
                to += list.size();
                list.clear();
            };
            for (std::size_t w = begin; w < end; ++w) {
                for (std::uint64_t rest = terms.chosen[w]; rest != 0; rest &= rest - 1) {
                    list.push_back(Index(64 * w + std::size_t(std::countr_zero(rest))));
                    if (list.size() == TermBlock::size) flush();
                }
            }
            if (!list.empty()) flush();
        });
}

}  // namespace prep::detail
