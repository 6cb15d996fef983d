// The usual star: one fan of healthy triangles of one orientation, whose tangents only need to be
// summed. Told and summed many at once; whatever is no such star is left to tangent_groups.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "tangent_stars.h"
#include "tangent_terms.h"

namespace prep::detail {

inline constexpr std::size_t most_fan_members = 16;

// The sum of a fan's terms in the order of its triangles, unit where it is not zero.
struct alignas(16) FanSum {
    float x, y, z;
    std::uint32_t code;  // 0: not told to be a fan; else fan_found and what else is so of these
};
inline constexpr std::uint32_t fan_found = 1;  // and orientation_preserving, of all its triangles
inline constexpr std::uint32_t fan_frame = 2;  // the sum makes a frame with the normal, by far

struct FanInput {
    const std::uint32_t* offsets;  // these four as in TangentStars,
    const std::uint32_t* members;  // the first two readable for most_fan_members behind the last
    const std::uint8_t* split;
    const std::uint32_t* vertices;
    const CornerTerm* planes[3];
    // The normals of corners 0, 1, 2, … for fan_frame; none: it is not looked for.
    const std::uint32_t* normal_indices;
    std::span<const glm::vec3> normals;
};

// Up to this many positions at once; `sums` has room for as many. A multiple of all vector lengths.
inline constexpr std::size_t fan_batch = 1024;

// Writes sums[i] for the position begin + i (and anything behind the last). A star is a fan when it
// has up to most_fan_members members, each reached from the first over edges that two triangles
// share and no more, and when their S and their T share a half-space (see TermCode).
using FanKernel = void (*)(const FanInput& input, std::size_t begin, std::size_t end, FanSum* sums);

void fans_scalar(const FanInput& input, std::size_t begin, std::size_t end, FanSum* sums);
FanKernel fan_kernel(SimdLevel level, std::size_t triangles, std::size_t normals);  // in simd/

// What of a star's codes can be told without its edges.
inline bool may_be_fan(std::uint32_t all, std::uint32_t any, std::size_t count) {
    if (((all ^ any) & orientation_preserving) || (any & group_with_anything)) return false;
    return count == 1 || ((all & s_directions) && (all & t_directions));
}

// successors[i]: the member whose edge enters the vertex from where i's leaves to. Exactly one i
// has none (most_fan_members): gives it the first member of the fan, as the sum of the numbers
// tells, and returns that one; at least `count` or a wrong one where the members are no fan.
inline std::uint32_t close_fan(std::uint32_t* successors, std::size_t count) {
    std::uint32_t first = std::uint32_t(count * (count - 1) / 2), last = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const bool none = successors[i] == most_fan_members;
        first -= none ? 0 : successors[i];
        last = none ? i : last;
    }
    if (first < count) successors[last] = first;
    return first;
}

// Does a walk from the first member come back to it after all others?
inline bool is_one_ring(const std::uint32_t* successors, std::size_t count) {
    std::uint32_t seen = 0, at = 0;
    for (std::size_t i = 0; i < count; ++i) {
        seen |= 1u << at;
        at = successors[at];
    }
    return at == 0 && seen == (1u << count) - 1;
}

}  // namespace prep::detail
