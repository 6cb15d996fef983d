// What is asked for and changes no bit of a picture, with the proof's figures as reasons; and, of
// lights, what changes it by no more than RenderRequest::allow_error.
//
// A highlight of colour 0, a light that sends 0 and a normal map of (0, 0, 1) are neutral elements:
// the shading kernels would add 0 to sums that are at least 0, or multiply by 1. So that this holds
// of floats too, colours of lights must be finite and not negative, and vectors of ordinary size.
// Distances and angles are compared with a margin that is far above the kernels' rounding.
#pragma once

#include <vector>

#include "plan/drawn_contents.h"
#include "prep/calls/reason.h"
#include "rast/render.h"

namespace rast::detail {

struct ProvedSkips {
    PlanSkips skips;
    // A reason for each light that is not ambient, and for each material that has such a thing.
    std::vector<prep::Reason> lights, highlights, masks, maps;
    std::vector<TexelQuestions> texel_questions;
};

// Why a map that bends normals is proved to bend none.
prep::ReasonCode flat_map_code(prep::MapKind kind);

// Of a plan whose request, view and lights are made. O(1) where nothing comes into question, else
// at most O(vertices): lights are held against 2^24 normals and 8 times the vertices in all, and
// what is left then is not proved.
ProvedSkips prove_skips(const prep::PreparedScene& scene, const RenderPlan& plan,
                        const DrawnContents& drawn);

}  // namespace rast::detail
