#include "tangents/gather.h"

#include <algorithm>

namespace prep::detail {
namespace {

// Up to this many normals are copied, so that the last is like the others: a flat mesh may have a
// single one.
constexpr std::size_t few_normals = 1024;

}  // namespace

Stager::Stager(const CornerReader& read, const TangentTriangles& triangles, SimdLevel simd)
    : read_(read), triangles_(triangles), kernel_(stage_kernel(simd)) {
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
    const bool plain = triangles.implicit() && read.representatives.empty() &&
                       !input_.positions.empty() && !input_.normals.empty();
    if (!plain) kernel_ = nullptr;
}

// The i-th triangle is number(i); input's indices have it at first + i.
template <class Number>
void Stager::stage_all(const StageInput& input, std::size_t first, std::size_t count,
                       const Number& number, TermBlock& block) const {
    constexpr std::size_t most_lanes = 16;
    std::size_t i = 0;
    while (i < count) {
        if (kernel_ != nullptr) i += kernel_(input, first + i, count - i, i, block);
        for (const std::size_t end = std::min(count, i + most_lanes); i < end; ++i)
            stage_one(number(i), i, block);
    }
}

void Stager::stage(std::size_t first, std::size_t count, TermBlock& block) const {
    stage_all(
        input_, first, count, [&](std::size_t i) { return first + i; }, block);
}

void Stager::stage(std::span<const std::uint32_t> list, TermBlock& block) const {
    // Their indices, behind one another.
    std::uint32_t indices[3][3 * TermBlock::size];
    StageInput input = input_;
    if (kernel_ != nullptr) {
        const std::uint32_t** const from[3] = {&input.position_indices, &input.normal_indices,
                                               &input.uv_indices};
        for (std::size_t layer = 0; layer < 3; ++layer) {
            for (std::size_t i = 0; i < list.size(); ++i)
                std::copy_n(*from[layer] + 3 * std::size_t(list[i]), 3, indices[layer] + 3 * i);
            *from[layer] = indices[layer];
        }
    }
    stage_all(
        input, 0, list.size(), [&](std::size_t i) { return std::size_t(list[i]); }, block);
}

void Stager::stage_one(std::size_t triangle, std::size_t i, TermBlock& block) const {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = triangles_.corner(triangle, k);
        const glm::vec3 p = read_.position(corner), n = read_.normal(corner);
        const glm::vec2 uv = read_.uv(corner);
        for (int d = 0; d < 3; ++d) block.p[k][d][i] = p[d];
        for (int d = 0; d < 3; ++d) block.n[k][d][i] = n[d];
        for (int d = 0; d < 2; ++d) block.uv[k][d][i] = uv[d];
    }
}

}  // namespace prep::detail
