// Groups of few triangles around a vertex and their tangents, without lists: what hard edges and
// UV seams leave of a star is a fan or two.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "tangents/stars.h"

namespace prep::detail {

inline constexpr std::size_t most_small = 16;  // members

struct SmallGroups {
    struct Group {
        std::uint32_t members;  // a bit for each, by its place in the star
        bool preserving;        // orientation
        glm::vec3 tangent;      // unit where it is not zero
    };
    std::size_t count = 0;
    std::array<Group, most_small> groups;  // by their first members
};

// Steps 5 to 7 for a star of up to most_small triangles of which none groups with anything, with
// edges paired as the definition has it. False, with nothing of use, where the S or the T of a
// group do not share a half-space (TermCode).
bool find_small_groups(const TangentStars& stars, const Terms& terms,
                       std::span<const std::uint32_t> star, SmallGroups& result);

}  // namespace prep::detail
