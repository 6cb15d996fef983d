// Tangent frames per corner: MikkTSpace (Mikkelsen 2008, "Simulation of Wrinkled Surfaces
// Revisited").
//
// The bitangent of a corner is w · cross(normal, tangent). With UVs whose origin is at the top
// left, as glTF's, green in a normal map points against +v: the sign is then the opposite of what
// the definition gives for the same numbers. docs/tangents.md shows both.
#pragma once

#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "prep/mesh.h"
#include "prep/result.h"

namespace prep {

enum class TangentMode : std::uint8_t {
    mikktspace,  // the definition's bits where they make a frame, an orthonormal fallback elsewhere
    mikktspace_exact,  // every bit of the definition, its zeros and defaults included
};

enum class UvOrigin : std::uint8_t {
    top_left,     // this project's and glTF's: w is the definition's sign negated
    bottom_left,  // w is the definition's sign
};

struct TangentOptions {
    TangentMode mode = TangentMode::mikktspace;
    UvOrigin uv_origin = UvOrigin::top_left;
    double angular_threshold =
        std::numbers::pi;  // radians, 0 … π; π: next to no splitting by angle
    int threads = 0;
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
enum class TangentFallback : std::uint8_t {
    not_unit,        // it is zero or not unit (or never set): the face's own UV gradient, else any
    along_normal,    // it lies along the normal: likewise
    not_finite,      // NaN or infinity in the input: any perpendicular of the normal
    not_orthogonal,  // off the normal's plane by more than 1e-6: projected once more, in double
};

struct CornerTangents {
    CornerLayer<glm::vec4> tangents;  // w = ±1
    struct Fallback {
        std::uint32_t corner;
        TangentFallback kind;
    };
    std::vector<Fallback> fallbacks;       // ascending by corner; empty in mikktspace_exact
    std::uint64_t mirrored_triangles = 0;  // of negative UV area
};

// Normals must be unit (corner_normals gives such). Faces of three and four corners follow the
// definition; larger ones, which it skips, take part as their triangles in mode mikktspace and keep
// (1,0,0) in mikktspace_exact. In mode mikktspace every tangent is unit and orthogonal to its
// normal to 1e-6 (where the normal is unit). A corner without a normal or UV counts as NaN. Errors:
// invalid (a layer is absent or of the wrong size, the threshold out of range), limit. O(corners ·
// log(valence)); the same bits for any thread count.
Result<CornerTangents> corner_tangents(const TangentInput& input,
                                       const TangentOptions& options = {});

}  // namespace prep
