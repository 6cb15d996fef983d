// The triangles that MikkTSpace works on: step 1 of the definition (quads), and larger polygons.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "prep/tangents.h"
#include "tangents/math.h"

namespace prep::detail {

struct TangentTriangles {
    std::size_t count = 0;
    // Three per triangle, in face order; empty where every face is a triangle: triangle t then has
    // the corners 3t, 3t + 1, 3t + 2.
    std::vector<std::uint32_t> corners;
    // Per triangle 1 for the first half of a quad, 2 for its second, else 0; empty like `corners`.
    std::vector<std::uint8_t> halves;
    bool any_quad = false;

    bool implicit() const { return corners.empty(); }
    // The nearest place up to `triangle` that parts no quad.
    std::size_t cut(std::size_t triangle) const {
        const bool parts = triangle < halves.size() && halves[triangle] == 2;
        return parts ? triangle - 1 : triangle;
    }
    std::uint32_t corner(std::size_t triangle, std::size_t k) const {
        return this->corner(3 * triangle + k);
    }
    std::uint32_t corner(std::size_t i) const {
        return corners.empty() ? std::uint32_t(i) : corners[i];
    }
};

// Position, normal and UV of a corner; NaN where it has none.
struct CornerReader {
    const TangentInput& in;
    // Corners that stand for others of equal value (they differ in the sign of zeros at most);
    // empty: each for itself.
    std::span<const std::uint32_t> welds{};
    bool unit_normals = false;  // make normals unit that are far from it

    std::uint32_t source(std::uint32_t corner) const {
        return welds.empty() ? corner : welds[corner];
    }
    glm::vec3 position(std::uint32_t corner) const {
        return in.positions[in.corner_vertices[source(corner)]];
    }
    glm::vec3 normal(std::uint32_t corner) const {
        return usable(in.normals.indices[source(corner)]);
    }
    // A normal by its index; none is NaN.
    glm::vec3 usable(std::uint32_t i) const {
        if (i == no_index) return glm::vec3(std::numeric_limits<float>::quiet_NaN());
        return unit_normals ? frame_normal(in.normals.values[i]) : in.normals.values[i];
    }
    glm::vec2 uv(std::uint32_t corner) const {
        const std::uint32_t i = in.uv.indices[source(corner)];
        return i == no_index ? glm::vec2(std::numeric_limits<float>::quiet_NaN()) : in.uv.values[i];
    }
};

// Position, normal and UV of a corner as one value: what step 2 of the definition compares.
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

// Polygons of more than four corners are cut where `polygons` says so, else left out.
TangentTriangles tangent_triangles(const TangentInput& input, bool polygons, int threads);

}  // namespace prep::detail
