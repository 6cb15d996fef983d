// Which face of one file is which of another: by where they are, whatever their order.
#pragma once

#include <vector>

#include "judge/material_looks.h"
#include "judge/world_faces.h"

namespace judge {

struct FacePair {
    std::uint32_t a = 0, b = 0;  // in WorldFaces::faces
    std::uint32_t turn = 0;      // corner i of a is corner (i + turn) mod count of b,
    bool reversed = false;       // or (turn − i) mod count, where b runs the other way
    double moved = 0;            // the largest distance between two corners
};

struct Matching {
    std::vector<FacePair> pairs;                // by a
    std::vector<std::uint32_t> left_a, left_b;  // without a partner
    bool complete = true;  // false: too many were near each other, and the search ended early
};

std::uint32_t partner_of(const FacePair& pair, std::uint32_t corner, std::uint32_t count);

// In rounds: faces that are alike in all first, then those in equal places, then those that moved
// by no more than rounding, then by eight times as much each round, up to a twentieth of the box;
// the nearest free face is taken (one whose normals point the other way only where there is no
// other), and of several in one place the one whose attributes and looks are most alike (but for
// skins). Faces that run the other way are matched last, in their place
// only. Deterministic; near O(n log n) where most have a partner in place.
Matching match_faces(const WorldFaces& a, const WorldFaces& b, MaterialLooks& looks);

}  // namespace judge
