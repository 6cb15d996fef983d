#include "surface/duplicate_faces.h"

#include <algorithm>
#include <compare>

namespace prep::detail {
namespace {

using Index = std::uint32_t;

std::uint64_t mix(std::uint64_t h) {  // the finaliser of SplitMix64 (Steele et al. 2014)
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

// A face's points, starting with the lowest, in the direction that has the lower second one.
struct Cycle {
    std::vector<Index> points;
    Index face = 0;
    bool reversed = false;
};

Cycle cycle_of(const Mesh& mesh, std::span<const Index> welded, Index face) {
    const Index begin = mesh.face_offsets[face], end = mesh.face_offsets[face + 1];
    Cycle cycle;
    cycle.face = face;
    for (Index c = begin; c < end; ++c) cycle.points.push_back(welded[mesh.corner_vertices[c]]);
    auto& p = cycle.points;
    std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
    cycle.reversed = p.back() < p[1];
    if (cycle.reversed) std::reverse(p.begin() + 1, p.end());
    return cycle;
}

}  // namespace

// The sum of hashed points finds the few that can be equal; those are compared point by point.
DuplicateFaces find_duplicate_faces(const Mesh& mesh, std::span<const Index> welded,
                                    const std::vector<Index>& candidates) {
    struct Key {
        std::uint64_t hash;
        Index face;
        auto operator<=>(const Key&) const = default;
    };
    std::vector<Key> keys;
    keys.reserve(candidates.size());
    for (const Index f : candidates) {
        std::uint64_t hash = 0;
        for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            hash += mix(std::uint64_t(welded[mesh.corner_vertices[c]]) + 1);
        keys.push_back({hash, f});
    }
    std::sort(keys.begin(), keys.end());
    DuplicateFaces found;
    for (std::size_t i = 0; i < keys.size();) {
        std::size_t end = i + 1;
        while (end < keys.size() && keys[end].hash == keys[i].hash) ++end;
        if (end - i > 1) {
            std::vector<Cycle> cycles;
            for (std::size_t k = i; k < end; ++k)
                cycles.push_back(cycle_of(mesh, welded, keys[k].face));
            std::sort(cycles.begin(), cycles.end(), [](const Cycle& a, const Cycle& b) {
                return a.points != b.points ? a.points < b.points : a.face < b.face;
            });
            bool seen[2] = {false, false};
            for (std::size_t k = 0; k < cycles.size(); ++k) {
                if (k == 0 || cycles[k].points != cycles[k - 1].points) seen[0] = seen[1] = false;
                if (seen[cycles[k].reversed])
                    found.same.push_back(cycles[k].face);
                else if (seen[!cycles[k].reversed])
                    found.opposite.push_back(cycles[k].face);
                seen[cycles[k].reversed] = true;
            }
        }
        i = end;
    }
    std::sort(found.same.begin(), found.same.end());
    std::sort(found.opposite.begin(), found.opposite.end());
    return found;
}

}  // namespace prep::detail
