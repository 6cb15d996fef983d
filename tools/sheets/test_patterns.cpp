#include "sheets/test_patterns.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sheets/canvas.h"

namespace report {
namespace {

// Hue in turns, saturation, value (Smith 1978).
Color from_hsv(double hue, double saturation, double value) {
    const auto channel = [&](double n) {
        const double k = std::fmod(n + hue * 6, 6.0);
        return static_cast<float>(value -
                                  value * saturation * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
    };
    return {channel(5), channel(3), channel(1), 1};
}

prep::Result<prep::ImageRef> as_reference(const prep::Image& image, const std::string& name) {
    prep::Result<std::vector<std::byte>> bytes = prep::encode_png(image);
    if (!bytes) return bytes.error();
    prep::ImageRef ref;
    ref.name = name;
    ref.bytes = *std::move(bytes);
    ref.mime_type = "image/png";
    return ref;
}

prep::Result<prep::ImageRef> make_uv_checker() {
    constexpr std::uint32_t cells = 8, cell = 128;
    Canvas canvas(cells * cell, cells * cell, rgb(0xffffff));
    for (std::uint32_t j = 0; j < cells; ++j) {
        for (std::uint32_t i = 0; i < cells; ++i) {
            const bool dark = (i + j) % 2 == 1;
            const double hue = static_cast<double>(i) / cells;
            const Color ground = from_hsv(hue, dark ? 0.55 : 0.16, dark ? 0.62 : 0.97);
            canvas.fill({static_cast<double>(i * cell), static_cast<double>(j * cell), cell, cell},
                        ground);
            const std::string name =
                std::string(1, static_cast<char>('A' + i)) + std::to_string(j + 1);
            TextStyle style;
            style.size = 62;
            style.bold = true;
            style.align = Align::center;
            style.color = dark ? rgb(0xffffff, 0.92f) : from_hsv(hue, 0.6, 0.45);
            canvas.text((i + 0.5) * cell, (j + 0.5) * cell + 22, name, style);
        }
    }
    return as_reference(canvas.image(), "UV checker");
}

prep::Result<prep::ImageRef> make_bump_normal_map() {
    constexpr std::uint32_t size = 512, bumps = 6;
    prep::Image image;
    image.width = image.height = size;
    image.channels = 3;
    image.pixels.resize(std::size_t(size) * size * 3);
    constexpr double cell = static_cast<double>(size) / bumps;
    constexpr double radius = 0.38 * cell;
    // A cap of a sphere that meets the plane at 50°.
    constexpr double rim_sine = 0.766;
    for (std::uint32_t y = 0; y < size; ++y) {
        for (std::uint32_t x = 0; x < size; ++x) {
            const double dx = std::fmod(x + 0.5, cell) - cell / 2;
            const double dy = cell / 2 - std::fmod(y + 0.5, cell);  // up
            double nx = 0, ny = 0;
            if (dx * dx + dy * dy < radius * radius) {
                nx = dx / radius * rim_sine;
                ny = dy / radius * rim_sine;
            }
            const double nz = std::sqrt(1 - nx * nx - ny * ny);
            float* p = image.pixels.data() + (std::size_t(y) * size + x) * 3;
            p[0] = static_cast<float>((nx + 1) / 2);
            p[1] = static_cast<float>((ny + 1) / 2);
            p[2] = static_cast<float>((nz + 1) / 2);
        }
    }
    return as_reference(image, "test pattern");
}

}  // namespace

prep::Result<prep::ImageRef> uv_checker() {
    static const prep::Result<prep::ImageRef> made = make_uv_checker();
    return made;
}

prep::Result<prep::ImageRef> bump_normal_map() {
    static const prep::Result<prep::ImageRef> made = make_bump_normal_map();
    return made;
}

}  // namespace report
