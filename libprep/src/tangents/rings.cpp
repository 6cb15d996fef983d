#include "tangents/rings.h"

#include "tangents/math.h"

namespace prep::detail {

void rings_scalar(const VertexRing* rings, std::span<const glm::vec3>, RingBatch& batch) {
    for (std::size_t i = 0; i < batch.count; ++i) {
        StarSum& star = batch.stars[i];
        const std::size_t members = batch.members[i];
        const std::uint32_t code = batch.codes[i];
        const bool fan = may_be_fan(code, members) &&
                         (members == 1 || is_one_fan(rings[batch.slots[i]], members));
        const glm::vec3 unit = mikk::normalized_or_zero({star.x, star.y, star.z});
        star = {unit.x, unit.y, unit.z, fan ? (code & orientation_preserving) | star_is_fan : 0};
    }
}

}  // namespace prep::detail
