#include "sheets/image_diff.h"

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

std::uint32_t colors_of(const prep::Image& image) {
    return image.channels < 3 ? 1 : 3;
}
bool has_alpha(const prep::Image& image) {
    return image.channels % 2 == 0;
}

// The channel of `image` that answers to channel k of the comparison; channels: none, it is 1.
std::uint32_t channel_of(const prep::Image& image, std::uint32_t k, std::uint32_t colors) {
    if (k == colors) return has_alpha(image) ? image.channels - 1 : image.channels;
    return colors_of(image) == 1 ? 0 : k;
}

bool is_integer(const prep::Image& image, std::uint32_t channel) {
    return (image.integer_channels >> channel & 1) != 0;
}

double distance(double u, double v) {
    if (u == v || (std::isnan(u) && std::isnan(v))) return 0;
    const double d = std::abs(u - v);
    return std::isfinite(d) ? d : std::numeric_limits<double>::infinity();
}

struct Pair {
    std::uint32_t a = 0, b = 0;  // channels
    bool integer = false;
};

std::string name_of(const prep::Image& image, std::uint32_t channel) {
    return channel < image.channel_names.size() ? image.channel_names[channel]
                                                : std::to_string(channel + 1);
}

// Which channels are held against each other.
std::vector<Pair> pairs_by_place(const prep::Image& a, const prep::Image& b) {
    const std::uint32_t colors = std::max(colors_of(a), colors_of(b));
    const std::uint32_t channels = colors + (has_alpha(a) || has_alpha(b) ? 1 : 0);
    std::vector<Pair> pairs;
    for (std::uint32_t k = 0; k < channels; ++k)
        pairs.push_back({channel_of(a, k, colors), channel_of(b, k, colors)});
    return pairs;
}

prep::Result<std::vector<Pair>> pairs_by_name(const prep::Image& a, const prep::Image& b) {
    std::vector<Pair> pairs;
    std::string alone;
    for (std::uint32_t i = 0; i < a.channels; ++i) {
        std::uint32_t k = 0;
        while (k < b.channels && name_of(a, i) != name_of(b, k)) ++k;
        if (k < b.channels)
            pairs.push_back({i, k});
        else
            alone = name_of(a, i);
    }
    for (std::uint32_t k = 0; k < b.channels; ++k) {
        const bool met =
            std::any_of(pairs.begin(), pairs.end(), [&](const Pair& p) { return p.b == k; });
        if (!met) alone = name_of(b, k);
    }
    if (!alone.empty())
        return prep::Error{
            prep::ErrorCode::invalid,
            "the pictures differ in their channels: '" + alone + "' is in one of them alone", ""};
    return pairs;
}

}  // namespace

prep::Result<ImageDiff> diff_images(const prep::Image& a, const prep::Image& b) {
    if (a.width != b.width || a.height != b.height)
        return prep::Error{prep::ErrorCode::invalid,
                           "the pictures differ in size: " + std::to_string(a.width) + "×" +
                               std::to_string(a.height) + " against " + std::to_string(b.width) +
                               "×" + std::to_string(b.height),
                           ""};
    prep::Result<std::vector<Pair>> pairs =
        std::max(a.channels, b.channels) > 4 ? pairs_by_name(a, b) : pairs_by_place(a, b);
    if (!pairs) return pairs.error();
    std::uint32_t measured = 0;
    for (Pair& pair : *pairs) {
        pair.integer = is_integer(a, pair.a);
        if (pair.integer != is_integer(b, pair.b))
            return prep::Error{prep::ErrorCode::invalid,
                               "channel '" + name_of(a, pair.a) +
                                   "' holds integers in one picture and numbers of another kind in "
                                   "the other",
                               ""};
        measured += !pair.integer;
    }
    ImageDiff out;
    out.pixels = std::uint64_t(a.width) * a.height;
    out.measured = measured > 0;
    out.heat.width = a.width;
    out.heat.height = a.height;
    out.heat.channels = 3;
    out.heat.srgb = true;
    out.heat.pixels.resize(out.pixels * 3);
    double squares = 0, sum = 0;
    // Of infinite, integer and finite differences, the first that occurs says where to look.
    int worst_rank = 0;
    for (std::uint32_t y = 0; y < a.height; ++y) {
        for (std::uint32_t x = 0; x < a.width; ++x) {
            const std::size_t pixel = std::size_t(y) * a.width + x;
            double worst = 0;
            bool infinite = false, integer = false;
            for (const Pair& pair : *pairs) {
                if (pair.integer) {
                    integer |= a.integers[pixel * a.channels + pair.a] !=
                               b.integers[pixel * b.channels + pair.b];
                    continue;
                }
                const double d = distance(pair.a < a.channels ? a.at(x, y)[pair.a] : 1.0f,
                                          pair.b < b.channels ? b.at(x, y)[pair.b] : 1.0f);
                if (std::isinf(d)) {
                    ++out.infinite;
                    infinite = true;
                    continue;
                }
                squares += d * d;
                sum += d;
                worst = std::max(worst, d);
            }
            out.different += worst > 0 || infinite || integer;
            out.different_integers += integer;
            const int rank = infinite ? 3 : integer ? 2 : worst > 0 ? 1 : 0;
            if (rank > worst_rank || (rank == 1 && worst_rank == 1 && worst > out.largest)) {
                worst_rank = rank;
                out.worst_x = x;
                out.worst_y = y;
            }
            out.largest = std::max(out.largest, worst);
            heat_color(rank > 1 ? 1.0f : heat_of(worst), out.heat.pixels.data() + pixel * 3);
        }
    }
    const double count =
        static_cast<double>(out.pixels) * measured - static_cast<double>(out.infinite);
    if (count > 0) {
        out.rmse = std::sqrt(squares / count);
        out.mean = sum / count;
    }
    out.psnr = out.rmse > 0 ? -20 * std::log10(out.rmse) : std::numeric_limits<double>::infinity();
    return out;
}

}  // namespace report
