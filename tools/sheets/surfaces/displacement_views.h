// What stands beside a displaced scene on a sheet: the same relief as light alone shows it.
#pragma once

#include <optional>
#include <string>

#include "prep/prepare.h"
#include "prep/prepared_scene.h"

namespace report {

// Each scene or why there is none.
struct DisplacementViews {
    // The surface as it is without its heights, which are bump maps.
    std::optional<prep::PreparedScene> bumped;
    std::string no_bumped;
    // Displaced with about a thirty-second of the triangles; the rest is in residual normal maps.
    std::optional<prep::PreparedScene> coarse;
    std::string no_coarse;
};

// Of the scene that `displaced` was prepared from with these options, which displace, for pictures
// of `pixels` by `pixels`: residual maps have no more texels than these show. What cannot be
// prepared is not there, and says why.
DisplacementViews make_displacement_views(const prep::Scene& scene,
                                          const prep::PrepareOptions& options,
                                          const prep::PreparedScene& displaced,
                                          std::uint32_t pixels);

// Each with one of its meshes, as mesh_subject() has it.
DisplacementViews views_of_mesh(const DisplacementViews& views, std::uint32_t mesh);

// With bump and normal maps alone, on materials that are otherwise all like `model`; no colours.
// Faces without a material get one.
prep::PreparedScene with_relief_alone(prep::PreparedScene scene, const prep::Material& model);

}  // namespace report
