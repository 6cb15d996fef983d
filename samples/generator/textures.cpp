#include "textures.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "prep/image.h"
#include "repeatable.h"

namespace samples {
namespace {

float byte_of(double x) {
    return float(std::floor(clamp01(x) * 255 + 0.5) / 255);
}

std::string png(const TextureSize& size, const ColorFunction& texel, bool srgb) {
    prep::Image image;
    image.srgb = srgb;
    image.width = std::uint32_t(size.width);
    image.height = std::uint32_t(size.height);
    image.channels = 3;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const glm::dvec3 c = texel((x + 0.5) / size.width, (y + 0.5) / size.height);
            for (int k = 0; k < 3; ++k) image.pixels.push_back(byte_of(c[k]));
        }
    const auto bytes = prep::encode_png(image);
    if (!bytes) {
        std::fprintf(stderr, "generate_samples: %s\n", prep::to_string(bytes.error()).c_str());
        std::exit(1);
    }
    return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

}  // namespace

std::string normal_map_png(const TextureSize& size, const HeightFunction& height) {
    const double du = 0.5 / size.width, dv = 0.5 / size.height;
    const auto normal = [&](double u, double v) {
        const double x = (height(u - du, v) - height(u + du, v)) / (2 * du * size.metres_wide);
        const double y = (height(u, v + dv) - height(u, v - dv)) / (2 * dv * size.metres_high);
        const double length = std::sqrt(x * x + y * y + 1);
        return glm::dvec3(x / length, y / length, 1 / length) * 0.5 + 0.5;
    };
    return png(size, normal, false);
}

std::string color_png(const TextureSize& size, const ColorFunction& color) {
    return png(size, color, true);
}

}  // namespace samples
