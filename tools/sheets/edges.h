// Which edges of a prepared mesh the shading breaks at, and why; and where seams and borders run.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/prepare.h"
#include "sheets/canvas.h"

namespace report {

enum class EdgeClass : std::uint8_t {
    smooth,
    angle,            // normals differ: the edge turns by more than the threshold
    smoothing_group,  // … the file's smoothing groups part there
    mark,             // … marked by hand, or an infinitely sharp crease
    material,         // … materials part there, by request
    uv_request,       // … UVs part there, by request
    authored,         // … the file's own normals say so
    cancelled,        // … the face normals around a corner cancel: it took a face's
    apart,            // … the file gives each side vertices of its own, which stay apart
    non_manifold,     // three or more faces
    inconsistent,     // two faces of opposite orientation
    border,           // one face
    uv_seam,          // normals agree, UVs do not
};
inline constexpr int edge_class_count = 13;

struct EdgeClassStyle {  // in legends and tables
    const char* name;
    Color color;
};
const EdgeClassStyle& style_of(EdgeClass kind);

struct ClassedEdge {
    std::uint32_t v0 = 0, v1 = 0;
    EdgeClass kind = EdgeClass::smooth;
};

// Every edge of a mesh once, sorted by its ends, by the first vertex at each point. Equal positions
// are one point, as for check(), unless the options say that they stay apart. An edge breaks the
// shading when the normals of its two sides differ at either end by more than 0.5°. O(edges log
// edges).
std::vector<ClassedEdge> classify_edges(const prep::PreparedScene& prepared, std::uint32_t mesh,
                                        const prep::PrepareOptions& options);

}  // namespace report
