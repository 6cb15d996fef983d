#include "tangent_fans.h"

#include <algorithm>

#include "tangent_math.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

bool one_fan(const FanInput& in, const Index* members, std::size_t count) {
    Index next[most_fan_members], previous[most_fan_members], successors[most_fan_members];
    for (std::size_t i = 0; i < count; ++i) {
        const Index t = members[i] >> 2;
        next[i] = in.vertices[std::size_t(next_corner(members[i])) - t];
        previous[i] = in.vertices[std::size_t(previous_corner(members[i])) - t];
    }
    std::size_t open = 0;
    for (std::size_t i = 0; i < count; ++i) {
        Index* const end = previous + count;
        Index* const found = std::find(previous, end, next[i]);
        if (found != end && std::find(found + 1, end, next[i]) != end) return false;
        successors[i] = found == end ? Index(most_fan_members) : Index(found - previous);
        open += found == end;
    }
    if (open > 1 || (open == 1 && close_fan(successors, count) >= count)) return false;
    return is_one_ring(successors, count);
}

}  // namespace

void fans_scalar(const FanInput& in, std::size_t begin, std::size_t end, FanSum* sums) {
    for (std::size_t v = begin; v < end; ++v) {
        FanSum& result = sums[v - begin];
        result = {0, 0, 0, 0};
        const std::size_t count = in.offsets[v + 1] - in.offsets[v];
        if (count == 0 || count > most_fan_members || in.split[v]) continue;
        const Index* members = in.members + in.offsets[v];
        glm::vec3 sum(0.0f);
        std::uint32_t all = ~0u, any = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const CornerTerm& term = in.planes[members[i] & 3][members[i] >> 2];
            sum += glm::vec3(term.x, term.y, term.z);
            all &= term.code;
            any |= term.code;
        }
        if (!may_be_fan(all, any, count) || (count > 1 && !one_fan(in, members, count))) continue;
        sum = mikk::normalized_or_zero(sum);
        result = {sum.x, sum.y, sum.z, (any & orientation_preserving) | fan_found};
    }
}

}  // namespace prep::detail
