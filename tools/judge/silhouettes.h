// How far the outlines of two pictures are apart, in pixels.
#pragma once

#include <cstdint>
#include <vector>

namespace judge {

// What of each pixel is covered, 0 … 1, by rows.
struct CoverageMap {
    std::uint32_t width = 0, height = 0;
    std::vector<float> covered;
};

struct OutlineShift {
    double pixels = 0;
    std::uint32_t x = 0, y = 0;  // where it is largest
};

// Around each pixel whose coverage changes: the area that changed over the outline's length, both
// within a square: of 7 pixels, but of 15, and then 31, where that gives a shift of more than 0.13
// of the square's reach. The length is the integral of the coverage's gradient (the coarea
// formula), the mean of both pictures', which for straight outlines is right; of an outline that
// moved by more than a square is wide only so much is seen. Changes of less than 1/64 of a pixel
// count as none. Of one size. O(pixels).
OutlineShift outline_shift(const CoverageMap& a, const CoverageMap& b);

}  // namespace judge
