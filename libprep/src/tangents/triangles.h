// The triangles that MikkTSpace works on: step 1 of the definition (quads), and larger polygons.
#pragma once

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
    std::span<const std::uint32_t> representatives{};
    bool unit_normals = false;  // make normals unit that are far from it

    std::uint32_t source(std::uint32_t corner) const {
        return representatives.empty() ? corner : representatives[corner];
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
        return unit_normals ? unit_normal(in.normals.values[i]) : in.normals.values[i];
    }
    glm::vec2 uv(std::uint32_t corner) const {
        const std::uint32_t i = in.uv.indices[source(corner)];
        return i == no_index ? glm::vec2(std::numeric_limits<float>::quiet_NaN()) : in.uv.values[i];
    }
};

// Polygons of more than four corners are cut where `polygons` says so, else left out.
TangentTriangles tangent_triangles(const TangentInput& input, bool polygons, int threads);

}  // namespace prep::detail
