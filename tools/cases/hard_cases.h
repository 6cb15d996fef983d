// Meshes on which normals are hard to compute: scales, offsets, aspect ratios, valences, sums that
// cancel. The same on every run.
#pragma once

#include <string>
#include <vector>

#include "prep/mesh.h"

namespace hard_cases {

struct Case {
    std::string axis;  // "scale", "offset", …
    double value;
    prep::Mesh mesh;
};

// With finite positions: scales, offsets, aspect ratios, valences, sums that cancel.
std::vector<Case> measured();

}  // namespace hard_cases
