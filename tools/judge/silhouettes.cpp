#include "judge/silhouettes.h"

#include <algorithm>
#include <cmath>

namespace judge {
namespace {

// Sums over any upright rectangle of pixels in four looks.
class RectangleSums {
  public:
    RectangleSums(std::size_t width, std::size_t height, const std::vector<double>& values)
        : stride_(width + 1), sums_((width + 1) * (height + 1)) {
        for (std::size_t y = 0; y < height; ++y) {
            double row = 0;
            for (std::size_t x = 0; x < width; ++x) {
                row += values[y * width + x];
                sums_[(y + 1) * stride_ + x + 1] = sums_[y * stride_ + x + 1] + row;
            }
        }
    }
    double of(std::size_t x0, std::size_t y0, std::size_t x1, std::size_t y1) const {
        return sums_[y1 * stride_ + x1] - sums_[y0 * stride_ + x1] - sums_[y1 * stride_ + x0] +
               sums_[y0 * stride_ + x0];
    }

  private:
    std::size_t stride_;
    std::vector<double> sums_;
};

}  // namespace

OutlineShift outline_shift(const CoverageMap& a, const CoverageMap& b) {
    constexpr double nothing = 1.0 / 64;
    const std::size_t width = a.width, height = a.height;
    std::vector<double> change(width * height), length(width * height);
    const auto slope = [&](const CoverageMap& map, std::size_t x, std::size_t y) {
        // Nothing is covered beyond the picture.
        const auto at = [&](std::size_t i, std::size_t k) {
            return i < width && k < height ? double(map.covered[k * width + i]) : 0.0;
        };
        return 0.5 * std::hypot(at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1));
    };
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t i = y * width + x;
            const double d = std::abs(double(b.covered[i]) - double(a.covered[i]));
            change[i] = d < nothing ? 0 : d;
            length[i] = 0.5 * (slope(a, x, y) + slope(b, x, y));
        }
    const RectangleSums changes(width, height, change), lengths(width, height, length);
    OutlineShift out;
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            if (change[y * width + x] == 0) continue;
            // Outlines that move by much of a square are cut at its corners: then a larger one.
            double shift = 0;
            for (const std::size_t reach : {3, 7, 15}) {
                const std::size_t x0 = x - std::min(x, reach), y0 = y - std::min(y, reach);
                const std::size_t x1 = std::min(x + reach + 1, width),
                                  y1 = std::min(y + reach + 1, height);
                // Less than a pixel of outline is none to divide by.
                shift = changes.of(x0, y0, x1, y1) / std::max(1.0, lengths.of(x0, y0, x1, y1));
                if (shift <= 0.13 * double(reach)) break;
            }
            if (shift > out.pixels) {
                out.pixels = shift;
                out.x = std::uint32_t(x);
                out.y = std::uint32_t(y);
            }
        }
    return out;
}

}  // namespace judge
