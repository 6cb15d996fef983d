// Meshes that are hard: to compute on (scales, offsets, aspect ratios, valences, sums that cancel),
// and to make sense of (defects of topology, shape and attributes). The same on every run.
#pragma once

#include <string>
#include <vector>

#include "prep/mesh.h"
#include "prep/scene.h"

namespace hard_cases {

struct Case {
    std::string axis;  // "scale", "offset", …
    double value;
    prep::Mesh mesh;
    glm::dmat4 transform{1.0};  // of its node
};

// With finite positions: scales, offsets, aspect ratios, valences, sums that cancel.
std::vector<Case> measured();
// Defects of every kind; positions may be NaN or infinite. Those of UVs have the axis "UVs", those
// of authored normals "normals".
std::vector<Case> odd();

// The mesh with a first UV set, a projection of its positions along the box's z axis; as it is
// where it has one.
prep::Mesh with_uvs(prep::Mesh mesh);
// One scene: the mesh under its transform.
prep::Scene scene_of(const Case& hard_case);

}  // namespace hard_cases
