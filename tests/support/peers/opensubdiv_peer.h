// OpenSubdiv beside us: Bfr's limit points at a level of approximation, Far's refined values.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "subdivision_cages.h"

namespace test {

struct PeerErrors {             // the largest of a list of locations
    double position = 0;        // of the diagonal
    double normal_degrees = 0;  // where the oracle has one
};
// In a process of its own: none where that crashed, as Debian's 3.5.0 does on some cages.
std::optional<PeerErrors> bfr_errors(const Cage& cage, const SubdivisionOracle& oracle,
                                     std::span<const SubdivisionOracle::Location> locations,
                                     std::span<const SubdivisionOracle::Limit> limits, int level);

// A UV set of a cage by Far, in double, refined `level` times: the values or their limits, by
// corner of the refined faces, and for finding these corners their control points and cage faces.
struct FarValues {
    std::vector<std::uint32_t> cage_faces;  // of each refined face; holes left out
    std::vector<std::uint32_t> face_offsets{0};
    std::vector<glm::dvec3> corner_points;  // refined, not their limits
    std::vector<glm::dvec2> corner_uvs;     // interpolated, or limits
};
FarValues far_values(const Cage& cage, std::size_t uv_set, prep::FaceVaryingRule rule, int level,
                     bool limit);

}  // namespace test
