// Parts of a picture that are drawn wider than they are, for the plan's passes that look beyond a
// pixel.
#pragma once

#include <vector>

#include "passes/part_clock.h"
#include "plan/frame_pass.h"

namespace rast::detail {

// What is drawn for a part of the plan's picture: its halo more on all sides, within the picture.
Crop with_halo(const RenderPlan& plan, const Crop& part);

// The rows that are drawn for some of a part's rows: whole rows of tiles of what is drawn for the
// part, the last ones up to its end.
struct RowRange {
    std::uint32_t first = 0, count = 0;
};
RowRange rows_with_halo(const RenderPlan& plan, const Crop& part, const Crop& drawn,
                        std::uint32_t first, std::uint32_t rows);

// The buffers of a part of what was drawn, from this pixel on; those that are not asked for stay
// behind.
void cut_out(const Frame& drawn, std::uint32_t x, std::uint32_t y, const RenderRequest& asked,
             Frame& part);

// Runs the passes of a plan.
class PassRunner {
  public:
    explicit PassRunner(const prep::PreparedScene& scene) : scene_(scene) {}
    // Those before the main one. Planes exist only where a pass of the plan fills them.
    void begin(const RenderPlan& plan);
    // And those after it, over what has been drawn of the picture.
    void finish(const Crop& part, Frame& frame);
    std::uint64_t plane_bytes() const;
    // Adds what the passes took since they were last told of.
    void tell(PartTimes& times) { clock_.tell(0, times); }

  private:
    void run(std::size_t pass, const Crop& part, Frame* frame);

    const prep::PreparedScene& scene_;
    const RenderPlan* plan_ = nullptr;
    PartClock clock_;
    std::vector<std::vector<FramePlane>> planes_;  // by pass
};

}  // namespace rast::detail
