#include "tangent_fans.h"

#include <array>

namespace prep::detail {

FanMaker::FanMaker(const CornerReader& read, const FanOptions& options)
    : read_(read),
      options_(options),
      rings_(ring_kernel(options.simd, read.in.normals.values.size())) {}

void FanMaker::make(RingInput input, std::span<const std::uint32_t> vertices,
                    std::span<const std::uint32_t> places, std::span<glm::vec4> values,
                    std::span<std::uint8_t> states) const {
    input.normals = options_.review ? read_.in.normals.values : std::span<const glm::vec3>{};
    std::array<StarSum, ring_batch> stars;
    rings_(input, stars.data());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const StarSum& star = stars[i];
        const VertexSum& sum = input.sums[input.slots[i]];
        const std::uint32_t v = vertices[i];
        const glm::vec3 tangent(star.x, star.y, star.z);
        const bool fan = star.code != 0 && (!options_.review || (star.code & star_has_frame) ||
                                            is_frame(read_.usable(sum.normal), tangent));
        states[v] = fan ? fan_vertex : sum.split ? split_vertex : listed_vertex;
        if (!fan) continue;
        const float sign = (star.code & orientation_preserving) ? 1.0f : -1.0f;
        values[places.empty() ? v : places[v]] = glm::vec4(tangent, sign * options_.positive);
    }
}

}  // namespace prep::detail
