// Height maps without the detail that samples of a given spacing cannot carry.
//
// A radial kernel, polynomial in 1 − (r/R)² so that its bits depend on no library: of a sample
// spacing s it passes 98 to 102 % of amplitudes below 1/(4s) cycles a unit and at most 1 % of those
// beyond 1/(2s), whatever their direction. It reads 4 spacings around, on a level of a pyramid that
// has 1 to 2 texels a spacing (2 to 4 along the longer side of maps that are not square). Levels
// are made with a kernel of the same kind along each axis, within 0.75 % (the test
// `BandLimit.ZonePlate` measures both together against the 95 and 2 % that the header promises).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace prep::detail {

struct HeightMapData;

struct BandLimits {
    struct Level {
        std::int64_t width = 0, height = 0;
        std::vector<float> raw;
    };
    std::vector<Level> levels;  // beyond the map itself, the last one a single texel
};

// Of the map's texels and axes alone. The side that is twice the other and longer is halved alone.
// The result does not depend on the number of threads.
BandLimits make_band_limits(const HeightMapData& map, int threads);

// Raw height at a point in map coordinates without what samples `spacing` apart, by the mesh's UVs,
// cannot carry. O(1). Needs the map's axes, its matrix and its texels. `scale`: of a piece of a
// map, its own UVs over those that the matrix makes.
double band_limited(const HeightMapData& map, const BandLimits& bands, const glm::dvec2& point,
                    double spacing, const glm::dvec2& scale = glm::dvec2(1.0));
// The texels of the map between samples so far apart, along either axis: infinite where a spacing
// has no meaning, as the map is placed in a point or a line.
glm::dvec2 texels_between(const HeightMapData& map, double spacing);

}  // namespace prep::detail
