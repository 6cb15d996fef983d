#include "formats/gltf/values/value_repair.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "base/finite.h"
#include "normals/authored_normals.h"

namespace prep::detail {
namespace {

constexpr int u8_type = 5121, u16_type = 5123, float_type = 5126;

bool is_color(const std::string& semantic) {
    return semantic.starts_with("COLOR_");
}
bool is_weight(const std::string& semantic) {
    return semantic.starts_with("WEIGHTS_");
}

// Of floats, which may begin anywhere.
bool all_within(std::span<const std::byte> floats, float low, float high) {
    constexpr std::size_t block = 4096 * sizeof(float);
    const std::size_t size = floats.size() / sizeof(float) * sizeof(float);
    for (std::size_t first = 0; first < size; first += block) {
        const std::size_t last = std::min(size, first + block);
        std::uint32_t outside = 0;  // whole numbers: truth values would go one by one
        for (std::size_t at = first; at < last; at += sizeof(float)) {
            float x;
            std::memcpy(&x, floats.data() + at, sizeof x);
            outside |= std::uint32_t(!(x >= low)) | std::uint32_t(!(x <= high));
        }
        if (outside) return false;
    }
    return true;
}

struct Weight {
    int type;
    std::byte* at;
    double value;  // 0 … 1
};

double value_at(int type, const std::byte* at) {
    if (type == u8_type) return std::to_integer<int>(*at) / 255.0;
    if (type == u16_type) {
        std::uint16_t value;
        std::memcpy(&value, at, 2);
        return value / 65535.0;
    }
    float value;
    std::memcpy(&value, at, 4);
    return double(value);
}

// Returns whether the bytes are others than before.
bool write_steps(const Weight& weight, std::uint32_t steps) {
    const std::uint16_t wide = std::uint16_t(steps);
    const std::uint8_t narrow = std::uint8_t(steps);
    const void* from = weight.type == u8_type ? static_cast<const void*>(&narrow) : &wide;
    const std::size_t size = weight.type == u8_type ? 1 : 2;
    if (std::memcmp(weight.at, from, size) == 0) return false;
    std::memcpy(weight.at, from, size);
    return true;
}

class VertexWeights {
  public:
    void clear() { weights_.clear(); }
    void add(int type, std::byte* at) {
        const double value = value_at(type, at);
        if (value > 0) weights_.push_back({type, at, value});
    }

    bool scale() {
        double sum = 0;
        for (const Weight& w : weights_) sum += w.value;
        if (weights_.empty() || std::abs(sum - 1) <= 2e-7 * double(weights_.size())) return false;
        bool changed = false;
        double left = 1;    // of the sum that the vertex is to have
        double rest = sum;  // of the sum that it has
        for (const int type : {u8_type, u16_type}) {
            double own = 0;
            for (const Weight& w : weights_)
                if (w.type == type) own += w.value;
            if (own == 0) continue;
            const bool last = std::none_of(weights_.begin(), weights_.end(),
                                           [&](const Weight& w) { return w.type > type; });
            const double unit = type == u8_type ? 255 : 65535;
            // What is left is a whole number of steps: 255 divides 65535.
            const double share =
                last ? std::round(left * unit) : std::floor(left * unit * (own / rest));
            changed |= hand_out(type, own, share);
            left -= share / unit;
            rest -= own;
        }
        double floats = 0;
        for (const Weight& w : weights_)
            if (w.type == float_type) floats += w.value;
        for (const Weight& w : weights_) {
            if (w.type != float_type) continue;
            const float scaled = float(w.value * left / floats);
            changed |= std::memcmp(w.at, &scaled, 4) != 0;
            std::memcpy(w.at, &scaled, 4);
        }
        return changed;
    }

  private:
    // `steps` among the weights of one type, in the ratio of their values.
    bool hand_out(int type, double sum, double steps) {
        shares_.clear();
        double given = 0;
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            if (weights_[i].type != type) continue;
            const double exact = weights_[i].value / sum * steps;
            shares_.push_back({i, std::floor(exact), exact - std::floor(exact)});
            given += shares_.back().steps;
        }
        std::stable_sort(shares_.begin(), shares_.end(),
                         [](const Share& a, const Share& b) { return a.remainder > b.remainder; });
        bool changed = false;
        for (Share& share : shares_) {
            if (given < steps) ++share.steps, ++given;
            changed |= write_steps(weights_[share.weight], std::uint32_t(share.steps));
        }
        return changed;
    }

    struct Share {
        std::size_t weight;
        double steps, remainder;
    };
    std::vector<Weight> weights_;  // that are not 0
    std::vector<Share> shares_;
};

}  // namespace

const char* const repair_notes[repair_kinds] = {
    "UVs that are not finite were written as 0",
    "vertex colours outside 0 … 1 were clamped",
    "skin weights that are negative or not finite were written as 0",
    "skin weights that do not add up to 1 were rescaled",
    "vertex data that are not finite were written as 0",
};

unsigned repair_values(const std::string& semantic, RepairOf of, RawAccessor& values) {
    if (values.component_type != float_type) return 0;
    const bool own = of == RepairOf::attribute;
    const bool color = own && is_color(semantic), weight = own && is_weight(semantic);
    // NaN is in no range.
    constexpr float largest = std::numeric_limits<float>::max();
    const float low = color || weight ? 0.0f : -largest, high = color ? 1.0f : largest;
    if (all_within(values.bytes, low, high)) return 0;
    std::vector<std::byte> bytes(values.bytes.begin(), values.bytes.end());
    for (std::size_t at = 0; at + 4 <= bytes.size(); at += 4) {
        float x;
        std::memcpy(&x, bytes.data() + at, 4);
        float good = std::isfinite(x) ? x : 0.0f;
        if (color) good = x >= 0 ? std::min(x, 1.0f) : 0.0f;
        if (weight && good < 0) good = 0;
        if (!(std::isfinite(x) && good == x)) std::memcpy(bytes.data() + at, &good, 4);
    }
    values.bytes = std::move(bytes);
    return semantic.starts_with("TEXCOORD_") ? repaired_uv
           : color                           ? repaired_color
           : weight                          ? repaired_weight
                                             : repaired_other;
}

bool are_unit(const RawAccessor& vectors) {
    if (vectors.component_type != 5126 && !vectors.normalized) return false;
    const std::vector<float> values = to_floats(vectors);
    for (std::size_t i = 0; i + 2 < values.size(); i += std::size_t(vectors.width)) {
        const glm::dvec3 v(values[i], values[i + 1], values[i + 2]);
        if (!(std::abs(glm::length(v) - 1) <= unit_tolerance)) return false;
    }
    return true;
}

std::uint64_t drop_non_finite(std::span<const glm::vec3> positions,
                              std::vector<std::uint32_t>& indices) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        if (!is_finite(positions[indices[i]]) || !is_finite(positions[indices[i + 1]]) ||
            !is_finite(positions[indices[i + 2]]))
            continue;
        for (std::size_t k = 0; k < 3; ++k) indices[kept++] = indices[i + k];
    }
    const std::uint64_t dropped = kept > 0 ? (indices.size() - kept) / 3 : 0;
    indices.resize(kept);
    return dropped;
}

bool normalise_weights(std::span<RawAccessor* const> sets) {
    std::size_t count = 0;
    for (const RawAccessor* set : sets) {
        const bool integer = set->component_type == u8_type || set->component_type == u16_type;
        if (set->component_type != float_type && !(integer && set->normalized)) return false;
        count = std::max(count, set->count);
    }
    VertexWeights vertex;
    bool changed = false;
    std::vector<std::vector<std::byte>> bytes;
    for (const RawAccessor* set : sets) bytes.emplace_back(set->bytes.begin(), set->bytes.end());
    for (std::size_t v = 0; v < count; ++v) {
        vertex.clear();
        for (std::size_t s = 0; s < sets.size(); ++s) {
            const RawAccessor& set = *sets[s];
            if (v >= set.count) continue;
            const std::size_t size = component_size(set.component_type);
            for (std::size_t k = 0; k < std::size_t(set.width); ++k)
                vertex.add(set.component_type,
                           bytes[s].data() + (v * std::size_t(set.width) + k) * size);
        }
        changed |= vertex.scale();
    }
    if (changed)
        for (std::size_t s = 0; s < sets.size(); ++s) sets[s]->bytes = std::move(bytes[s]);
    return changed;
}

}  // namespace prep::detail
