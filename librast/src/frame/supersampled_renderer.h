// Parts of a picture, supersampled and brought to bytes where the plan says so.
#pragma once

#include <string>
#include <vector>

#include "frame/renderer.h"

namespace rast::detail {

class Painter {
  public:
    explicit Painter(const prep::PreparedScene& scene) : plain_(scene), fine_(scene) {}

    void begin(const RenderPlan& plan);  // which must stay while it is drawn
    // As Renderer's.
    void place(const Crop& part);
    void draw_rows(std::uint32_t first, std::uint32_t rows, Frame& frame);
    std::vector<std::string> warnings() const;

  private:
    void draw_floats(std::uint32_t first, std::uint32_t rows, Frame& frame);
    void draw_fine(std::uint32_t first, std::uint32_t rows, Frame& frame);

    const RenderPlan* plan_ = nullptr;
    RenderPlan plain_plan_, fine_plan_;
    bool draws_plain_ = false, draws_fine_ = false;
    Renderer plain_, fine_;
    Crop part_;
    Frame fine_frame_;
    std::vector<glm::vec4> left_over_;  // rows of the finer picture that do not yet make a pixel
};

}  // namespace rast::detail
