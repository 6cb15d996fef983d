// Heights beyond the border of a chart, for filters that read around a point.
//
// Across a seam the surface goes on in another chart, or elsewhere in the same one: triangle by
// triangle, laid flat about the edges that they share, until the place is found; there the map is
// read. Where the surface ends, the chart's own heights go on about a plane fitted to those around
// the nearest texel, what is off that plane mirrored; so a slope stays what it is up to the border.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "displacement/height_field.h"

namespace prep::detail {

// A place of the surface.
struct AtlasPoint {
    std::uint32_t triangle = 0;
    glm::dvec3 weights{0.0};  // of the triangle's corners
};

// Where a point of the plane of a half-edge's triangle lies, beyond that edge, when the triangles
// over there are laid into this plane: nothing where the surface ends before, or has no shape.
// `weights`: of the triangle's corners, which add up to 1.
std::optional<AtlasPoint> across_edge(const ChartAtlas& atlas, std::uint32_t half_edge,
                                      const glm::dvec3& weights);

// An edge of a chart's border, and its triangle in the chart's own texel coordinates.
struct ChartBorder {
    std::uint32_t half_edge = 0;
    std::array<glm::dvec2, 3> triangle{};
    int samples = 1;  // along either side, whose mean a texel across is
    const glm::dvec2& begin() const { return triangle[half_edge % 3]; }
    const glm::dvec2& end() const { return triangle[(half_edge + 1) % 3]; }
};

// What the map has there, as a height at this texel of the chart.
using ReadAcross = std::function<double(const glm::dvec2& texel, const AtlasPoint& there)>;

// The plane that fits heights best, by least squares; where they lie in a line, along that alone.
class PlaneFit {
  public:
    void add(const glm::dvec2& at, double height, double weight);
    glm::dvec2 slope() const;

  private:
    double weights_ = 0, heights_ = 0;
    glm::dvec2 places_{0.0}, with_heights_{0.0};
    glm::dmat2 squares_{0.0};
};

// Of a rectangle.
struct ChartTexels {
    std::int64_t width = 0, height = 0;
    std::vector<float> heights;  // row by row
    std::vector<std::uint8_t> covered;
};

// Fills the texels that are not covered, from those that are. `spacing`: in texels, over which
// planes are fitted. Across borders a texel is the mean of `samples` by `samples`.
void continue_chart(ChartTexels& texels, const ChartAtlas& atlas,
                    std::span<const ChartBorder> borders, const ReadAcross& read,
                    const glm::dvec2& spacing, int threads);

}  // namespace prep::detail
