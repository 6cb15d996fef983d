#include "formats/gltf/values/bounds.h"

#include <algorithm>

namespace prep::detail {

namespace {

// Widens the ranges by some elements. Of zeros of both signs the first one counts.
void widen(std::vector<float>& leasts, std::vector<float>& mosts, std::span<const float> values) {
    const std::size_t width = leasts.size();
    constexpr std::size_t lanes = 12;  // whole elements of 1, 2, 3 or 4: several at once
    if (lanes % width != 0) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            leasts[i % width] = std::min(leasts[i % width], values[i]);
            mosts[i % width] = std::max(mosts[i % width], values[i]);
        }
        return;
    }
    float low[lanes], high[lanes];
    for (std::size_t k = 0; k < lanes; ++k) low[k] = leasts[k % width], high[k] = mosts[k % width];
    std::size_t i = 0;
    for (; i + lanes <= values.size(); i += lanes)
        for (std::size_t k = 0; k < lanes; ++k) {
            low[k] = std::min(low[k], values[i + k]);
            high[k] = std::max(high[k], values[i + k]);
        }
    for (; i < values.size(); ++i) {
        low[i % width] = std::min(low[i % width], values[i]);
        high[i % width] = std::max(high[i % width], values[i]);
    }
    const auto first_zero = [&](std::size_t component) {
        std::size_t at = component;
        while (values[at] != 0) at += width;
        return values[at];
    };
    for (std::size_t k = 0; k < width; ++k) {
        float least = low[k], most = high[k];
        for (std::size_t l = k + width; l < lanes; l += width) {
            least = std::min(least, low[l]);
            most = std::max(most, high[l]);
        }
        if (least == 0 && leasts[k] != 0) least = first_zero(k);
        if (most == 0 && mosts[k] != 0) most = first_zero(k);
        leasts[k] = least;
        mosts[k] = most;
    }
}

}  // namespace

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
        widen(leasts, mosts, values);
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
