// The triangles that MikkTSpace works on, with their frames and welded vertices: steps 1 to 4.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prep/tangents.h"

namespace prep::detail {

enum TriangleFlag : std::uint8_t {  // bits
    orientation_preserving = 1,
    group_with_anything = 2,   // no frame of its own: takes part in whatever group reaches it
    quad_half = 4,             // one of the two triangles of a four-cornered face
    half_degenerate_quad = 8,  // the other half of its quad is degenerate (set on both)
};

struct TriangleFrame {
    glm::vec3 s{0.0f}, t{0.0f};        // unit where the triangle is healthy
    float s_length = 0, t_length = 0;  // |dP/du|, |dP/dv|
};

struct TangentMesh {
    // Good triangles first, in face order; the degenerate ones (two equal positions) behind.
    std::size_t good = 0;
    std::vector<std::uint32_t> corners;  // three per triangle
    std::vector<std::uint32_t> faces;    // one per triangle
    std::vector<std::uint8_t> flags;     // one per triangle
    std::vector<TriangleFrame> frames;   // one per good triangle
    std::vector<std::uint32_t> welded;   // per corner: its welded vertex, numbered from 0
    std::uint32_t welded_count = 0;
    bool any_quad = false, any_polygon = false;
};

// Position, normal and UV of a corner.
struct CornerReader {
    const TangentInput& in;
    glm::vec3 position(std::uint32_t corner) const {
        return in.positions[in.corner_vertices[corner]];
    }
    glm::vec3 normal(std::uint32_t corner) const {
        const std::uint32_t i = in.normals.indices[corner];
        return i == no_index ? glm::vec3(std::numeric_limits<float>::quiet_NaN())
                             : in.normals.values[i];
    }
    glm::vec2 uv(std::uint32_t corner) const {
        const std::uint32_t i = in.uv.indices[corner];
        return i == no_index ? glm::vec2(std::numeric_limits<float>::quiet_NaN()) : in.uv.values[i];
    }
};

TangentMesh build_tangent_mesh(const TangentInput& input, const TangentOptions& options);

}  // namespace prep::detail
