#include "cost/measure/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cost {

double degrees_between(const Vector& a, const Vector& b) {
    // Scaled by the largest component, so that squares neither overflow nor vanish.
    const auto scaled = [](const Vector& v) {
        const Real most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        return most > 0 && std::isfinite(most) ? v / most : Vector(0);
    };
    const Vector p = scaled(a), q = scaled(b);
    const Vector cross(p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x);
    const Real across = std::sqrt(cross.x * cross.x + cross.y * cross.y + cross.z * cross.z);
    const Real along = p.x * q.x + p.y * q.y + p.z * q.z;
    if (p == Vector(0) || q == Vector(0) || std::isnan(across) || std::isnan(along)) return 180;
    return double(std::atan2(across, along) * 180 / std::numbers::pi_v<Real>);
}

Summary summary_of(std::span<const double> values) {
    Summary s;
    s.count = values.size();
    if (values.empty()) return s;
    std::vector<double> sorted(values.begin(), values.end());
    for (double& v : sorted)
        if (std::isnan(v)) v = std::numeric_limits<double>::infinity();
    std::sort(sorted.begin(), sorted.end());
    Real sum = 0;
    for (const double v : sorted) sum += v;
    s.largest = sorted.back();
    const double rank = std::ceil(0.999 * double(sorted.size()));
    s.p999 = sorted[std::size_t(rank) - 1];
    s.mean = double(sum / Real(sorted.size()));
    return s;
}

PictureError picture_error(const Pixels& picture, const Pixels& truth,
                           const std::vector<bool>& mask) {
    PictureError e;
    Real sum = 0;
    std::size_t count = 0;
    const std::size_t pixels = std::size_t(truth.width) * truth.height;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (!mask.empty() && !mask[i]) continue;
        ++e.pixels;
        for (std::size_t c = 0; c < truth.channels; ++c) {
            const std::size_t at = i * truth.channels + c;
            const double d = std::abs(picture.values[at] - truth.values[at]);
            const double known = std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
            e.largest = std::max(e.largest, known);
            sum += Real(known) * known;
            ++count;
        }
    }
    e.rmse = count > 0 ? double(std::sqrt(sum / Real(count))) : 0;
    e.psnr = e.rmse > 0 ? -20 * std::log10(e.rmse) : std::numeric_limits<double>::infinity();
    return e;
}

}  // namespace cost
