// The measuring object: a bumpy torus with UVs, of any number of triangles, the same on every run.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prep/mesh.h"

namespace bench {

struct TorusSize {
    std::uint32_t rings = 0, segments = 0;  // triangles = 2 · rings · segments
};

// The size of exactly `triangles` (even) triangles if it has one that is not too oblong, else of a
// few less. 980,000 gives 700 × 700. At least 18 triangles.
TorusSize torus_size(std::uint64_t triangles);

// The points of the bumpy torus of a size, one by one.
class TorusGrid {
  public:
    explicit TorusGrid(const TorusSize& size);
    glm::vec3 position(std::uint32_t ring, std::uint32_t segment) const;
    glm::vec2 uv(std::uint32_t ring, std::uint32_t segment) const;

    // Both triangles of a quad: the corners' steps in rings and segments.
    static constexpr std::array<std::array<std::array<std::uint32_t, 2>, 3>, 2> triangles{
        {{{{0, 0}, {1, 0}, {1, 1}}}, {{{0, 0}, {1, 1}, {0, 1}}}}};

  private:
    TorusSize size_;
    std::vector<double> around_, across_, bump_, wave_, cosine_, sine_;
};

// Radii 1 and 0.4, 24 × 16 bumps of ±6 %. Positions are shared across both seams, UVs are not:
// rings · segments vertices, (rings + 1) · (segments + 1) UVs. Coordinates are multiples of 1e-6.
prep::Mesh bumpy_torus(const TorusSize& size);

}  // namespace bench
