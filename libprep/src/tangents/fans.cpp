#include "tangents/fans.h"

namespace prep::detail {

FanMaker::FanMaker(const CornerReader& read, const FanOptions& options)
    : read_(read),
      options_(options),
      rings_(ring_kernel(options.simd, read.in.normals.values.size())) {}

void FanMaker::make(const VertexRing* rings, RingBatch& batch,
                    std::span<const std::uint32_t> places, std::span<glm::vec4> values,
                    std::span<std::uint8_t> states) const {
    rings_(rings, options_.review ? read_.in.normals.values : std::span<const glm::vec3>{}, batch);
    // Of a fan's code what has to be so.
    const std::uint32_t needed = star_is_fan | (options_.review ? star_has_frame : 0);
    const std::uint32_t* const place = places.empty() ? nullptr : places.data();
    for (std::size_t i = 0; i < batch.count; ++i) {
        const StarSum& star = batch.stars[i];
        const std::uint32_t v = batch.vertices[i];
        const bool fan = (star.code & needed) == needed ||
                         (star.code != 0 && is_frame(read_.usable(batch.normals[i]),
                                                     glm::vec3(star.x, star.y, star.z)));
        states[v] = fan ? fan_vertex : listed_vertex;
        if (!fan) continue;
        const float sign = (star.code & orientation_preserving) ? 1.0f : -1.0f;
        values[place == nullptr ? v : place[v]] =
            glm::vec4(star.x, star.y, star.z, sign * options_.positive);
    }
}

}  // namespace prep::detail
