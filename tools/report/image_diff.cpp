#include "report/image_diff.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace report {
namespace {

// From a difference of 0…1: 0 at none, 1/8 at one 8-bit level, 1 at 1.
float heat_of(double difference) {
    return static_cast<float>(std::min(1.0, std::log2(1 + 255 * difference) / 8));
}

void heat_color(float t, float* out) {
    constexpr float stops[5][3] = {
        {0, 0, 0}, {0.15f, 0.25f, 0.85f}, {0.85f, 0.15f, 0.2f}, {1, 0.85f, 0.2f}, {1, 1, 1}};
    const float at = std::clamp(t, 0.0f, 1.0f) * 4;
    const int i = std::min(static_cast<int>(at), 3);
    for (int k = 0; k < 3; ++k)
        out[k] = stops[i][k] + (stops[i + 1][k] - stops[i][k]) * (at - static_cast<float>(i));
}

}  // namespace

prep::Result<ImageDiff> diff_images(const prep::Image& a, const prep::Image& b) {
    if (a.width != b.width || a.height != b.height)
        return prep::Error{prep::ErrorCode::invalid,
                           "the pictures differ in size: " + std::to_string(a.width) + "×" +
                               std::to_string(a.height) + " against " + std::to_string(b.width) +
                               "×" + std::to_string(b.height),
                           ""};
    const auto color_channels = [](const prep::Image& image) {
        return image.channels == 2 ? 1u : std::min(image.channels, 3u);
    };
    std::uint32_t channels = std::min(color_channels(a), color_channels(b));
    if (a.channels == b.channels) channels = a.channels;
    ImageDiff out;
    out.pixels = std::uint64_t(a.width) * a.height;
    out.heat.width = a.width;
    out.heat.height = a.height;
    out.heat.channels = 3;
    out.heat.srgb = true;
    out.heat.pixels.resize(out.pixels * 3);
    double squares = 0, sum = 0;
    for (std::uint32_t y = 0; y < a.height; ++y) {
        for (std::uint32_t x = 0; x < a.width; ++x) {
            double worst = 0;
            for (std::uint32_t k = 0; k < channels; ++k) {
                const double u = a.at(x, y)[k], v = b.at(x, y)[k];
                double d = u == v || (std::isnan(u) && std::isnan(v)) ? 0 : std::abs(u - v);
                if (!std::isfinite(d)) d = 1;
                squares += d * d;
                sum += d;
                worst = std::max(worst, d);
            }
            out.different += worst > 0;
            if (worst > out.largest) {
                out.largest = worst;
                out.worst_x = x;
                out.worst_y = y;
            }
            heat_color(heat_of(worst), out.heat.pixels.data() + (std::size_t(y) * a.width + x) * 3);
        }
    }
    const double count = static_cast<double>(out.pixels) * channels;
    if (count > 0) {
        out.rmse = std::sqrt(squares / count);
        out.mean = sum / count;
    }
    out.psnr = out.rmse > 0 ? -20 * std::log10(out.rmse) : std::numeric_limits<double>::infinity();
    return out;
}

}  // namespace report
