// Corner normals: the weighted mean of the face normals in a corner's fan, the faces that can be
// reached around its vertex over edges that are not hard.
//
// Weights of a face at a corner (unit face normal n, area A, corner angle α, edges e1, e2):
//   area         A              the default; depends on the triangulation
//   uniform      1              Gouraud 1971
//   angle        α              Thürmer and Wüthrich 1998; independent of the triangulation
//   area_angle   A·α
//   edge_length  sin α/(|e1||e2|)  Max 1999; exact for vertices on a sphere
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

struct NormalOptions {
    NormalWeight weight = NormalWeight::area;
    Precision precision = Precision::accurate;
    int threads = 0;
};

// How a normal was found where the weighted sum is zero or there is nothing to sum.
enum class NormalFallback : std::uint8_t {
    largest_face,  // the sum vanished: the fan's face of the largest area (the greatest vector on a
                   // tie)
    none_defined,  // no face of the fan has a normal: (0, 0, 1)
};

struct CornerNormals {
    CornerLayer<glm::vec3> normals;  // one value per fan, unit to 1e-7, shared by its corners
    struct Fallback {
        std::uint32_t corner;  // the fan's lowest corner
        NormalFallback kind;
    };
    std::vector<Fallback> fallbacks;  // ascending by corner
};

// The sums do not depend on the order of faces, vertices or threads: permuting the input permutes
// the output and changes no bit. Never NaN, always unit. O(corners · log(valence)). Error of
// `accurate` against exact arithmetic: below 1e-9° before the rounding to float.
Result<CornerNormals> corner_normals(const MeshView& mesh, const Topology& topology,
                                     const FaceNormals& faces, const HardEdges& hard,
                                     const NormalOptions& options = {});

}  // namespace prep
