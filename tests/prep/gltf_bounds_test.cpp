// Bounds of accessors, against a loop over single numbers.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "formats/gltf/values/bounds.h"

namespace {

using prep::detail::Json;
using prep::detail::RawAccessor;

// The first of equals: of zeros of both signs that is the one that came first.
Json plain_bounds(const std::vector<float>& values, std::size_t width, bool most) {
    Json out = Json::array();
    for (std::size_t k = 0; k < width; ++k) {
        float bound = values[k];
        for (std::size_t i = k; i < values.size(); i += width)
            if (most ? values[i] > bound : values[i] < bound) bound = values[i];
        out.push_back(bound);
    }
    return out;
}

TEST(GltfBounds, AreThoseOfSingleNumbers) {
    std::mt19937 random(3);
    const float few[] = {0.0f, -0.0f, 1.5f, -2.25f, 1e-40f, 3e38f};
    for (int n = 0; n < 4000; ++n) {
        const std::size_t width = 1 + random() % 4;
        // Whole blocks of 4,096 elements and what is left of one, now and then.
        const std::size_t count = n % 400 == 0 ? 8192 + random() % 40 : 1 + random() % 40;
        const std::size_t kinds = 1 + random() % std::size(few);  // 2: zeros alone
        std::vector<float> values;
        for (std::size_t i = 0; i < count * width; ++i) values.push_back(few[random() % kinds]);
        RawAccessor raw;
        raw.width = int(width);
        raw.count = count;
        std::vector<std::byte> bytes(values.size() * sizeof(float));
        std::memcpy(bytes.data(), values.data(), bytes.size());
        raw.bytes = std::move(bytes);
        Json made;
        prep::detail::set_bounds(raw, made);
        // As text, in which zeros have signs.
        ASSERT_EQ(made["min"].dump(), plain_bounds(values, width, false).dump()) << n;
        ASSERT_EQ(made["max"].dump(), plain_bounds(values, width, true).dump()) << n;
    }
}

}  // namespace
