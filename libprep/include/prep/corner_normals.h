// Corner normals: the weighted mean of the face normals in a corner's fan, the faces that can be
// reached around its vertex over edges that are not hard.
//
// Weights of a face at a corner (unit face normal n, area A, corner angle α, edges e1, e2):
//   area         A              the default; depends on the triangulation
//   uniform      1              Gouraud 1971
//   angle        α              Thürmer and Wüthrich 1998; independent of the triangulation
//   area_angle   A·α
//   edge_length  sin α/(|e1||e2|)  Max 1999; exact for vertices on a sphere
// A concave corner of a polygon has its reflex angle, and the edge-length weight of its sine's
// size.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/face_normals.h"
#include "prep/hard_edges.h"
#include "prep/mesh.h"
#include "prep/result.h"
#include "prep/topology.h"

namespace prep {

enum class NormalWeight : std::uint8_t { area, uniform, angle, area_angle, edge_length };
constexpr auto names_of(NormalWeight) {
    return std::to_array<EnumName<NormalWeight>>({{"area", NormalWeight::area},
                                                  {"uniform", NormalWeight::uniform},
                                                  {"angle", NormalWeight::angle},
                                                  {"area-angle", NormalWeight::area_angle},
                                                  {"edge-length", NormalWeight::edge_length}});
}

struct NormalOptions {
    NormalWeight weight = NormalWeight::area;
    Precision precision = Precision::accurate;
    bool keep_doubles = false;  // fill CornerNormals::doubles
    int threads = 0;
};

// How a normal was found where the weighted sum is zero or there is nothing to sum.
enum class NormalFallback : std::uint8_t {
    largest_face,    // the sum is zero: the fan's face of the largest area (the lexicographically
                     // greatest vector on a tie)
    neighbour_face,  // the fan's faces have no area: the normal of a face across their longest
                     // edges
    none_defined,    // no such face either: (0, 0, 1)
};

struct CornerNormals {
    CornerLayer<glm::vec3> normals;   // one value per fan, unit to 1e-7, shared by its corners
    std::vector<glm::dvec3> doubles;  // the values before rounding to float, on request
    struct Fallback {
        std::uint32_t corner;  // the fan's lowest corner
        NormalFallback kind;
    };
    std::vector<Fallback> fallbacks;  // ascending by corner
    std::uint64_t exact_sums = 0;     // fans whose sum doubles could not tell; all if exact
};

// Bounds on a normal's angular error before rounding to float, in radians, wherever the input
// determines a normal (the exact sum is not zero). Rounding to float adds up to 8e-8 (5e-6°).
// Measured by the tests of Stability.
inline constexpr double fast_normal_error = 0x1p-14;      // 3.5e-3°
inline constexpr double accurate_normal_error = 0x1p-36;  // 8.4e-10°
inline constexpr double exact_normal_error = 0x1p-50;     // 5.1e-14°

// Never NaN, always unit. Sums do not depend on the order of faces, vertices or threads: permuting
// the input permutes the output and changes no bit.
//
// Each fan's sum is computed in the cheapest arithmetic whose error bound, evaluated on the fan
// itself, meets the precision's: doubles; where most of the sum cancels, exact rationals (area) or
// 256-bit floats (the other weights, which are not rational), where what is below 2⁻¹⁵⁰ of the
// terms counts as zero. `faces` must come from face_normals of the same or a higher precision.
// O(corners) plus, for the fans that cancel, some microseconds a corner.
Result<CornerNormals> corner_normals(const MeshView& mesh, const Topology& topology,
                                     const FaceNormals& faces, const HardEdges& hard,
                                     const NormalOptions& options = {});

}  // namespace prep
