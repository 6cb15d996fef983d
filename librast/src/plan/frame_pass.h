// Passes beside the main one: before it, once a picture (what a light sees), and after it, over
// pixels and their neighbours (what is near in screen space). No effect has one yet: this is the
// form in which requests and plans carry them. A plan knows all of them before it proves anything.
//
// A pass after the main one that looks at pixels up to `radius` beyond its own adds that to the
// plan's halo: crops and bands are then drawn so much wider, in whole rows of tiles, the passes go
// over all of that, and the rest is cut off. Only the picture's own borders are borders to a pass,
// and joined parts are the whole picture, bit for bit. A plan without passes draws no pixel more.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "rast/render.h"

namespace rast::detail {

struct FramePlane {
    std::uint32_t width = 0, height = 0;
    std::vector<float> values;  // row by row
};

struct PassTask {
    const prep::PreparedScene& scene;
    const RenderPlan& plan;
    // After the main pass: what has been drawn, and where in the picture that lies. Colours are
    // floats, none where the plan keeps none; of the buffers, those that some pass reads or the
    // plan keeps.
    Crop part;
    Frame* frame = nullptr;  // null before it
    // By pass of the plan: those of the passes before, and its own. After the main pass they have
    // the part's extent and hold zeros; before it the pass gives them theirs.
    std::vector<std::vector<FramePlane>>& planes;
    std::size_t pass = 0;
};

struct FramePass {
    std::string name;
    bool before = false;       // the main one
    std::uint32_t radius = 0;  // after it: so many pixels beyond its own it looks
    std::uint32_t planes = 0;  // that it fills
    std::uint64_t bytes = 0;   // before the main one: of those planes, for the plan's estimates
    // Buffers that it reads, whether they are kept or not.
    bool reads_depth = false, reads_normals = false, reads_positions = false;
    // The value of a pixel must not depend on the part, but for what lies within the radius.
    std::function<void(const PassTask&)> run;
};

// As the request's last one. What it reads, its halo and its memory are in plans made afterwards.
void add_pass(RenderRequest& request, FramePass pass);

// Whether some pass reads normals, whether they are kept or not.
bool passes_read_normals(const RenderPlan& plan);

// How many pixels beyond a crop or a band the passes look. What a pass makes of pixels in the halo
// is right only as far from its end as it looks: radii of passes that follow each other add up.
std::uint32_t halo_of(const RenderPlan& plan);

}  // namespace rast::detail
