// Which triangle corners have a fan's value, and which have to be listed for tangents/groups.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tangents/contributions.h"
#include "tangents/stars.h"
#include "tangents/valence.h"

namespace prep::detail {

struct ListedCorners {
    MemberLists lists;
    std::vector<std::uint64_t> triangles;  // a bit for each that has such corners
    bool any = false;
};

// Fans that share a triangle with a split vertex become listed: over an edge to it triangles may
// part. O(triangles).
void list_split_neighbours(std::span<const std::uint32_t> vertices, int threads,
                           std::span<std::uint8_t> states);

// How many triangles from the first on have no corners but fans' (a multiple of a vector's lanes).
// Reads up to three bytes behind states; vertices must be below 2^31.
using FanSearch = std::size_t (*)(const std::uint8_t* states, const std::uint32_t* vertices,
                                  std::size_t triangles);
FanSearch fan_search();  // in simd/; nullptr where vectors have no gathers

// states, places: VertexCounts'; no states: all vertices are listed. corner_values: in, the
// vertices, three per triangle; out, the places of their fans' values, and no_index for listed
// corners and those of degenerate triangles. O(triangles).
ListedCorners place_corners(const TangentTriangles& triangles, const Terms& terms,
                            std::span<const std::uint32_t> vertices,
                            std::span<const std::uint8_t> states,
                            std::span<const std::uint32_t> places, int threads,
                            std::span<std::uint32_t> corner_values);

}  // namespace prep::detail
