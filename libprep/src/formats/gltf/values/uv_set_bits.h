// Sets of UV sets: a bit for each, those from 63 on one together.
#pragma once

#include <algorithm>
#include <cstdint>

#include "prep/mesh.h"

namespace prep::detail {

inline std::uint64_t uv_set_bit(std::size_t uv_set) {
    return std::uint64_t(1) << std::min<std::size_t>(uv_set, 63);
}

// Those that the mesh has.
inline std::uint64_t uv_set_bits(const VertexMesh& mesh) {
    std::uint64_t sets = 0;
    for (std::size_t s = 0; s < mesh.uvs.size(); ++s)
        if (!mesh.uvs[s].empty()) sets |= uv_set_bit(s);
    return sets;
}

}  // namespace prep::detail
