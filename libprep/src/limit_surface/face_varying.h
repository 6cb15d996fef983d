// The cage of a face-varying channel (a UV set, colours): its vertices are the pairs of a vertex
// and a value there, its borders the seams. OpenSubdiv's six rules for face-varying data say which
// of these vertices are infinitely sharp; the rest follows from the rules for vertices: a seam is a
// border, a border a crease, the cage's own creases stay.
//
// Values are one where they are equal: a seam is where values differ, not where a file repeats
// them. Rules: OpenSubdiv's documentation, "Face-varying interpolation rules"; compared with its
// refiner by the tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "limit_surface/refined_cage.h"

namespace prep::detail {

struct FaceVaryingCage {
    SurfaceCage cage;
    // Per vertex of this cage: a corner that has its value.
    std::vector<std::uint32_t> first_corner;
};

// Per corner a number, equal where values are; fewer than corners where a corner has no value, or
// one that is used is not finite. O(values log values).
template <class T>
std::vector<std::uint32_t> corner_classes(const std::vector<T>& values,
                                          const std::vector<std::uint32_t>& indices) {
    constexpr int width = T::length();
    std::vector<std::uint32_t> order, classes(values.size()), corners;
    order.reserve(values.size());
    for (std::uint32_t k = 0; k < values.size(); ++k) {
        bool finite = true;
        for (int d = 0; d < width; ++d) finite &= std::isfinite(values[k][d]);
        if (finite) order.push_back(k);
    }
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        for (int d = 0; d < width; ++d)
            if (values[a][d] != values[b][d]) return values[a][d] < values[b][d];
        return false;
    };
    std::sort(order.begin(), order.end(), less);
    constexpr std::uint32_t none = 0xffffffff;
    std::fill(classes.begin(), classes.end(), none);
    std::uint32_t count = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (k > 0 && less(order[k - 1], order[k])) ++count;
        classes[order[k]] = count;
    }
    corners.reserve(indices.size());
    for (const std::uint32_t index : indices)
        if (index < classes.size() && classes[index] != none) corners.push_back(classes[index]);
    return corners;
}

// `corner_values` as of corner_classes.
FaceVaryingCage face_varying_cage(const SurfaceCage& positions, const RefinedCage& refined,
                                  const std::vector<std::uint32_t>& corner_values,
                                  FaceVaryingRule rule);

}  // namespace prep::detail
