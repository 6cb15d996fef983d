// The one final step from attributes per corner to vertices: corners at the same source vertex
// whose attributes are all the same bits share a vertex; polygons become triangles; what is split
// says why.
#pragma once

#include "prep/hard_edges.h"
#include "prep/mesh.h"
#include "prep/result.h"

namespace prep {

struct SplitOptions {
    // Faces of different part never share a vertex or a range, as glTF's primitives need it. False:
    // parts are names only, and ranges have none (`no_index`). Materials always stay apart.
    bool parts_apart = true;
    int threads = 0;
};

// `hard` (may be null) tells hard edges from authored normals when a split is labelled; it labels
// only, it never splits by itself. Vertices come out by source vertex, then by first corner.
// Source vertices that only lines or points use are kept; unused ones are dropped. A corner without
// a value in a layer that others have gets (0,0,1) as normal, (1,0,0,1) as tangent, 0 as UV, white
// as colour. NaN values compare by bits. Where a mesh has morph targets or vertex attributes,
// corners of different file vertices never share a vertex. O(corners). Errors: limit.
Result<VertexMesh> split(const Mesh& mesh, const HardEdges* hard = nullptr,
                         const SplitOptions& options = {});

}  // namespace prep
