// Whether corners that are one point have one vertex, and only they.
#pragma once

#include <cstdint>
#include <span>

namespace cost {

struct PartitionMistakes {
    std::size_t points = 0;            // different ones
    std::size_t torn = 0, melted = 0;  // points with several vertices; points that share a vertex
                                       // with another; some are both
    std::size_t wrong = 0;             // points that are either
};

// By corner: the point that it is, from 0 on, and the vertex that it has. O(n log n).
PartitionMistakes partition_mistakes(std::span<const std::uint32_t> points,
                                     std::span<const std::uint32_t> vertices);

}  // namespace cost
