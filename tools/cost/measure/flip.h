// LDR-FLIP: how different two pictures look to someone who flips between them (Andersson, Nilsson,
// Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating
// Images", HPG 2020; section and equation numbers in flip.cpp).
#pragma once

#include <vector>

#include "cost/measure/metrics.h"

namespace cost {

// Pixels to a degree at 0.7 m from a display 0.7 m wide of 3840 pixels, the paper's default.
inline constexpr double usual_pixels_per_degree = 67.0206432765;

struct Flip {
    std::vector<double> errors;  // by pixel, 0 … 1
    double mean = 0, largest = 0;
};

// Of sRGB-encoded pictures of one size with three channels, 0 … 1 (values outside are clamped).
// Equal pictures give exactly 0; the order of the two does not matter. In double, where the
// published program uses float. O(pixels · pixels_per_degree).
Flip flip(const Pixels& reference, const Pixels& test,
          double pixels_per_degree = usual_pixels_per_degree);

// IEC 61966-2-1, clamped to 0 … 1: pictures of linear light as flip() takes them.
Pixels srgb_encoded(const Pixels& linear);

}  // namespace cost
