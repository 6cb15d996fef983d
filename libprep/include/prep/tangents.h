// Tangent frames per corner: MikkTSpace (Mikkelsen 2008, "Simulation of Wrinkled Surfaces
// Revisited").
//
// A corner's tangent is the mean of dP/du over its group: the triangles around its vertex (corners
// of equal position, normal and UV) that can be reached over edges and have the same UV
// orientation; weighted by their angles at the vertex, each projected on the plane of the normal.
//
// The bitangent of a corner is w · cross(normal, tangent). With UVs whose origin is at the top
// left, as glTF's, green in a normal map points against +v: the sign is then the opposite of what
// the definition gives for the same numbers. docs/tangents.md shows both.
//
// Cost: O(corners · log(valence)), linear in practice; beside input and output 5 to 10 bytes per
// triangle, 40 for soups, up to 100 for small meshes and for triangles in random order, 115 at
// poles, 140 where most edges are hard (measured; docs/tangents.md). The same bits for any thread
// count and any instruction set.
#pragma once

#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "prep/mesh.h"
#include "prep/result.h"
#include "prep/simd.h"

namespace prep {

enum class TangentMode : std::uint8_t {
    mikktspace,  // the definition's bits where they make a frame, an orthonormal fallback elsewhere
    definition,  // the definition's bits everywhere, its zeros and defaults included
    mikktspace_exact,  // the C reference's bits: as `definition`, but with the reference's search
                       // for neighbours, which can miss some at the last vertex that it sorts
};

enum class UvOrigin : std::uint8_t {
    top_left,     // this project's and glTF's: w is the definition's sign negated
    bottom_left,  // w is the definition's sign
};

struct TangentOptions {
    TangentMode mode = TangentMode::mikktspace;
    UvOrigin uv_origin = UvOrigin::top_left;
    double angular_threshold =
        std::numbers::pi;  // radians, 0 … π; π: only opposite directions are kept apart
    int threads = 0;       // 0: all cores
    SimdLevel simd = SimdLevel::automatic;
};

// What tangents are computed from. Normals and UVs by value and index per corner; a mesh without
// shared vertices has identity indices.
struct TangentInput {
    std::span<const glm::vec3> positions;
    std::span<const std::uint32_t> face_offsets;
    std::span<const std::uint32_t> corner_vertices;
    CornerLayerView<glm::vec3> normals;
    CornerLayerView<glm::vec2> uv;

    TangentInput() = default;
    explicit TangentInput(const MeshView& mesh)
        : positions(mesh.positions),
          face_offsets(mesh.face_offsets),
          corner_vertices(mesh.corner_vertices),
          normals(mesh.normals),
          uv(mesh.uv) {}
};

// Why a corner has another tangent than the definition's.
enum class TangentFault : std::uint8_t {
    not_finite,      // the definition's result is NaN or infinite
    no_normal,       // the normal is zero, absent or not finite: (0, 0, 1) is used
    no_gradient,     // no triangle with a UV gradient reaches the corner: no result at all
    vanished,        // the result is zero (weights of collinear triangles, opposite gradients)
    not_unit,        // or not zero and not unit either
    along_normal,    // it lies along the normal
    not_orthogonal,  // it is off the normal's plane by more than 1e-6
};

// Where the tangent of such a corner comes from: the first of these that gives a direction.
enum class TangentSource : std::uint8_t {
    reprojected,  // the definition's result, projected once more in double
    neighbour,    // a good tangent at the same position, on the corner's plane
    gradient,     // dP/du of the corner's own face, in double, free of scale
    bitangent,    // across dP/dv of the face, where dP/du lies along the normal
    any,          // a perpendicular of the normal
};

struct CornerTangents {
    // w = ±1. Values are shared by the corners of a group.
    CornerLayer<glm::vec4> tangents;
    struct Fallback {
        std::uint32_t corner;
        TangentFault fault;
        TangentSource source;
    };
    std::vector<Fallback> fallbacks;         // ascending by corner; only in mode mikktspace
    std::uint64_t mirrored_triangles = 0;    // of negative UV area (v counted as given)
    std::uint64_t degenerate_triangles = 0;  // with two equal positions
};

// Faces of three and four corners follow the definition; larger ones, which it skips, take part as
// their triangles in mode mikktspace and keep (1, 0, 0) in the others. A corner without a normal or
// UV counts as NaN.
//
// Mode mikktspace makes every tangent unit and orthogonal to its (unit) normal to 1e-6. It departs
// from the definition's bits where those are no frame (listed in `fallbacks`), where normals are
// more than 0.1 % from unit (they are made unit first), and at vertices of more than 1024 triangles
// whose tangents do not all lean one way along an axis (sums in double, of those whose S are within
// the threshold: the definition's would take quadratic time, which the other modes do take there).
//
// Errors: invalid (a layer is absent or of the wrong size, the threshold out of range), limit (more
// than 2^30 triangles).
Result<CornerTangents> corner_tangents(const TangentInput& input,
                                       const TangentOptions& options = {});

// Several UV sets in one pass: result[i] is what corner_tangents gives for input with uv =
// uv_sets[i] (input.uv is not read), bit for bit. What depends on positions alone is done once.
Result<std::vector<CornerTangents>> corner_tangents(
    const TangentInput& input, std::span<const CornerLayerView<glm::vec2>> uv_sets,
    const TangentOptions& options = {});

}  // namespace prep
