// What each triangle gives to the tangents of its three corners: steps 3, 4 and the summands of 7.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/scratch_buffer.h"
#include "tangents/triangles.h"

namespace prep::detail {

// Inputs of up to `size` triangles: [corner][component][triangle].
struct TriangleBlock {
    static constexpr std::size_t size = 128;
    alignas(64) float p[3][3][size];
    alignas(64) float n[3][3][size];
    alignas(64) float uv[3][2][size];
};

// Indices are three per triangle. Behind each value but the last there is something to read.
struct GatherInput {
    const std::uint32_t *position_indices, *normal_indices, *uv_indices;
    std::span<const glm::vec3> positions, normals;
    std::span<const glm::vec2> uvs;
};

// Gathers triangles from `first` on at places from `to` on: as many whole vectors of the first
// `count` as have no index of the last position or normal, or of none. Gives how many triangles.
using GatherKernel = std::size_t (*)(const GatherInput& input, std::size_t first, std::size_t count,
                                     std::size_t to, TriangleBlock& block);

GatherKernel gather_kernel(SimdLevel level);  // contribution_kernels.cpp

// The summand of one triangle at one corner: its S on the plane of the normal, unit, times the
// corner's angle. −0 in all three where the triangle adds nothing (−0 is neutral in sums).
struct alignas(16) Contribution {
    float x, y, z;
    std::uint32_t code;  // bits of ContributionCode
};

// Directions of the projected S and T: bit k is set where component k is above direction_bound, bit
// k + 3 where it is below its negative. S and T are unit before they are projected, so that is more
// than 5 % of the length. Vectors that share a bit are less than 180° apart by a margin (cosine ≥
// −0.995) that no rounding reaches; triangles that group with anything share all. None is set where
// the normal is not unit.
enum ContributionCode : std::uint32_t {
    s_directions = 0x03f,
    t_directions = 0xfc0,
    orientation_preserving = 1u << 12,  // these and the following are the same at all three corners
    // The opposites of what is before and behind, so that one conjunction over a ring's codes tells
    // all. Those up to here are what rings are told by.
    orientation_mirrored = 1u << 13,
    own_frame = 1u << 14,
    group_with_anything = 1u << 15,  // no frame of its own: joins whatever group reaches it
    degenerate_triangle = 1u << 16,  // two equal positions: takes no part
    quad_first = 1u << 17,
    quad_second = 1u << 18,
    half_degenerate_quad = 1u << 19,  // the other half of its quad is degenerate
    code_float = 1u << 30,  // in all: codes that get into sums of floats are no denormal numbers
};
inline constexpr float direction_bound = 0.051f;
inline constexpr float most_off_unit = 2e-3f;    // of a normal's squared length, from 1
inline constexpr int triangle_flags_shift = 12;  // eight bits from there on are kept per triangle

struct TriangleCounts {
    std::uint64_t mirrored = 0, anything = 0, degenerate = 0;  // disjoint
    bool nan = false;  // set where a position, normal or UV is NaN (also for some infinite ones)

    void add(const TriangleCounts& other) {
        mirrored += other.mirrored;
        anything += other.anything;
        degenerate += other.degenerate;
        nan |= other.nan;
    }
};

struct BlockResult {
    TriangleCounts counts;
    bool far_from_unit =
        false;  // a normal is more than 0.1 % off: nothing else is meant to be used
};

// Writes `count` contributions (up to TriangleBlock::size, the rest undefined) to each plane.
// Kernels may read and write the whole block. check_unit: look for normals far from unit.
using ContributionKernel = BlockResult (*)(const TriangleBlock& block, std::size_t count,
                                           bool check_unit, Contribution* const planes[3]);

ContributionKernel contribution_kernel(SimdLevel level);  // contribution_kernels.cpp

// The contributions of a few triangles at a time.
class BlockContributions {
  public:
    // What it works in; large, and worth keeping from one call to the next.
    struct Scratch {
        TriangleBlock inputs{};
        alignas(64) Contribution planes[3][TriangleBlock::size];
    };

    BlockContributions(const CornerReader& read, const TangentTriangles& triangles,
                       const TangentOptions& options);
    BlockContributions(const BlockContributions&) = delete;
    BlockContributions& operator=(const BlockContributions&) = delete;

    // The contributions of triangles [first, end), up to TriangleBlock::size of them, to
    // scratch.planes; adds to the counts and gives how many it made. Neither `first` nor `end` may
    // part a quad; it does not.
    std::size_t run(std::size_t first, std::size_t end, Scratch& scratch,
                    TriangleCounts& counts) const;
    // The same for up to TriangleBlock::size triangles by number; halves of quads need not agree.
    void run(std::span<const std::uint32_t> list, Scratch& scratch) const;
    // Asks for the inputs of a block that comes later, where they are in no cache.
    void fetch_ahead(std::size_t first, std::size_t end) const;

  private:
    template <class Number>
    void gather_all(const GatherInput& input, std::size_t first, std::size_t count,
                    const Number& number, TriangleBlock& block) const;
    void gather_list(std::span<const std::uint32_t> list, TriangleBlock& block) const;
    void gather_one(std::size_t triangle, std::size_t i, TriangleBlock& block) const;
    TriangleCounts finish(std::size_t count, Scratch& scratch) const;
    void settle_quads(std::size_t first, std::size_t count, Scratch& scratch) const;

    const CornerReader& read_;
    const TangentTriangles& triangles_;
    std::vector<glm::vec3> few_normals_;
    GatherInput input_;
    GatherKernel gather_;
    ContributionKernel kernel_;
    bool check_unit_;
};

struct ContributionStore {
    std::uint32_t flags(std::size_t triangle) const {
        return std::uint32_t(triangle_flags[triangle]) << triangle_flags_shift;
    }
    // Of a triangle that has contributions.
    const Contribution& at(std::size_t triangle, std::size_t k) const {
        return planes[k][place(triangle)];
    }
    std::size_t place(std::size_t triangle) const {
        if (chosen.empty()) return triangle;
        const std::uint64_t below = (std::uint64_t(1) << (triangle % 64)) - 1;
        return chosen_before[triangle / 64] +
               std::size_t(std::popcount(chosen[triangle / 64] & below));
    }

    ScratchBuffer<std::uint8_t> triangle_flags;
    TriangleCounts counts;
    ScratchBuffer<Contribution> planes[3];
    bool complete = false;  // all triangles have contributions
    // Which triangles have contributions, and how many do before each 64 of them; empty: all have.
    std::vector<std::uint64_t> chosen;
    std::vector<std::uint32_t> chosen_before;
};

// Flags, counts and contributions of all triangles.
void compute_all_contributions(const BlockContributions& maker, const TangentTriangles& triangles,
                               int threads, ContributionStore& contributions);
// ContributionStore of those that `chosen` has: one bit per triangle.
void compute_chosen(const BlockContributions& maker, std::vector<std::uint64_t> chosen, int threads,
                    ContributionStore& contributions);

// The bits of a corner's S and T (unit or zero) on the plane of its normal, all that are so.
std::uint32_t direction_code(const glm::vec3& n, const glm::vec3& s, const glm::vec3& t);

// A triangle's own frame, as step 4 gives it (for vertices that need more than sums).
struct TriangleFrame {
    glm::vec3 s{0.0f}, t{0.0f};        // unit where the triangle is healthy
    float s_length = 0, t_length = 0;  // |dP/du|, |dP/dv|
    bool preserving = false, healthy = false;
};
TriangleFrame triangle_frame(const CornerReader& read, const TangentTriangles& triangles,
                             std::size_t triangle);

}  // namespace prep::detail
