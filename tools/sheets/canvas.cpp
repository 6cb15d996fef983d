#include "sheets/canvas.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sheets/stroke_font.h"

namespace report {
namespace {

// Of pixels: far from what hypot() is for, which takes five times as long.
double length_of(double x, double y) {
    return std::sqrt(x * x + y * y);
}

// Signed distance to a rectangle with round corners, negative inside.
double rounded_distance(double px, double py, const Rect& r, double radius) {
    const double cx = r.x + r.width / 2, cy = r.y + r.height / 2;
    const double qx = std::abs(px - cx) - (r.width / 2 - radius);
    const double qy = std::abs(py - cy) - (r.height / 2 - radius);
    return length_of(std::max(qx, 0.0), std::max(qy, 0.0)) + std::min(std::max(qx, qy), 0.0) -
           radius;
}

double coverage(double signed_distance) {
    return std::clamp(0.5 - signed_distance, 0.0, 1.0);
}

// How a font size becomes pixels: capital letters are size / 1.4 high. Heights of the grid's lines
// are rounded to whole pixels, so that flat strokes are crisp.
class FontScale {
  public:
    explicit FontScale(const TextStyle& style)
        : scale_(style.size / 1.4 / font_capital_height),
          stroke_(std::max(1.0, scale_ * (style.bold ? 2.5 : 1.6))) {
        const double lines[] = {font_descender, 0, font_lower_height, font_capital_height};
        for (int i = 0; i < 4; ++i) {
            grid_[i] = lines[i];
            pixels_[i] = std::round(lines[i] * scale_);
        }
    }
    double x(double grid) const { return grid * scale_; }
    // Upwards from the baseline.
    double y(double grid) const {
        int i = 0;
        while (i < 2 && grid > grid_[i + 1]) ++i;
        const double t = (grid - grid_[i]) / (grid_[i + 1] - grid_[i]);
        return pixels_[i] + t * (pixels_[i + 1] - pixels_[i]);
    }
    double stroke() const { return stroke_; }

  private:
    double scale_, stroke_;
    double grid_[4], pixels_[4];
};

}  // namespace

double distance_to_segment(double px, double py, double x0, double y0, double x1, double y1) {
    const double dx = x1 - x0, dy = y1 - y0;
    const double length2 = dx * dx + dy * dy;
    double t = length2 > 0 ? ((px - x0) * dx + (py - y0) * dy) / length2 : 0;
    t = std::clamp(t, 0.0, 1.0);
    return length_of(px - (x0 + t * dx), py - (y0 + t * dy));
}

PixelBox clipped(double x0, double y0, double x1, double y1, std::uint32_t width,
                 std::uint32_t height) {
    const auto clamp_to = [](double v, std::uint32_t limit) {
        return static_cast<std::int64_t>(std::clamp(v, 0.0, static_cast<double>(limit)));
    };
    return {clamp_to(std::floor(x0), width), clamp_to(std::floor(y0), height),
            clamp_to(std::ceil(x1), width), clamp_to(std::ceil(y1), height)};
}

Canvas::Canvas(std::uint32_t width, std::uint32_t height, Color background) {
    image_.width = width;
    image_.height = height;
    image_.channels = 3;
    image_.srgb = true;
    image_.pixels.resize(std::size_t(width) * height * 3);
    for (std::size_t i = 0; i < image_.pixels.size(); i += 3) {
        image_.pixels[i] = background.r;
        image_.pixels[i + 1] = background.g;
        image_.pixels[i + 2] = background.b;
    }
}

void Canvas::blend(std::int64_t x, std::int64_t y, Color color, double cover) {
    if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
    const float alpha = static_cast<float>(std::clamp(cover, 0.0, 1.0)) * color.a;
    float* p = image_.pixels.data() +
               (static_cast<std::size_t>(y) * image_.width + static_cast<std::size_t>(x)) * 3;
    p[0] += (color.r - p[0]) * alpha;
    p[1] += (color.g - p[1]) * alpha;
    p[2] += (color.b - p[2]) * alpha;
}

void Canvas::fill(const Rect& r, Color color, double radius) {
    const PixelBox box = clipped(r.x, r.y, r.x + r.width, r.y + r.height, width(), height());
    for (std::int64_t y = box.y0; y < box.y1; ++y)
        for (std::int64_t x = box.x0; x < box.x1; ++x)
            blend(x, y, color,
                  coverage(rounded_distance(static_cast<double>(x) + 0.5,
                                            static_cast<double>(y) + 0.5, r, radius)));
}

void Canvas::frame(const Rect& r, Color color, double line_width, double radius) {
    const PixelBox box = clipped(r.x, r.y, r.x + r.width, r.y + r.height, width(), height());
    for (std::int64_t y = box.y0; y < box.y1; ++y) {
        for (std::int64_t x = box.x0; x < box.x1; ++x) {
            const double d = rounded_distance(static_cast<double>(x) + 0.5,
                                              static_cast<double>(y) + 0.5, r, radius);
            blend(x, y, color, coverage(std::abs(d + line_width / 2) - line_width / 2));
        }
    }
}

void Canvas::line(double x0, double y0, double x1, double y1, Color color, double line_width) {
    const double reach = line_width / 2 + 1;
    const PixelBox box =
        clipped(std::min(x0, x1) - reach, std::min(y0, y1) - reach, std::max(x0, x1) + reach,
                std::max(y0, y1) + reach, width(), height());
    for (std::int64_t y = box.y0; y < box.y1; ++y)
        for (std::int64_t x = box.x0; x < box.x1; ++x)
            blend(x, y, color,
                  coverage(distance_to_segment(static_cast<double>(x) + 0.5,
                                               static_cast<double>(y) + 0.5, x0, y0, x1, y1) -
                           line_width / 2));
}

void Canvas::picture(const prep::Image& picture, std::int64_t left, std::int64_t top,
                     double radius) {
    const Rect rect{0, 0, static_cast<double>(picture.width), static_cast<double>(picture.height)};
    for (std::uint32_t y = 0; y < picture.height; ++y) {
        for (std::uint32_t x = 0; x < picture.width; ++x) {
            const float* p = picture.at(x, y);
            Color color{p[0], p[0], p[0], 1};
            if (picture.channels >= 3) color = {p[0], p[1], p[2], 1};
            if (picture.channels == 4) color.a = p[3];
            blend(left + x, top + y, color,
                  radius > 0 ? coverage(rounded_distance(x + 0.5, y + 0.5, rect, radius)) : 1.0);
        }
    }
}

// Each pixel as its nearest stroke covers it, so that strokes that cross are not blended twice.
void Canvas::draw_strokes(std::span<const Stroke> strokes, const PixelBox& box, double half,
                          Color color) {
    const std::int64_t columns = box.x1 - box.x0, rows = box.y1 - box.y0;
    if (columns <= 0 || rows <= 0) return;
    std::vector<double> nearest(static_cast<std::size_t>(columns * rows), 1e9);
    const auto at = [&](std::int64_t x, std::int64_t y) -> double& {
        return nearest[static_cast<std::size_t>((y - box.y0) * columns + x - box.x0)];
    };
    const double reach = half + 1;
    for (const Stroke& line : strokes)
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            const auto [ax, ay] = line[i];
            const auto [bx, by] = line[i + 1];
            const PixelBox around =
                clipped(std::min(ax, bx) - reach, std::min(ay, by) - reach,
                        std::max(ax, bx) + reach, std::max(ay, by) + reach, width(), height());
            for (std::int64_t y = std::max(around.y0, box.y0); y < std::min(around.y1, box.y1); ++y)
                for (std::int64_t x = std::max(around.x0, box.x0); x < std::min(around.x1, box.x1);
                     ++x)
                    at(x, y) = std::min(at(x, y), distance_to_segment(static_cast<double>(x) + 0.5,
                                                                      static_cast<double>(y) + 0.5,
                                                                      ax, ay, bx, by));
        }
    for (std::int64_t y = box.y0; y < box.y1; ++y)
        for (std::int64_t x = box.x0; x < box.x1; ++x)
            if (const double cover = coverage(at(x, y) - half); cover > 0)
                blend(x, y, color, cover);
}

void Canvas::text(double x, double y, std::string_view utf8, const TextStyle& style) {
    if (style.align == Align::center) x -= text_width(utf8, style) / 2;
    if (style.align == Align::right) x -= text_width(utf8, style);
    const FontScale scale(style);
    const double half = scale.stroke() / 2;
    // The strokes' lower rim stands on the baseline, on a whole pixel.
    const double base = std::round(y) - half;
    double pen = x + half;
    while (!utf8.empty()) {
        const Glyph& shape = glyph(next_code_point(utf8));
        double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
        std::vector<Stroke> strokes;
        for (const auto& stroke : shape.strokes) {
            auto& line = strokes.emplace_back();
            for (const GlyphPoint& point : stroke) {
                const double px = pen + scale.x(point.x), py = base - scale.y(point.y);
                line.emplace_back(px, py);
                x0 = std::min(x0, px), x1 = std::max(x1, px);
                y0 = std::min(y0, py), y1 = std::max(y1, py);
            }
        }
        if (!strokes.empty()) {
            const double reach = half + 1;  // no stroke covers anything farther off
            const PixelBox box =
                clipped(x0 - reach, y0 - reach, x1 + reach, y1 + reach, width(), height());
            draw_strokes(strokes, box, half, style.color);
        }
        pen += scale.x(shape.width + font_letter_space);
    }
}

double text_width(std::string_view utf8, const TextStyle& style) {
    if (utf8.empty()) return 0;
    const FontScale scale(style);
    double width = scale.stroke() - scale.x(font_letter_space);
    while (!utf8.empty()) width += scale.x(glyph(next_code_point(utf8)).width + font_letter_space);
    return width;
}

std::string fit_text(std::string_view utf8, double width, const TextStyle& style,
                     bool keep_both_ends) {
    if (text_width(utf8, style) <= width) return std::string(utf8);
    std::vector<std::string_view> letters;
    for (std::string_view rest = utf8; !rest.empty();) {
        const std::string_view before = rest;
        next_code_point(rest);
        letters.push_back(before.substr(0, before.size() - rest.size()));
    }
    for (std::size_t kept = letters.size(); kept-- > 1;) {
        const std::size_t tail = keep_both_ends ? kept / 2 : 0;
        std::string text;
        for (std::size_t i = 0; i < kept - tail; ++i) text += letters[i];
        text += "…";
        for (std::size_t i = letters.size() - tail; i < letters.size(); ++i) text += letters[i];
        if (text_width(text, style) <= width) return text;
    }
    return "…";
}

}  // namespace report
