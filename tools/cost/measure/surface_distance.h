// How far two triangle surfaces are apart: the largest distance from a point of one to the other,
// over vertices, edges and insides, between two bounds that close on each other by branch and bound
// (Tang, Lee and Kim, "Interactive Hausdorff distance computation for general polygonal models",
// 2009, is the idea). Plain numbers in, in double.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace cost {

using Triangle = std::array<glm::dvec3, 3>;

struct DistanceOptions {
    // It ends when the upper bound is no larger than `enough`, or when the bounds are as near to
    // each other as `tolerance` and the lower one is larger than `enough`, where that is over 0.
    double tolerance = 0, enough = 0;
    // At most so many triangles are looked at, pieces of triangles included; and at most so many
    // times one is held against a point, which large triangles in one place take most of.
    std::size_t most_pieces = 2'000'000;
    std::uint64_t most_looks = 150'000'000;
};

// The distance is at least `low`, which is that of `at` (on triangle `triangle` of `from`), and at
// most `high`.
struct SurfaceDistance {
    double low = 0, high = 0;
    glm::dvec3 at{0.0};
    std::uint32_t triangle = 0;
    std::size_t pieces = 0;  // looked at
    bool complete = true;    // false: it ended at one of the limits, its bounds apart
};

// From every point of `from` to the nearest one of `to`, both finite; triangles without area count
// as what they are, segments or points. Of no triangles: 0; to no triangles: infinity. O(n log n)
// to begin with.
SurfaceDistance one_sided_distance(std::span<const Triangle> from, std::span<const Triangle> to,
                                   const DistanceOptions& options = {});

// The point of a triangle that is nearest to `p`.
glm::dvec3 nearest_point(const Triangle& triangle, const glm::dvec3& p);

}  // namespace cost
