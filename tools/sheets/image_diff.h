// How far two pictures are apart.
#pragma once

#include "prep/image.h"
#include "prep/result.h"

namespace report {

struct ImageDiff {
    std::uint64_t pixels = 0, different = 0;  // different: any channel, by any amount
    // Finite differences of channel values as stored, 0…1 for 8-bit files, integers left out.
    double rmse = 0, mean = 0, largest = 0;
    double psnr = 0;                         // dB against 1; infinite where equal
    std::uint64_t infinite = 0;              // values infinitely far apart
    bool measured = true;                    // false: all channels are integers
    std::uint64_t different_integers = 0;    // pixels in which an integer differs
    std::uint32_t worst_x = 0, worst_y = 0;  // largest difference: infinite, integer, finite
    // Where: black is equal, then blue, red, yellow and white as the largest channel's difference
    // grows; its logarithm, so that one 8-bit level can be seen.
    prep::Image heat;
};

// Compares all channels; those of pictures of more than four by their names. Alpha counts as 1
// where only the other picture has it, and grey as three equal colours beside colours. Equal
// infinities are equal, as are two NaN; any other value against one of these is infinitely far from
// it. Integers (IDs) are the same or not: they have no distance. Errors: invalid (sizes differ; a
// channel holds integers in one picture alone, or is one's alone).
prep::Result<ImageDiff> diff_images(const prep::Image& a, const prep::Image& b);

}  // namespace report
