// What is subdivided: faces, sharp edges and vertices, and the rules, of one channel of a mesh.
//
// Positions are one such cage. Each face-varying channel (a UV set, colours) is another, over the
// same faces, whose vertices are its values: its seams are that cage's borders, and OpenSubdiv's
// face-varying rules are sharp vertices there (face_varying.h).
#pragma once

#include <cstdint>
#include <vector>

#include "prep/subdivide.h"

namespace prep::detail {

inline constexpr float infinitely_sharp = 10;

struct SurfaceCage {
    SubdivisionScheme scheme = SubdivisionScheme::catmark;
    BoundaryRule boundary = BoundaryRule::edge_and_corner;
    CreasingMethod creasing = CreasingMethod::uniform;
    bool smooth_triangles = false;
    // Interpolated linearly: bilinear in quads, linear in the triangles of loop.
    bool linear = false;
    std::uint32_t vertex_count = 0;
    std::vector<std::uint32_t> face_offsets{0};
    std::vector<std::uint32_t> corner_vertices;
    std::vector<EdgeMark> creases;
    std::vector<VertexMark> corners;
    // Per face: no surface, by tags. Holes take part in the rules of their neighbours.
    std::vector<std::uint8_t> holes;
    // Set where a face-varying channel has to be refined as OpenSubdiv's own, by the rules for
    // face-varying values: the mesh it is of, whose cage outlives this one. `creases` and
    // semi-sharp `corners` are those of a cage of its own, for where that costs too much.
    const SurfaceCage* channel_of = nullptr;
    FaceVaryingRule rule = FaceVaryingRule::corners_only;

    std::uint32_t corners_per_face() const { return scheme == SubdivisionScheme::loop ? 3 : 4; }
    std::size_t face_count() const { return face_offsets.size() - 1; }
    std::uint32_t face_size(std::uint32_t face) const {
        return face_offsets[face + 1] - face_offsets[face];
    }
};

// The cage of a mesh's positions. Errors: those that subdivide.h lists for positions, faces and
// tags.
Result<SurfaceCage> position_cage(const Mesh& mesh, const SubdivideOptions& options);

// What the tags say, where the options are silent. Numbers that stand for no rule are errors.
Result<BoundaryRule> boundary_rule(const Mesh& mesh, const SubdivideOptions& options);
Result<FaceVaryingRule> face_varying_rule(const Mesh& mesh, const SubdivideOptions& options);

}  // namespace prep::detail
