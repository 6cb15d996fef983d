// Faces that have the same points as an earlier one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prep/mesh.h"

namespace prep::detail {

struct DuplicateFaces {                   // ascending
    std::vector<std::uint32_t> same;      // an earlier face runs in the same direction
    std::vector<std::uint32_t> opposite;  // an earlier face runs in the other direction only
};

// Among `candidates` (ascending); `welded` says which vertices are one point. O(n log n).
DuplicateFaces find_duplicate_faces(const Mesh& mesh, std::span<const std::uint32_t> welded,
                                    const std::vector<std::uint32_t>& candidates);

}  // namespace prep::detail
