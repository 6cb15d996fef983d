// Simple closed-form shapes with UVs, for scenes that need a floor or a ball and no file.
//
// Y is up, centred on zero, counter-clockwise from outside, quads where the shape allows. Vertices
// are shared by position; UVs are per corner, so that seams stay seams. No normals: prepare() makes
// them. Vertices come in rings, so that the same arguments give the same bytes.
#pragma once

#include <cstdint>

#include "prep/mesh.h"

namespace prep::detail {

// In the XZ plane, facing +Y, cut into columns × rows quads; UV (0,0) at −X −Z.
Mesh plane_shape(glm::vec2 size, std::uint32_t columns, std::uint32_t rows);
// Six faces, each with the whole UV square.
Mesh box_shape(glm::vec3 size);
// Latitude and longitude; u runs around from +X towards −Z, v from the north pole down. segments ≥
// 3, rings ≥ 2.
Mesh sphere_shape(float radius, std::uint32_t segments, std::uint32_t rings);
// Side with the whole UV square, caps as polygons with a disc of UVs. segments ≥ 3.
Mesh cylinder_shape(float radius, float height, std::uint32_t segments);
// Ring in the XZ plane. segments ≥ 3 around the ring, sides ≥ 3 around the tube.
Mesh torus_shape(float radius, float tube, std::uint32_t segments, std::uint32_t sides);

}  // namespace prep::detail
