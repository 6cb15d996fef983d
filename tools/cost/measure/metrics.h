// How far results are from the truth: angles, distances, pictures. Plain numbers in, so that
// nothing of what is judged takes part.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace cost {

using Real = long double;
using Vector = glm::vec<3, Real>;

// Degrees between two directions of any length but zero, by atan2(|a × b|, a · b): as exact near 0
// and 180 as between. 180 where one is zero or not finite: it is no direction.
double degrees_between(const Vector& a, const Vector& b);

struct Summary {
    double largest = 0, p999 = 0, mean = 0;
    std::size_t count = 0;
};
// p999: 99.9 % of the values do not exceed it (nearest rank). Not-a-number counts as infinity.
Summary summary_of(std::span<const double> values);

// Linear light, `channels` interleaved values a pixel.
struct Pixels {
    std::uint32_t width = 0, height = 0, channels = 3;
    std::vector<double> values;
};

struct PictureError {
    double rmse = 0, psnr = 0,
           largest = 0;  // psnr: dB for a peak of 1, infinity for equal pictures
    std::size_t pixels = 0;
};
// Over all channels of the pixels in `mask` (empty: all). The pictures are of one size.
PictureError picture_error(const Pixels& picture, const Pixels& truth,
                           const std::vector<bool>& mask = {});

}  // namespace cost
