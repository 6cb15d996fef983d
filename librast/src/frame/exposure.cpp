#include "rast/exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rast {
namespace {

constexpr std::uint32_t greatest_extent = 256;  // of the picture that is looked at
constexpr double highlights = 0.02;             // of the pixels; they may be clipped
constexpr float least_bright = 0.25f, most_bright = 1, aim = 0.8f;

float three_digits(double x) {
    const double unit = std::pow(10.0, std::floor(std::log10(x)) - 2);
    return float(std::round(x / unit) * unit);
}

}  // namespace

prep::Result<FoundExposure> find_exposure(SceneRenderer& renderer, const prep::PreparedScene& scene,
                                          RenderRequest request) {
    const double shrink =
        std::min(1.0, double(greatest_extent) / std::max(request.width, request.height));
    for (std::uint32_t* const extent : {&request.width, &request.height})
        if (*extent > 0) *extent = std::max(1u, std::uint32_t(std::lround(*extent * shrink)));
    request.crop.reset();
    request.samples = request.supersample = 1;
    request.coverage = Coverage::samples;
    request.alpha_alone = false;
    request.pixels = PixelFormat::floats;
    request.keep_color = true;
    request.keep_depth = request.keep_ids = request.keep_normals = request.keep_uvs =
        request.keep_barycentrics = request.keep_positions = false;
    const auto small = plan(scene, request);
    if (!small) return small.error();
    Frame frame;
    if (auto drawn = renderer.render(*small, frame); !drawn) return drawn.error();
    std::vector<float> luminance;
    FoundExposure found;
    for (const glm::vec4& c : frame.color) {
        if (!(c.a > 0)) continue;
        ++found.pixels;
        // Textures of floats may hold what is no number: of no rank.
        const float y = 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
        if (std::isfinite(y)) luminance.push_back(y);
    }
    if (luminance.empty()) return found;
    const auto rank = std::ptrdiff_t((1 - highlights) * double(luminance.size() - 1));
    std::nth_element(luminance.begin(), luminance.begin() + rank, luminance.end());
    found.bright = luminance[std::size_t(rank)];
    const bool fine = found.bright >= least_bright && found.bright <= most_bright;
    if (!fine && found.bright > 0 && std::isfinite(found.bright))
        found.exposure = std::clamp(three_digits(double(aim) / double(found.bright)), 1e-6f, 1e6f);
    return found;
}

void expose(prep::RenderChoices& choices, float exposure) {
    choices.exposure = exposure;
    choices.background /= exposure;
}

}  // namespace rast
