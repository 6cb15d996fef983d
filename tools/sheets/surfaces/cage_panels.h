// The pictures of what a surface was made from: a cage's edges around the limit surface, and on it;
// those of polygons that were displaced as they are.
#pragma once

#include <vector>

#include "prep/prepare.h"
#include "prep/result.h"
#include "sheets/sheet.h"
#include "sheets/shot.h"

namespace report {

struct CagePanelInput {
    const prep::PreparedScene& scene;      // with its cages
    const std::vector<glm::dmat4>& world;  // of its nodes
    const Shot& shot;                      // to draw on
    const prep::PrepareOptions& prepare;   // what made the surface
    double scale = 1;                      // of lines
    int threads = 0;
};
// Errors: those of LimitSurface::make, of limit_panel().
prep::Result<Panel> polygons_panel(const CagePanelInput& input);
prep::Result<Panel> cage_panel(const CagePanelInput& input);
prep::Result<Panel> limit_panel(const CagePanelInput& input);

// Nodes and points of the cages, or of the meshes without one: a surface lies within its cage, so a
// view that shows these shows everything.
prep::PreparedScene with_cages(const prep::PreparedScene& scene);

}  // namespace report
