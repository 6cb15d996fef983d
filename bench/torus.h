// The measuring object: a bumpy torus with UVs, of any number of triangles, the same on every run.
#pragma once

#include <cstdint>

#include "prep/mesh.h"

namespace bench {

struct TorusSize {
    std::uint32_t rings = 0, segments = 0;  // triangles = 2 · rings · segments
};

// The size of exactly `triangles` (even) triangles if it has one that is not too oblong, else of a
// few less. 980,000 gives 700 × 700. At least 18 triangles.
TorusSize torus_size(std::uint64_t triangles);

// Radii 1 and 0.4, 24 × 16 bumps of ±6 %. Positions are shared across both seams, UVs are not:
// rings · segments vertices, (rings + 1) · (segments + 1) UVs. Coordinates are multiples of 1e-6.
prep::Mesh bumpy_torus(const TorusSize& size);

}  // namespace bench
