#include "coverage/samples.h"

namespace rast::detail {

std::vector<SampleOffset> sample_offsets(int samples) {
    // In sixteenths (Vulkan 1.3, "Multisampling", standard sample locations).
    struct Sixteenths {
        std::int32_t x, y;
    };
    static constexpr Sixteenths two[] = {{4, 4}, {-4, -4}};
    static constexpr Sixteenths four[] = {{-2, -6}, {6, -2}, {-6, 2}, {2, 6}};
    static constexpr Sixteenths eight[] = {{1, -3}, {-1, 3},  {5, 1}, {-3, -5},
                                           {-5, 5}, {-7, -1}, {3, 7}, {7, -7}};
    static constexpr Sixteenths sixteen[] = {{1, 1},  {-1, -3}, {-3, 2}, {4, -1}, {-5, -2}, {2, 5},
                                             {5, 3},  {3, -5},  {-2, 6}, {0, -7}, {-4, -6}, {-6, 4},
                                             {-8, 0}, {7, -4},  {6, 7},  {-7, -8}};
    std::vector<SampleOffset> out;
    const auto take = [&](const Sixteenths* from, int count) {
        for (int k = 0; k < count; ++k) out.push_back({from[k].x * 16, from[k].y * 16});
    };
    if (samples >= 16)
        take(sixteen, 16);
    else if (samples >= 8)
        take(eight, 8);
    else if (samples >= 4)
        take(four, 4);
    else if (samples >= 2)
        take(two, 2);
    else
        out.push_back({0, 0});
    return out;
}

}  // namespace rast::detail
