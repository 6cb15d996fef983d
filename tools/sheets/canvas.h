// A small drawing surface for report sheets: rectangles, lines, pictures and text, anti-aliased.
//
// Pixels are sRGB-encoded values 0…1, as they are stored in a PNG; blending happens on them, as
// page renderers do. x runs right, y down, pixel (0, 0) covers [0, 1) × [0, 1). Everything is
// clipped to the surface. The same calls give the same bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "prep/image.h"

namespace report {

struct Color {
    float r = 0, g = 0, b = 0, a = 1;
};

// 0xrrggbb.
constexpr Color rgb(std::uint32_t hex, float alpha = 1) {
    return {static_cast<float>((hex >> 16) & 255) / 255, static_cast<float>((hex >> 8) & 255) / 255,
            static_cast<float>(hex & 255) / 255, alpha};
}

struct Rect {
    double x = 0, y = 0, width = 0, height = 0;
};

enum class Align : std::uint8_t { left, center, right };

struct TextStyle {
    double size = 16;  // height of capital letters times 1.4, about what "16 px" means elsewhere
    Color color;
    bool bold = false;
    Align align = Align::left;
};

struct PixelBox {
    std::int64_t x0, y0, x1, y1;  // exclusive ends
};

class Canvas {
  public:
    Canvas(std::uint32_t width, std::uint32_t height, Color background);

    std::uint32_t width() const { return image_.width; }
    std::uint32_t height() const { return image_.height; }

    void fill(const Rect& rect, Color color, double corner_radius = 0);
    // The frame just inside `rect`.
    void frame(const Rect& rect, Color color, double line_width = 1, double corner_radius = 0);
    // With round ends.
    void line(double x0, double y0, double x1, double y1, Color color, double line_width = 1);
    // Copies `picture` (3 or 4 channels, or 1 as grey) with its top left corner at (x, y), corners
    // rounded.
    void picture(const prep::Image& picture, std::int64_t x, std::int64_t y,
                 double corner_radius = 0);
    // One line of UTF-8; `y` is the baseline. Characters that the font has not are drawn as boxes.
    void text(double x, double y, std::string_view utf8, const TextStyle& style);

    const prep::Image& image() const { return image_; }
    void blend(std::int64_t x, std::int64_t y, Color color, double coverage);

  private:
    using Stroke = std::vector<std::pair<double, double>>;
    void draw_strokes(std::span<const Stroke> strokes, const PixelBox& box, double half,
                      Color color);

    prep::Image image_;
};

double distance_to_segment(double px, double py, double x0, double y0, double x1, double y1);
// The pixels that the rectangle from (x0, y0) to (x1, y1) touches, of a surface of that size.
PixelBox clipped(double x0, double y0, double x1, double y1, std::uint32_t width,
                 std::uint32_t height);

// The text's advance width in pixels.
double text_width(std::string_view utf8, const TextStyle& style);

// `utf8`, shortened with … to fit `width`: at its end, or in its middle where both ends of a name
// tell something.
std::string fit_text(std::string_view utf8, double width, const TextStyle& style,
                     bool keep_both_ends = false);

}  // namespace report
