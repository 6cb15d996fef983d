// Position, normal and UV of a corner as one value: what step 2 of the definition compares.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "tangents/triangles.h"

namespace prep::detail {

struct CornerKey {
    std::array<std::uint32_t, 8> words;  // the bits, with −0 as 0
    bool number = true;                  // no component is NaN: NaN equals nothing
    bool operator<(const CornerKey& other) const { return words < other.words; }
    bool operator==(const CornerKey& other) const { return number && words == other.words; }
};

inline CornerKey corner_key(const CornerReader& read, std::uint32_t corner) {
    CornerReader raw = read;
    raw.unit_normals = false;
    const glm::vec3 p = raw.position(corner), n = raw.normal(corner);
    const glm::vec2 t = raw.uv(corner);
    const float values[8] = {p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y};
    CornerKey key;
    for (std::size_t k = 0; k < 8; ++k) {
        key.number &= values[k] == values[k];
        // Adding 0 turns −0 into 0 and changes nothing else.
        key.words[k] = std::bit_cast<std::uint32_t>(values[k] + 0.0f);
    }
    return key;
}

inline std::uint64_t hash_of(const CornerKey& key) {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (std::size_t k = 0; k < 8; k += 2) {
        h ^= std::uint64_t(key.words[k]) << 32 | key.words[k + 1];
        h *= 0xbf58476d1ce4e5b9u;
        h ^= h >> 29;
    }
    return h ^ (h >> 32);
}

}  // namespace prep::detail
