// Brings the inputs of triangles together, component by component, for the kernels of
// tangents/contributions.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "tangents/triangles.h"

namespace prep::detail {

// Inputs of up to `size` triangles: [corner][component][triangle].
struct TermBlock {
    static constexpr std::size_t size = 128;
    alignas(64) float p[3][3][size];
    alignas(64) float n[3][3][size];
    alignas(64) float uv[3][2][size];
};

// Indices are three per triangle. Behind each value but the last there is something to read.
struct StageInput {
    const std::uint32_t *position_indices, *normal_indices, *uv_indices;
    std::span<const glm::vec3> positions, normals;
    std::span<const glm::vec2> uvs;
};

// Stages triangles from `first` on at places from `to` on: as many whole vectors of the first
// `count` as have no index of the last position or normal, or of none. Gives how many triangles.
using StageKernel = std::size_t (*)(const StageInput& input, std::size_t first, std::size_t count,
                                    std::size_t to, TermBlock& block);

StageKernel stage_kernel(SimdLevel level);  // in simd/; nullptr for scalar

class Stager {
  public:
    Stager(const CornerReader& read, const TangentTriangles& triangles, SimdLevel simd);
    Stager(const Stager&) = delete;
    Stager& operator=(const Stager&) = delete;

    // Triangles from `first` on.
    void stage(std::size_t first, std::size_t count, TermBlock& block) const;
    // Triangles by number, up to TermBlock::size.
    void stage(std::span<const std::uint32_t> list, TermBlock& block) const;

  private:
    template <class Number>
    void stage_all(const StageInput& input, std::size_t first, std::size_t count,
                   const Number& number, TermBlock& block) const;
    void stage_one(std::size_t triangle, std::size_t i, TermBlock& block) const;

    const CornerReader& read_;
    const TangentTriangles& triangles_;
    std::vector<glm::vec3> few_normals_;
    StageInput input_;
    StageKernel kernel_;
};

}  // namespace prep::detail
