// Which edges of a prepared mesh the shading breaks at, and why; and where seams and borders run.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/prepare.h"

namespace report {

enum class EdgeClass : std::uint8_t {
    smooth,
    angle,            // normals differ: the edge turns by more than the threshold
    smoothing_group,  // … the file's smoothing groups part there
    mark,             // … marked by hand, or an infinitely sharp crease
    material,         // … materials part there, by request
    uv_request,       // … UVs part there, by request
    authored,         // … the file's own normals say so
    non_manifold,     // three or more faces, or orientations that disagree
    border,           // one face
    uv_seam,          // normals agree, UVs do not
};
inline constexpr int edge_class_count = 10;
const char* edge_class_name(EdgeClass kind);

struct ClassedEdge {
    std::uint32_t v0 = 0, v1 = 0;
    EdgeClass kind = EdgeClass::smooth;
};

// Every edge of the mesh once, between points welded by exact position unless `weld` is none,
// sorted by vertices. `mesh` carries its prepared normals; an edge breaks the shading when the
// normals of its two sides differ at either end by more than 0.5°. O(edges log edges). A mesh whose
// topology cannot be had gives plain borders.
std::vector<ClassedEdge> classify_edges(const prep::Mesh& mesh,
                                        const prep::PrepareOptions& options);

}  // namespace report
