#include "sheets/overlay.h"

#include <algorithm>
#include <cmath>

namespace report {

rast::Projected Overlay::projected(const glm::dvec3& point) const {
    return rast::project(shot_.view, shot_.size, shot_.size, point);
}

bool Overlay::is_within(double x, double y) const {
    const auto samples = static_cast<double>(shot_.samples);
    return x >= 0 && y >= 0 && x * samples < static_cast<double>(shot_.frame.width) &&
           y * samples < static_cast<double>(shot_.frame.height);
}

bool Overlay::visible_at(double x, double y, double depth) const {
    if (!is_within(x, y)) return false;
    const auto samples = static_cast<double>(shot_.samples);
    const auto cx = static_cast<std::int64_t>(std::floor(x * samples));
    const auto cy = static_cast<std::int64_t>(std::floor(y * samples));
    const auto width = static_cast<std::int64_t>(shot_.frame.width);
    const auto height = static_cast<std::int64_t>(shot_.frame.height);
    constexpr double tolerance = 0.002;
    for (std::int64_t j = std::max<std::int64_t>(cy - 1, 0); j <= std::min(cy + 1, height - 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(cx - 1, 0); i <= std::min(cx + 1, width - 1);
             ++i) {
            const double surface = shot_.frame.depth[static_cast<std::size_t>(j * width + i)];
            if (depth >= surface * (1 - tolerance)) return true;
        }
    return false;
}

bool Overlay::visible(const glm::dvec3& point) const {
    const rast::Projected p = projected(point);
    return p.visible && visible_at(p.x, p.y, p.depth);
}

double Overlay::pixel_extent(const glm::dvec3& point) const {
    if (!shot_.view.perspective) return 2 * shot_.view.half_height / shot_.size;
    const glm::dvec4 p = shot_.view.world_to_view * glm::dvec4(point, 1.0);
    return 2 * std::abs(p.z) * std::tan(shot_.view.yfov / 2) / shot_.size;
}

Overlay::Layer& Overlay::layer_of(Color color) {
    for (Layer& layer : layers_)
        if (layer.color.r == color.r && layer.color.g == color.g && layer.color.b == color.b &&
            layer.color.a == color.a)
            return layer;
    layers_.push_back({color, std::vector<float>(std::size_t(shot_.size) * shot_.size, 0.0f)});
    return layers_.back();
}

void Overlay::segment(const glm::dvec3& a, const glm::dvec3& b, Color color, double line_width) {
    const rast::Projected p = projected(a), q = projected(b);
    if (!p.visible || !q.visible) return;
    Layer& layer = layer_of(color);
    // Depth is linear on the screen: x, y and depth are stepped together, half a sample at a time.
    const double length = std::max(std::abs(q.x - p.x), std::abs(q.y - p.y));
    const int steps = static_cast<int>(
        std::clamp(std::ceil(length * 2 * shot_.samples), 1.0, 8.0 * shot_.frame.width));
    const auto at = [&](int i) {
        const double t = static_cast<double>(i) / steps;
        return glm::dvec3(p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t,
                          p.depth + (q.depth - p.depth) * t);
    };
    int first = -1;
    for (int i = 0; i <= steps + 1; ++i) {
        const glm::dvec3 s = i <= steps ? at(i) : glm::dvec3(0);
        const bool seen = i <= steps && visible_at(s.x, s.y, s.z);
        if (seen && first < 0) first = i;
        if (!seen && first >= 0) {
            const glm::dvec3 from = at(first), to = at(i - 1);
            draw_run(layer, from.x, from.y, to.x, to.y, line_width);
            first = -1;
        }
    }
}

void Overlay::draw_run(Layer& layer, double x0, double y0, double x1, double y1,
                       double line_width) {
    const double reach = line_width / 2 + 1;
    const PixelBox box =
        clipped(std::min(x0, x1) - reach, std::min(y0, y1) - reach, std::max(x0, x1) + reach,
                std::max(y0, y1) + reach, shot_.size, shot_.size);
    for (std::int64_t y = box.y0; y < box.y1; ++y) {
        for (std::int64_t x = box.x0; x < box.x1; ++x) {
            const double distance = distance_to_segment(
                static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, x0, y0, x1, y1);
            const auto cover = static_cast<float>(
                std::clamp(line_width / 2 + 0.5 - distance, 0.0, std::min(1.0, line_width)));
            float& cell = layer.coverage[static_cast<std::size_t>(y * shot_.size + x)];
            cell = std::max(cell, cover);
        }
    }
}

prep::Image Overlay::image() const {
    prep::Image out = shot_.image;
    for (const Layer& layer : layers_) {
        for (std::size_t i = 0; i < layer.coverage.size(); ++i) {
            const float a = layer.coverage[i] * layer.color.a;
            if (!(a > 0)) continue;
            float* p = out.pixels.data() + i * 4;
            const float total = a + p[3] * (1 - a);
            const float from = p[3] * (1 - a) / total;
            p[0] = layer.color.r * (1 - from) + p[0] * from;
            p[1] = layer.color.g * (1 - from) + p[1] * from;
            p[2] = layer.color.b * (1 - from) + p[2] * from;
            p[3] = total;
        }
    }
    return out;
}

}  // namespace report
