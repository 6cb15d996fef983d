// Hard edges: where shading must not be smooth.
//
// An edge between two faces is hard when the turn between their normals EXCEEDS the threshold (an
// edge exactly at it stays smooth); also at borders, at edges of three or more faces, where
// orientations disagree, at marked edges, at infinitely sharp creases, and on request at UV and
// material borders. Decided exactly: a filter in double, exact rationals where it cannot tell.
//
// Smoothing groups: where a mesh has them, two faces in no common group are hard, and two in a
// common group are smooth whatever their angle, unless `angle_inside_groups` is set.
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "prep/face_normals.h"
#include "prep/mesh.h"
#include "prep/result.h"
#include "prep/topology.h"

namespace prep {

enum HardReason : std::uint8_t {  // bits
    hard_none = 0,
    hard_angle = 1,
    hard_smoothing_group = 2,
    hard_mark = 4,  // marked by hand or an infinitely sharp crease
    hard_uv_border = 8,
    hard_material = 16,
    hard_non_manifold = 32,  // three or more faces, or orientations that disagree
    hard_border = 64,
};

struct HardEdgeOptions {
    // Threshold in degrees, 0 … 180; none: no edge is hard because of its angle. Degrees, because
    // 0, 30, 45, 60, 90 and what they leave of 180 then stand for cosines of exact squares (1, ¾,
    // ½, ¼, 0); any other angle's cosine is rounded to double once and exact from there.
    std::optional<double> angle_degrees = 60.0;
    bool smoothing_groups = true;      // obey them where the mesh has any
    bool angle_inside_groups = false;  // the angle splits also inside a smoothing group
    bool uv_borders = false;
    bool material_borders = false;
    bool marks = true;
    int threads = 0;
};

struct HardEdges {
    std::vector<std::uint8_t> reasons;  // per half-edge: bits of HardReason; alike on both sides
    std::uint64_t hard_count = 0;  // edges (not half-edges) with an interior kind that are hard
    std::uint64_t exact_decisions = 0;  // how often the filter could not tell
};

// Errors: invalid (threshold outside 0 … 180 or not a number). A face of zero area is a slit: it
// uses the normal of the face across its longest edge, so that the faces on its sides are
// compared with each other; where there is none, its edges are smooth as far as the angle goes. A
// face with a position that is not finite counts as missing: its edges are borders. O(edges); the
// same for any order of faces, vertices or threads.
Result<HardEdges> hard_edges(const MeshView& mesh, const Topology& topology,
                             const FaceNormals& faces, const HardEdgeOptions& options = {});

}  // namespace prep
