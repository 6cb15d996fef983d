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
      steepness_(glm::length(glm::dvec3(metric.w)) * outward),
      near_(metric.near_distance) {
    const glm::dvec3 x(metric.x), y(metric.y), w(metric.w);
    for (const double s : {-1.0, 1.0})
        for (const double t : {-1.0, 1.0})
            scale_ = std::max(scale_, spectral_norm(metric.pixels.x * (x - s * w),
                                                    metric.pixels.y * (y - t * w)));
    scale_ *= outward;
    const auto plane = [&](const glm::dvec4& other) {
        const glm::dvec4 p = metric.w + other;
        return Plane{glm::dvec3(p), p.w, glm::length(glm::dvec3(p)) * outward,
                     glm::length(w) + glm::length(glm::dvec3(other)),
                     std::abs(metric.w.w) + std::abs(other.w)};
    };
    planes_ = {plane(metric.x), plane(-metric.x), plane(metric.y), plane(-metric.y),
               plane(glm::dvec4(0, 0, 0, -near_))};
}

double ScreenBound::depth(const std::array<glm::dvec3, 3>& corners) const {
    double least = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& p : corners) {
        const double size = steepness_ * glm::length(p) + std::abs(w_.w);
        least = std::min(least, glm::dot(glm::dvec3(w_), p) + w_.w - 0x1p-48 * size);
    }
    return std::max(least, near_);
}

double ScreenBound::pixels_per_unit(const std::array<glm::dvec3, 3>& corners, double error) const {
    for (const Plane& plane : planes_) {
        bool outside = true;
        // One that is level everywhere is as far from errors of any size.
        const double reach = plane.length > 0 ? plane.length * error : 0;
        for (const glm::dvec3& p : corners) {
            const double size = glm::length(p) * plane.slope_size + plane.offset_size;
            outside = outside && glm::dot(plane.normal, p) + plane.offset < -reach - 0x1p-40 * size;
        }
        if (outside) return 0;
    }
    const double nearest = depth(corners) - (steepness_ > 0 ? steepness_ * error : 0);
    return nearest > 0 ? scale_ / nearest * outward : std::numeric_limits<double>::infinity();
}

double ScreenBound::length_of(const std::array<glm::dvec3, 3>& corners, double pixels) const {
    return depth(corners) * pixels / (scale_ + steepness_ * pixels) / outward;
}

ScreenBound::Sight ScreenBound::sight(const std::array<glm::dvec3, 8>& box) const {
    constexpr double slack = 0x1p-36;  // more than triangles have
    Sight sight{.sees = true};
    for (const Plane& plane : planes_) {
        bool outside = true;
        for (const glm::dvec3& p : box) {
            const double size = glm::length(p) * plane.slope_size + plane.offset_size;
            const double at = glm::dot(plane.normal, p) + plane.offset;
            outside = outside && at < -slack * size;
            sight.sees = sight.sees && at > slack * size;
        }
        sight.misses = sight.misses || outside;
    }
    double nearest = std::numeric_limits<double>::infinity(), farthest = near_;
    for (const glm::dvec3& p : box) {
        const double size = steepness_ * glm::length(p) + std::abs(w_.w);
        const double at = glm::dot(glm::dvec3(w_), p) + w_.w;
        nearest = std::min(nearest, at - slack * size);
        farthest = std::max(farthest, at + slack * size);
    }
    const glm::dvec2 both(scale_, steepness_);
    sight.least = both / farthest / outward;
    sight.most = both / std::max(nearest, near_) * outward;
    return sight;
}

Screens::Screens(const std::vector<ScreenMetric>& metrics) {
    all_.reserve(metrics.size());
    for (const ScreenMetric& metric : metrics) all_.emplace_back(metric);
}

void Screens::focus(const glm::dvec3& low, const glm::dvec3& high) {
    low_ = low;
    high_ = high;
    std::array<glm::dvec3, 8> box;
    for (std::size_t k = 0; k < 8; ++k)
        box[k] = {k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z};
    std::vector<ScreenBound::Sight> sights;
    sights.reserve(all_.size());
    std::size_t first = all_.size();  // the one that decides most
    for (const ScreenBound& screen : all_) {
        const ScreenBound::Sight& sight = sights.emplace_back(screen.sight(box));
        if (sight.sees && (first == all_.size() || sight.least.x > sights[first].least.x))
            first = sights.size() - 1;
    }
    few_.clear();
    for (std::size_t k = 0; k < all_.size(); ++k) {
        if (sights[k].misses) continue;
        const bool second = first < all_.size() && k != first &&
                            sights[k].most.x <= sights[first].least.x &&
                            sights[k].most.y <= sights[first].least.y;
        if (!second) few_.push_back(all_[k]);
    }
}

std::span<const ScreenBound> Screens::around(const std::array<glm::dvec3, 3>& corners,
                                             double error) const {
    for (const glm::dvec3& p : corners)
        for (glm::length_t k = 0; k < 3; ++k)
            if (!(p[k] - error >= low_[k] && p[k] + error <= high_[k])) return all_;
    return few_;
}

double pixels_per_unit(std::span<const ScreenBound> screens,
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
