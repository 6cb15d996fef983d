#include "cost/oracles/partitions.h"

#include <algorithm>
#include <map>
#include <set>

namespace cost {

PartitionMistakes partition_mistakes(std::span<const std::uint32_t> points,
                                     std::span<const std::uint32_t> vertices) {
    std::map<std::uint32_t, std::set<std::uint32_t>> of_point, of_vertex;
    for (std::size_t c = 0; c < points.size(); ++c) {
        of_point[points[c]].insert(vertices[c]);
        of_vertex[vertices[c]].insert(points[c]);
    }
    PartitionMistakes out;
    out.points = of_point.size();
    for (const auto& [point, own] : of_point) {
        const bool torn = own.size() > 1;
        const bool melted = std::any_of(own.begin(), own.end(),
                                        [&](std::uint32_t v) { return of_vertex[v].size() > 1; });
        out.torn += torn;
        out.melted += melted;
        out.wrong += torn || melted;
    }
    return out;
}

}  // namespace cost
