// Lines drawn over a shot, with what lies behind the surface left out.
#pragma once

#include <vector>

#include "sheets/canvas.h"
#include "sheets/shot.h"

namespace report {

// A visible part of a segment is where the segment's depth is not behind the nearest surface within
// one sample by more than 0.2 % of the distance (lines lie on the surface itself). Lines of one
// colour do not add up where they cross. Keeps a reference to the shot.
class Overlay {
  public:
    explicit Overlay(const Shot& shot) : shot_(shot) {}

    void segment(const glm::dvec3& a, const glm::dvec3& b, Color color, double line_width);
    bool is_within(double x, double y) const;  // of the picture, in pixels
    // Whether the surface at this point is what the eye sees there.
    bool visible(const glm::dvec3& point) const;
    rast::Projected projected(const glm::dvec3& point) const;  // in pixels of the picture
    // What a pixel measures in the world at this point.
    double pixel_extent(const glm::dvec3& point) const;

    // The shot's picture with the lines on it.
    prep::Image image() const;

  private:
    struct Layer {
        Color color;
        std::vector<float> coverage;
    };
    bool visible_at(double x, double y, double depth) const;
    void draw_run(Layer& layer, double x0, double y0, double x1, double y1, double line_width);
    Layer& layer_of(Color color);

    const Shot& shot_;
    std::vector<Layer> layers_;  // drawn in this order
};

}  // namespace report
