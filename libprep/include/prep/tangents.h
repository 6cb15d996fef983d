// Tangent frames per corner: MikkTSpace (Mikkelsen 2008, "Simulation of Wrinkled Surfaces
// Revisited").
//
// The bitangent of a corner is w · cross(normal, tangent). docs/tangents.md tells the convention of
// the sign against the UV origin.
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
    mikktspace_exact,  // every bit of the C reference, its missed neighbours and zeros included
};

struct TangentOptions {
    TangentMode mode = TangentMode::mikktspace;
    double angular_threshold = std::numbers::pi;  // radians; π: no splitting by angle
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

enum class TangentFallback : std::uint8_t {
    zero,          // the definition gives a zero or non-unit tangent
    along_normal,  // … one parallel to the normal
    non_finite,    // NaN or infinity in the input
    polygon,       // a face that the definition skips (more than four corners)
};

struct CornerTangents {
    CornerLayer<glm::vec4> tangents;  // w = ±1
    struct Fallback {
        std::uint32_t corner;
        TangentFallback kind;
    };
    std::vector<Fallback> fallbacks;  // ascending by corner; empty in mikktspace_exact
    std::uint64_t mirrored_triangles = 0;
};

// Normals must be unit (corner_normals gives such). Errors: invalid (a layer is absent or of the
// wrong size). In mode mikktspace every tangent is unit and orthogonal to its normal to 1e-6.
// O(corners · log(valence)); the same bits for any thread count and instruction set.
Result<CornerTangents> corner_tangents(const TangentInput& input,
                                       const TangentOptions& options = {});

}  // namespace prep
