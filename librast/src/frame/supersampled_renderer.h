// Parts of a picture, supersampled and brought to bytes where the plan says so.
#pragma once

#include <string>
#include <vector>

#include "frame/halo.h"
#include "frame/renderer.h"

namespace rast::detail {

class Painter {
  public:
    explicit Painter(const prep::PreparedScene& scene)
        : plain_(scene), fine_(scene), passes_(scene) {}

    void begin(const RenderPlan& plan);  // which must stay while it is drawn
    // As Renderer's.
    void place(const Crop& part);
    void draw_rows(std::uint32_t first, std::uint32_t rows, Frame& frame);
    std::vector<std::string> warnings() const;
    // Of the plan's texel_questions; those that will draw its colours keep what was read.
    std::vector<TexelFacts> texel_facts(const RenderPlan& plan) {
        const RenderRequest& r = plan.request;
        return (r.supersample > 1 && r.keep_color ? fine_ : plain_).texel_facts(plan);
    }

  private:
    void draw_floats(std::uint32_t first, std::uint32_t rows, Frame& frame);
    void draw_fine(std::uint32_t first, std::uint32_t rows, Frame& frame);
    void draw_for_passes(std::uint32_t first, std::uint32_t rows, Frame& frame);

    const RenderPlan* plan_ = nullptr;
    RenderPlan plain_plan_, fine_plan_;
    bool draws_plain_ = false, draws_fine_ = false;
    Renderer plain_, fine_;
    PassRunner passes_;
    PartClock clock_;
    Crop part_, drawn_;  // what is asked for, and that with the plan's halo
    Frame fine_frame_, wide_frame_;
    std::vector<glm::vec4> left_over_;  // rows of the finer picture that do not yet make a pixel
};

}  // namespace rast::detail
