#include "tessellation/screen_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prep::detail {
namespace {

// Of a matrix of two rows: the root of the larger eigenvalue of its products.
double spectral_norm(const glm::dvec3& a, const glm::dvec3& b) {
    const double aa = glm::dot(a, a), bb = glm::dot(b, b), ab = glm::dot(a, b);
    return std::sqrt(0.5 * (aa + bb) + std::hypot(0.5 * (aa - bb), ab));
}

// What roundings of some dozen operations may take from a bound.
constexpr double outward = 1 + 0x1p-40;

}  // namespace

ScreenBound::ScreenBound(const ScreenMetric& metric)
    : w_(metric.w),
      turn_(glm::length(glm::dvec3(metric.w)) * outward),
      near_(metric.near_distance) {
    const glm::dvec3 x(metric.x), y(metric.y), w(metric.w);
    for (const double s : {-1.0, 1.0})
        for (const double t : {-1.0, 1.0})
            scale_ = std::max(scale_, spectral_norm(metric.pixels.x * (x - s * w),
                                                    metric.pixels.y * (y - t * w)));
    scale_ *= outward;
    const auto plane = [](const glm::dvec4& p) {
        return Plane{glm::dvec3(p), p.w, glm::length(glm::dvec3(p)) * outward};
    };
    planes_ = {plane(metric.w + metric.x), plane(metric.w - metric.x), plane(metric.w + metric.y),
               plane(metric.w - metric.y), plane(metric.w - glm::dvec4(0, 0, 0, near_))};
}

double ScreenBound::depth(const std::array<glm::dvec3, 3>& corners) const {
    double least = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& p : corners) least = std::min(least, glm::dot(glm::dvec3(w_), p) + w_.w);
    return std::max(least, near_);
}

double ScreenBound::pixels_per_unit(const std::array<glm::dvec3, 3>& corners, double error) const {
    for (const Plane& plane : planes_) {
        bool outside = true;
        for (const glm::dvec3& p : corners) {
            const double size = glm::length(p) * plane.length + std::abs(plane.offset);
            outside = outside && glm::dot(plane.normal, p) + plane.offset <
                                     -plane.length * error - 0x1p-40 * size;
        }
        if (outside) return 0;
    }
    const double nearest = depth(corners) - turn_ * error;
    return nearest > 0 ? scale_ / nearest * outward : std::numeric_limits<double>::infinity();
}

double ScreenBound::length_of(const std::array<glm::dvec3, 3>& corners, double pixels) const {
    return depth(corners) * pixels / (scale_ + turn_ * pixels);
}

double pixels_per_unit(const std::vector<ScreenBound>& screens,
                       const std::array<glm::dvec3, 3>& corners, double error) {
    double most = 0;
    for (const ScreenBound& screen : screens)
        most = std::max(most, screen.pixels_per_unit(corners, error));
    return most;
}

}  // namespace prep::detail

namespace prep {

ScreenMetric transformed(const ScreenMetric& metric, const glm::dmat4& transform) {
    ScreenMetric out = metric;
    out.x = metric.x * transform;
    out.y = metric.y * transform;
    out.w = metric.w * transform;
    return out;
}

}  // namespace prep
