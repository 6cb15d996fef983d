#include "displacement/covered_texels.h"

#include <limits>

namespace prep::detail {
namespace {

constexpr double on_border = 1e-9;  // texels: UVs are floats, which are coarser

// Where the triangle meets the row through texels' centres, if it does.
std::pair<double, double> crossing(const MapTriangle& p, double y) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const auto note = [&](double x) {
        low = std::min(low, x);
        high = std::max(high, x);
    };
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 a = p[k], b = p[(k + 1) % 3];
        const auto [top, bottom] = std::minmax(a.y, b.y);
        if (y < top - on_border || y > bottom + on_border) continue;
        if (bottom - top <= 2 * on_border) {
            note(a.x);
            note(b.x);
        } else {
            const double t = std::clamp((y - a.y) / (b.y - a.y), 0.0, 1.0);
            note(a.x + t * (b.x - a.x));
        }
    }
    return {low, high};
}

}  // namespace

bool beyond_end(const MapTriangle& p, glm::length_t k, double end, double side, MapTriangle& line) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    bool any = false;
    const auto note = [&](double at) {
        low = std::min(low, at);
        high = std::max(high, at);
    };
    for (std::size_t c = 0; c < 3; ++c) {
        const glm::dvec2 a = p[c], b = p[(c + 1) % 3];
        const double from = side * (a[k] - end), to = side * (b[k] - end);
        if (from >= 0) note(a[1 - k]);
        any |= from > 0;
        if (std::min(from, to) < 0 && std::max(from, to) > 0)
            note(glm::mix(a[1 - k], b[1 - k], from / (from - to)));
    }
    if (!any) return false;
    line[0][k] = line[1][k] = line[2][k] = end;
    line[0][1 - k] = low;
    line[1][1 - k] = line[2][1 - k] = high;
    return true;
}

std::pair<std::int64_t, std::int64_t> covered_in_row(const MapTriangle& p, std::int64_t y) {
    const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
    if (double(y) < low - on_border || double(y) > high + on_border) return {0, -1};
    const auto [from, to] = crossing(p, double(y));
    return {whole(std::ceil(from - on_border)), whole(std::floor(to + on_border))};
}

}  // namespace prep::detail
