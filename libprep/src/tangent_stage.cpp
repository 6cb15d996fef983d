#include "tangent_stage.h"

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

void Stager::stage(std::size_t first, std::size_t count, std::size_t to, TermBlock& block) const {
    constexpr std::size_t most_lanes = 16;
    std::size_t i = 0;
    while (i < count) {
        if (kernel_ != nullptr) i += kernel_(input_, first + i, count - i, to + i, block);
        for (const std::size_t end = std::min(count, i + most_lanes); i < end; ++i)
            stage_one(first + i, to + i, block);
    }
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
