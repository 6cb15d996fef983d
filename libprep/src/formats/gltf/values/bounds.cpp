#include "formats/gltf/values/bounds.h"

#include <algorithm>

namespace prep::detail {

void set_bounds(const RawAccessor& raw, Json& out) {
    RawAccessor plain = raw;
    plain.normalized = false;
    const std::vector<float> values = to_floats(plain);
    Json low = Json::array(), high = Json::array();
    for (int k = 0; k < raw.width; ++k) {
        float least = values[std::size_t(k)], most = least;
        for (std::size_t v = 0; v < raw.count; ++v) {
            const float x = values[v * std::size_t(raw.width) + std::size_t(k)];
            least = std::min(least, x);
            most = std::max(most, x);
        }
        if (raw.component_type == 5126) {
            low.push_back(least);
            high.push_back(most);
        } else {
            low.push_back(std::int64_t(least));
            high.push_back(std::int64_t(most));
        }
    }
    out["min"] = std::move(low);
    out["max"] = std::move(high);
}

}  // namespace prep::detail
