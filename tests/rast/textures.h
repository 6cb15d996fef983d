// Textures as tests make them.
#pragma once

#include <random>

#include "shading/texture.h"

namespace test {

inline prep::Image random_image(std::uint32_t width, std::uint32_t height, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    prep::Image image{width, height, 4, {}};
    for (std::uint32_t i = 0; i < width * height * 4; ++i)
        image.pixels.push_back(float(random() % 256) / 255.0f);
    return image;
}

inline rast::MipTexture texture_of(const prep::Image& image, prep::Wrap u, prep::Wrap v,
                                   bool mipped = false, bool colour = false) {
    using rast::TextureLevels;
    prep::Texture sampler;
    sampler.wrap_u = u;
    sampler.wrap_v = v;
    return rast::MipTexture(image, sampler, colour,
                            mipped ? TextureLevels::mipmap : TextureLevels::base);
}

}  // namespace test
