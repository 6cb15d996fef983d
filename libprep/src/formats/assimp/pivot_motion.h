// The motion of a node whose transform is a product: FBX's pivots around animated rotations and
// scales.
#pragma once

#include <optional>
#include <vector>

#include "formats/assimp/key_tracks.h"
#include "prep/scene.h"

namespace prep::detail {

// One factor: its own tracks, or where they are empty what it is at rest.
struct MovingFactor {
    Trs rest;
    VectorTrack translation, scale;
    RotationTrack rotation;
    bool moves() const { return !translation.empty() || !rotation.empty() || !scale.empty(); }
};

struct TrsTracks {
    VectorTrack translation, scale;
    RotationTrack rotation;
};

// The product's own tracks, from the parent's side to the mesh's. Turned about a pivot, a node goes
// along an arc: keys are added until the straight way between them is off by less than 3e-6 of the
// pivots' distances. Empty where the product is no translation, rotation and scale at some key (a
// turn inside a scale that is not uniform).
std::optional<TrsTracks> product_tracks(const std::vector<MovingFactor>& factors,
                                        KeyCounts& counts);

}  // namespace prep::detail
