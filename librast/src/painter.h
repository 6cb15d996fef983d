// Parts of a picture, supersampled and brought to bytes where the plan says so.
#pragma once

#include <string>
#include <vector>

#include "renderer.h"

namespace rast::detail {

class Painter {
  public:
    explicit Painter(const prep::PreparedScene& scene) : plain_(scene), fine_(scene) {}

    void begin(const RenderPlan& plan);  // which must stay while it is drawn
    void draw(const Crop& part, Frame& frame);
    std::vector<std::string> warnings() const;

  private:
    void draw_floats(const Crop& part, Frame& frame);

    const RenderPlan* plan_ = nullptr;
    RenderPlan plain_plan_, fine_plan_;
    bool draws_plain_ = false, draws_fine_ = false;
    Renderer plain_, fine_;
    Frame fine_frame_;
};

}  // namespace rast::detail
