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
#include <span>
#include <vector>

#include "prep/face_normals.h"
#include "prep/hard_edges.h"
#include "prep/mesh.h"
#include "prep/result.h"
#include "prep/simd.h"
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

// Corner normals with everything they need, in one call.
struct CreaseNormals {
    CornerNormals normals;
    HardEdges hard;
};

// What build_topology(), face_normals(), hard_edges() and corner_normals() give one after the
// other, bit for bit. Triangles whose edges have two faces at most take half of the time: the
// corners of a point are matched among themselves and nothing is stored of the adjacency.
//
// `welded`: weld_exact(), or empty where every vertex is its own point. Threads: options.threads.
// Errors: those of hard_edges(). O(corners).
Result<CreaseNormals> crease_normals(const MeshView& mesh,
                                     std::span<const std::uint32_t> welded = {},
                                     const HardEdgeOptions& hard_options = {},
                                     const NormalOptions& options = {});

// Smooth normals: one per vertex, the area-weighted mean of all faces that use it, whatever their
// edges. For meshes whose vertices are what is to be shaded (scans, terrain, isosurfaces); nothing
// of the adjacency is needed.
struct VertexNormalOptions {
    Precision precision = Precision::accurate;
    int threads = 0;
    SimdLevel simd = SimdLevel::automatic;
};
struct VertexNormals {
    std::vector<glm::vec3> normals;  // one per vertex; (0, 0, 1) where no face uses it
    // One a vertex, as in CornerNormals; a neighbour's face is not looked for.
    std::vector<CornerNormals::Fallback> fallbacks;
    // Vertices that were summed in exact arithmetic. What the work came to, not a property of the
    // surface: another order of faces may change it, threads and instructions do not.
    std::uint64_t exact_sums = 0;
};

// Never NaN, always unit, with the errors above. Accurate and exact normals do not depend on the
// order of faces, vertices or threads, and are corner_normals' wherever all faces at a vertex are
// one fan there. Those of Precision::fast are sums of floats in the order of the triangles: another
// order may change their last bits, but no number of threads nor instruction set does.
//
// Faces of no area, or with a position that is not finite, count nothing; where that leaves a
// vertex nothing, or what is left cancels exactly, `fallbacks` says so.
//
// Triangles are gone through once, in ranges whose sums stay in a cache; a vertex' sum is taken
// where its error bound tells which float the accurate normal is. What is left goes corner by
// corner; and so does everything where it is more than a few, where the mesh has larger faces or no
// order by neighbours. Errors: invalid (face_offsets that do not cover the corners by faces of
// three and more, corners of vertices that are not there). O(corners + vertices), plus microseconds
// a corner where sums are exact. Memory beside what is returned: some 25 bytes a corner and 20 a
// vertex at most, and 7 MB a thread.
Result<VertexNormals> vertex_normals(const MeshView& mesh, const VertexNormalOptions& options = {});

}  // namespace prep
