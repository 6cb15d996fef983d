// The displaced surface that a tessellation approximates, once more: the same domain, base and
// heights, so that a triangle's place in it (tessellation.h) leads to the surface's own normals.
#pragma once

#include <memory>

#include "prep/displacement/tessellate.h"
#include "prep/result.h"
#include "tessellation/displaced_surface.h"

namespace prep::detail {

class SurfaceTruth {
  public:
    // As tessellate() with the same arguments; errors are its. The cage must outlive it.
    static Result<std::unique_ptr<const SurfaceTruth>> make(const Mesh& cage,
                                                            TessellateOptions options);
    const DisplacedSurface& surface() const { return *surface_; }

  private:
    TessellateOptions options_;
    Domain domain_;
    std::unique_ptr<const BaseSurface> base_;
    RootHeights heights_;
    std::unique_ptr<const DisplacedSurface> surface_;
};

}  // namespace prep::detail
