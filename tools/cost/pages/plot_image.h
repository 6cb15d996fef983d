// The same plots as pictures, for where no SVG is shown.
#pragma once

#include "cost/pages/plot.h"
#include "prep/image.h"

namespace cost {

// Light, `scale` pixels to a unit of the layout: points, intervals, front, floor, ticks and names
// stand where plot_svg() has them.
prep::Image plot_image(const LadderRecord& ladder, int scale = 2);

}  // namespace cost
