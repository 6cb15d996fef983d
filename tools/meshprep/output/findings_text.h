// Findings as lines for people.
#pragma once

#include <string>
#include <vector>

#include "prep/findings.h"
#include "prep/repair.h"

namespace meshprep {

// "  warning  12 × degenerate-face  faces without area (faces 3, 17, 20, …)", aligned, the worst
// first; the mesh is named where there is more than one. Empty for no findings.
std::vector<std::string> findings_text(const std::vector<prep::Finding>& findings,
                                       const std::vector<std::string>& mesh_names,
                                       std::size_t places);

// "faces 3, 17, 20, …".
std::string places_text(const prep::Finding& finding, std::size_t places);

// "  repair  holes  2 changed  1 left  holes were filled (edges 5, 9)", aligned.
std::vector<std::string> repairs_text(const std::vector<prep::RepairStep>& repairs,
                                      const std::vector<std::string>& mesh_names,
                                      std::size_t places);

}  // namespace meshprep
