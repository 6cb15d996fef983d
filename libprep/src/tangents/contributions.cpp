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
// A multiple of TriangleBlock::size, about 1 ms of work.
constexpr std::size_t triangle_grain = 128 * TriangleBlock::size;

// Up to this many normals are copied, so that the last is like the others: a flat mesh may have a
// single one.
constexpr std::size_t few_normals = 1024;

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

void make_normals_unit(std::size_t count, TriangleBlock& block) {
    for (auto& corner : block.n) {
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3 n = frame_normal({corner[0][i], corner[1][i], corner[2][i]});
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

TriangleFrame triangle_frame(const CornerReader& read, const TangentTriangles& triangles,
                             std::size_t triangle) {
    glm::vec3 p[3];
    glm::vec2 uv[3];
    for (std::size_t k = 0; k < 3; ++k) {
        p[k] = read.position(triangles.corner(triangle, k));
        uv[k] = read.uv(triangles.corner(triangle, k));
    }
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

std::uint32_t direction_code(const glm::vec3& n, const glm::vec3& s, const glm::vec3& t) {
    const auto bits = [](const glm::vec3& v) {
        // Below the first bound squares lose their precision; above the second they overflow.
        const float length2 = mikk::length_squared(v);
        return length2 > 1e-20f && length2 < 1e20f ? directions(v, 0.05f * std::sqrt(length2)) : 0u;
    };
    return bits(off_normal(n, s)) | bits(off_normal(n, t)) << 6;
}

BlockContributions::BlockContributions(const CornerReader& read, const TangentTriangles& triangles,
                                       const TangentOptions& options)
    : read_(read),
      triangles_(triangles),
      gather_(gather_kernel(options.simd)),
      kernel_(contribution_kernel(options.simd)),
      check_unit_(options.mode == TangentMode::mikktspace) {
    const TangentInput& in = read.in;
    input_ = {in.corner_vertices.data(), in.normals.indices.data(),
              in.uv.indices.data(),      in.positions,
              in.normals.values,         in.uv.values};
    const std::size_t normals = input_.normals.size();
    if (normals > 0 && normals <= few_normals) {
        few_normals_.assign(input_.normals.begin(), input_.normals.end());
        few_normals_.emplace_back(0.0f);
        input_.normals = few_normals_;
    }
    const bool plain = triangles.implicit() && read.welds.empty() && !input_.positions.empty() &&
                       !input_.normals.empty();
    if (!plain) gather_ = nullptr;
}

// The i-th triangle is number(i); input's indices have it at first + i.
template <class Number>
void BlockContributions::gather_all(const GatherInput& input, std::size_t first, std::size_t count,
                                    const Number& number, TriangleBlock& block) const {
    constexpr std::size_t most_lanes = 16;
    std::size_t i = 0;
    while (i < count) {
        if (gather_ != nullptr) i += gather_(input, first + i, count - i, i, block);
        for (const std::size_t end = std::min(count, i + most_lanes); i < end; ++i)
            gather_one(number(i), i, block);
    }
}

void BlockContributions::gather_list(std::span<const std::uint32_t> list,
                                     TriangleBlock& block) const {
    // Their indices, behind one another.
    std::uint32_t indices[3][3 * TriangleBlock::size];
    GatherInput input = input_;
    if (gather_ != nullptr) {
        const std::uint32_t** const from[3] = {&input.position_indices, &input.normal_indices,
                                               &input.uv_indices};
        for (std::size_t layer = 0; layer < 3; ++layer) {
            for (std::size_t i = 0; i < list.size(); ++i)
                std::copy_n(*from[layer] + 3 * std::size_t(list[i]), 3, indices[layer] + 3 * i);
            *from[layer] = indices[layer];
        }
    }
    gather_all(
        input, 0, list.size(), [&](std::size_t i) { return std::size_t(list[i]); }, block);
}

void BlockContributions::gather_one(std::size_t triangle, std::size_t i,
                                    TriangleBlock& block) const {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = triangles_.corner(triangle, k);
        const glm::vec3 p = read_.position(corner), n = read_.normal(corner);
        const glm::vec2 uv = read_.uv(corner);
        for (int d = 0; d < 3; ++d) block.p[k][d][i] = p[d];
        for (int d = 0; d < 3; ++d) block.n[k][d][i] = n[d];
        for (int d = 0; d < 2; ++d) block.uv[k][d][i] = uv[d];
    }
}

std::size_t BlockContributions::run(std::size_t first, std::size_t end, Scratch& scratch,
                                    TriangleCounts& counts) const {
    const std::size_t count = triangles_.cut(std::min(first + TriangleBlock::size, end)) - first;
    gather_all(
        input_, first, count, [&](std::size_t i) { return first + i; }, scratch.inputs);
    counts.add(finish(count, scratch));
    if (!triangles_.halves.empty()) settle_quads(first, count, scratch);
    return count;
}

void BlockContributions::run(std::span<const Index> list, Scratch& scratch) const {
    gather_list(list, scratch.inputs);
    finish(list.size(), scratch);
}

void BlockContributions::fetch_ahead(std::size_t first, std::size_t end) const {
    const GatherInput& in = input_;
    if (gather_ == nullptr) return;
    const std::size_t stop = 3 * std::min(first + TriangleBlock::size, end);
    for (std::size_t c = 3 * first; c < stop; ++c) {
        const Index p = in.position_indices[c], n = in.normal_indices[c], uv = in.uv_indices[c];
        // Some indices are no_index.
        if (p < in.positions.size()) __builtin_prefetch(in.positions.data() + p);
        if (n < in.normals.size()) __builtin_prefetch(in.normals.data() + n);
        if (uv < in.uvs.size()) __builtin_prefetch(in.uvs.data() + uv);
    }
}

TriangleCounts BlockContributions::finish(std::size_t count, Scratch& scratch) const {
    Contribution* const planes[3] = {scratch.planes[0], scratch.planes[1], scratch.planes[2]};
    BlockResult done = kernel_(scratch.inputs, count, check_unit_, planes);
    if (done.far_from_unit) {
        make_normals_unit(count, scratch.inputs);
        done = kernel_(scratch.inputs, count, false, planes);
    }
    return done.counts;
}

// The halves of a quad must agree on their orientation: the one of the larger UV area decides.
void BlockContributions::settle_quads(std::size_t first, std::size_t count,
                                      Scratch& scratch) const {
    const auto set = [&](std::size_t i, std::uint32_t keep, std::uint32_t bits) {
        for (auto& plane : scratch.planes) plane[i].code = (plane[i].code & keep) | bits;
    };
    constexpr std::uint32_t both = orientation_preserving | orientation_mirrored;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t t = first + i;
        if (triangles_.halves[t] == 0) continue;
        set(i, ~0u, triangles_.halves[t] == 1 ? quad_first : quad_second);
        if (triangles_.halves[t] == 1) continue;
        const std::uint32_t one = scratch.planes[0][i - 1].code, two = scratch.planes[0][i].code;
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

void compute_all_contributions(const BlockContributions& maker, const TangentTriangles& triangles,
                               int threads, ContributionStore& contributions) {
    for (auto& plane : contributions.planes) plane = ScratchBuffer<Contribution>(triangles.count);
    contributions.triangle_flags = ScratchBuffer<std::uint8_t>(triangles.count);
    contributions.counts = {};
    contributions.complete = true;
    contributions.chosen.clear();
    std::mutex merging;
    parallel_blocks(
        triangles.count, triangle_grain, threads, [&](std::size_t begin, std::size_t end) {
            const auto scratch = std::make_unique<BlockContributions::Scratch>();
            TriangleCounts counts;
            const std::size_t last = triangles.cut(end);
            for (std::size_t t = triangles.cut(begin); t < last;) {
                const std::size_t n = maker.run(t, last, *scratch, counts);
                for (std::size_t k = 0; k < 3; ++k)
                    std::copy_n(scratch->planes[k], n, &contributions.planes[k][t]);
                for (std::size_t i = 0; i < n; ++i)
                    contributions.triangle_flags[t + i] =
                        std::uint8_t(scratch->planes[0][i].code >> triangle_flags_shift);
                t += n;
            }
            const std::lock_guard lock(merging);
            contributions.counts.add(counts);
        });
}

void compute_chosen(const BlockContributions& maker, std::vector<std::uint64_t> chosen, int threads,
                    ContributionStore& contributions) {
    contributions.chosen = std::move(chosen);
    contributions.chosen_before.clear();
    std::size_t count = 0;
    for (const std::uint64_t word : contributions.chosen) {
        contributions.chosen_before.push_back(Index(count));
        count += std::size_t(std::popcount(word));
    }
    for (auto& plane : contributions.planes) plane = ScratchBuffer<Contribution>(count);
    parallel_blocks(
        contributions.chosen.size(), triangle_grain / 64, threads,
        [&](std::size_t begin, std::size_t end) {
            const auto scratch = std::make_unique<BlockContributions::Scratch>();
            std::vector<Index> list;
            std::size_t to = contributions.chosen_before[begin];
            const auto flush = [&] {
                maker.run(list, *scratch);
                for (std::size_t k = 0; k < 3; ++k)
                    std::copy_n(scratch->planes[k], list.size(), &contributions.planes[k][to]);
                to += list.size();
                list.clear();
            };
            for (std::size_t w = begin; w < end; ++w) {
                for (std::uint64_t rest = contributions.chosen[w]; rest != 0; rest &= rest - 1) {
                    list.push_back(Index(64 * w + std::size_t(std::countr_zero(rest))));
                    if (list.size() == TriangleBlock::size) flush();
                }
            }
            if (!list.empty()) flush();
        });
}

}  // namespace prep::detail
