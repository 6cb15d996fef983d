// tessellate() in steps, as its tests see them.
#pragma once

#include "prep/displacement/tessellate.h"
#include "tessellation/refinement.h"

namespace prep::detail {

// Where a triangle lies: halvings of a root of the domain, or a pair of them (TrianglePoints).
struct TrianglePlace {
    std::uint64_t path = 1;
    std::uint32_t root = 0;
};

struct TessellationHooks {
    bool share_positions = true;  // false: each side of a shared vertex has its own position
    std::vector<TrianglePlace>* places = nullptr;  // per triangle, where asked for
};
Result<TessellatedMesh> tessellate(const Mesh& cage, const TessellateOptions& options,
                                   const TessellationHooks& hooks);
// The same over any surface; for tests with surfaces of closed form. `options.scheme` is not read.
Result<TessellatedMesh> tessellate(const Mesh& cage, const Domain& domain, const BaseSurface& base,
                                   const TessellateOptions& options,
                                   const TessellationHooks& hooks);

// Mesh, cage_faces and cage_vertices out of the triangles.
TessellatedMesh output_mesh(const Mesh& cage, const Domain& domain, const DisplacedSurface& surface,
                            const Refinement& refinement, const TessellationHooks& hooks,
                            int threads);

}  // namespace prep::detail
