// Both scenes drawn from the same places: outlines, and how different the pictures look.
#pragma once

#include "judge/judgement.h"

namespace judge {

struct ViewFrame {  // what all views show: a ball
    glm::dvec3 centre{0.0};
    double radius = 1;
    // World units to a pixel of a view, which are without perspective.
    double pixel(std::uint32_t size) const { return 2 * margin * radius / size; }
    static constexpr double margin = 1.05;
};

// Directions spread evenly over the sphere (a spiral of the golden angle), the same for a number.
std::vector<glm::dvec3> view_directions(std::uint32_t count);

// Outlines by exact areas, of all faces, culled or not; FLIP of Phong-shaded pictures with
// textures, at 4 samples a pixel, where `flip` or `options.pictures` asks for it. Errors: those of
// prepare() and plan().
prep::Result<std::vector<ViewJudged>> judged_views(const prep::Scene& a, const prep::Scene& b,
                                                   const ViewFrame& frame, bool flip,
                                                   const JudgeOptions& options);

}  // namespace judge
