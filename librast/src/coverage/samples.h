// Where the samples of a pixel lie.
#pragma once

#include <cstdint>
#include <vector>

namespace rast::detail {

struct SampleOffset {
    std::int32_t x = 0, y = 0;  // from the pixel's centre, in 1/256 pixels
};

// 1, 2, 4, 8 or 16 samples: Direct3D's and Vulkan's standard positions. Other counts: the next
// lower one.
std::vector<SampleOffset> sample_offsets(int samples);

}  // namespace rast::detail
