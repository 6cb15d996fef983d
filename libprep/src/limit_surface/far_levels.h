// Levels of OpenSubdiv's refiner copied into plain half-edges: of a mesh, or of one of its
// face-varying channels.
#pragma once

#include <opensubdiv/far/topologyRefiner.h>

#include <cstdint>
#include <vector>

#include "limit_surface/refined_cage.h"

namespace prep::detail {

using FarLevel = OpenSubdiv::OPENSUBDIV_VERSION::Far::TopologyLevel;

RefinedLevel copied_level(const FarLevel& level, int depth, bool triangles);
// Faces of no more levels follow those of this one.
void append(RefinedLevel& level, const RefinedLevel& more);
// The first of a face's children, or no_index where not all are there.
std::uint32_t first_child(const FarLevel& level, int face);

// Per value of a level of channel 0: infinitely sharp, where values of one vertex differ.
using SharpValues = std::vector<std::uint8_t>;
// The values of the next level. New ones on seams are those of a crease, on linear ones too:
// between sharp ends it is straight.
SharpValues sharp_children(const FarLevel& level, const FarLevel& next, const SharpValues& sharp,
                           std::uint32_t corners_per_face);
// Makes the channel's level of the mesh's: its values for vertices, seams for borders.
void take_values(const FarLevel& level, const SharpValues& sharp, RefinedLevel& out);

// Far's sums take for granted that what is smooth has all its faces, refined, around it. Where a
// face uses a vertex twice its sparse refinement can leave some out.
bool can_be_summed(const OpenSubdiv::OPENSUBDIV_VERSION::Far::TopologyRefiner& refiner,
                   bool triangles);

}  // namespace prep::detail
