#include "formats/turned_green.h"

#include <algorithm>
#include <cmath>

namespace prep::detail {

bool is_eight_bit(const Image& image) {
    return std::all_of(image.pixels.begin(), image.pixels.end(), [](float value) {
        return std::abs(value * 255 - std::round(value * 255)) < 1e-3f;  // of a 16-bit step's 1/257
    });
}

Result<std::vector<std::byte>> turned_green_png(Image image) {
    for (std::size_t i = 1; image.channels >= 3 && i < image.pixels.size(); i += image.channels)
        image.pixels[i] = 1 - image.pixels[i];
    const bool wide = image.floating || !is_eight_bit(image);
    return encode_png(image, wide ? PixelType::u16 : PixelType::u8);
}

}  // namespace prep::detail
