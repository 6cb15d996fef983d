#include "tangent_rings.h"

#include "tangent_math.h"

namespace prep::detail {

void rings_scalar(const RingInput& in, StarSum* stars) {
    for (std::size_t i = 0; i < in.slots.size(); ++i) {
        StarSum& result = stars[i];
        result = {0, 0, 0, 0};
        const std::size_t count = in.counts[i];
        const VertexSum& sum = in.sums[in.slots[i]];
        if (!may_be_fan(sum, count) || (count > 1 && !is_one_fan(in.rings[in.slots[i]], count)))
            continue;
        const glm::vec3 unit = mikk::normalized_or_zero({sum.x, sum.y, sum.z});
        result = {unit.x, unit.y, unit.z, (sum.code & orientation_preserving) | star_is_fan};
    }
}

}  // namespace prep::detail
