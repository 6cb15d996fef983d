// How far two pictures are apart.
#pragma once

#include "prep/image.h"
#include "prep/result.h"

namespace report {

struct ImageDiff {
    std::uint64_t pixels = 0, different = 0;  // different: any channel, by any amount
    double rmse = 0, mean = 0, largest = 0;   // of channel values as stored, 0…1 for 8-bit files
    double psnr = 0;                          // dB against 1; infinite where equal
    std::uint32_t worst_x = 0, worst_y = 0;
    // Where: black is equal, then blue, red, yellow and white as the largest channel's difference
    // grows; its logarithm, so that one 8-bit level can be seen.
    prep::Image heat;
};

// Compares the channels that both have (colour; alpha where both have it). NaN against NaN is
// equal, against a number it is a difference of 1. Errors: invalid (sizes differ).
prep::Result<ImageDiff> diff_images(const prep::Image& a, const prep::Image& b);

}  // namespace report
