#include "formats/gltf/values/bounds.h"

#include <algorithm>

namespace prep::detail {

void set_bounds(const RawAccessor& raw, Json& out) {
    if (raw.count == 0) return;
    RawAccessor block = raw;
    block.normalized = false;
    const auto width = std::size_t(raw.width);
    std::vector<float> leasts, mosts, values;
    // A block at a time: no copy of the whole.
    for (std::size_t first = 0; first < raw.count; first += block.count) {
        block.count = std::min<std::size_t>(4096, raw.count - first);
        block.bytes = raw.bytes.part(first * raw.element_size(), block.count * raw.element_size());
        values.resize(block.count * width);
        write_floats(block, raw.width, values.data());
        if (first == 0) leasts = mosts = {values.begin(), values.begin() + raw.width};
        for (std::size_t v = 0; v < values.size(); v += width)
            for (std::size_t k = 0; k < width; ++k) {
                leasts[k] = std::min(leasts[k], values[v + k]);
                mosts[k] = std::max(mosts[k], values[v + k]);
            }
    }
    Json low = Json::array(), high = Json::array();
    for (std::size_t k = 0; k < width; ++k) {
        const float least = leasts[k], most = mosts[k];
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
