// The movement of one vertex of the file, in a morph target's runs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "prep/mesh.h"

namespace prep::detail {

// `runs` ascend by their first vertices and do not overlap. Null: none of them has the vertex.
// O(log runs).
inline const glm::vec3* delta_of(const std::vector<VertexDeltas>& runs, std::uint32_t file_vertex) {
    const auto behind = std::upper_bound(
        runs.begin(), runs.end(), file_vertex,
        [](std::uint32_t v, const VertexDeltas& run) { return v < run.first_vertex; });
    if (behind == runs.begin()) return nullptr;
    const VertexDeltas& run = *(behind - 1);
    const std::size_t at = file_vertex - run.first_vertex;
    return at < run.values->size() ? &(*run.values)[at] : nullptr;
}

}  // namespace prep::detail
