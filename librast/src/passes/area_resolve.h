// The colours of a picture from exact areas: every pixel is the sum of the triangles seen in it,
// each by the area that is seen (a box filter of one pixel), shaded once at that area's centroid.
//
// What it is for: reference pictures, against which sampled ones are held. What it leaves out: the
// colour of one triangle is taken as constant over a pixel, as multisampling takes it (supersample
// where textures or highlights are finer than that); an alpha mask keeps or drops all of a triangle
// in a pixel, by its value at the centroid of their overlap; surfaces are opaque. Corners lie on
// the rasterizer's grid of 1/256 pixels, depths are interpolated in double.
//
// Cost: about a microsecond per triangle and pixel, and the square of the triangles that cross each
// other in a pixel.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "coverage/binning.h"
#include "draws/draw_bindings.h"
#include "passes/tile_renderer.h"

namespace rast::detail {

// What a picture's parts share; all of it must stay meanwhile.
struct CoverageScene {
    const RenderPlan* plan = nullptr;
    const Kernels* kernels = nullptr;
    const std::vector<RenderInstance>* instances = nullptr;
    const std::vector<Draw>* draws = nullptr;
    const std::vector<ShadeDraw>* shade_draws = nullptr;
    const ShadeFrame* shade_frame = nullptr;
    std::vector<CullSide> cull;                                  // per draw
    std::function<PartClock*()> clock = [] { return nullptr; };  // of this thread; null: none
};

// Writes frame.color, which has its size, for the window's pixels. Returns what was shaded. Pixels
// do not depend on the window or on threads.
TileCounts resolve_coverage(const CoverageScene& scene, const Window& window, int threads,
                            Frame& frame);

}  // namespace rast::detail
