#include "plan/light_bounds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rast::detail {
namespace {

// Beyond this, products leave float's range sooner or later.
constexpr double ordinary_factor = 1e6;

bool is_factor(double x) {
    return std::abs(x) <= ordinary_factor;  // NaN fails
}
bool are_factors(const glm::dvec3& v) {
    return is_factor(v.x) && is_factor(v.y) && is_factor(v.z);
}

// How metallic and how smooth a point may be. The kernels' metallic_lobe(), at the ends that
// matter.
struct MetallicRange {
    double low = 0, high = 0;  // of metallic
    double peak = 0;           // of the highlight
};
MetallicRange metallic_range(const prep::Material& m, const TexelRange& texels) {
    MetallicRange out;
    const double metallic[] = {m.metallic * texels.low.z, m.metallic * texels.high.z};
    out.low = std::min(metallic[0], metallic[1]);
    out.high = std::max(metallic[0], metallic[1]);
    const double rough[] = {m.roughness * texels.low.y, m.roughness * texels.high.y};
    const double smoothest =
        rough[0] * rough[1] <= 0 ? 0 : std::min(std::abs(rough[0]), std::abs(rough[1]));
    constexpr double least_alpha = 0.02;
    const double alpha = std::max(smoothest * smoothest, least_alpha);
    // Grows with the width, which is at least 2.
    const double width = std::max(2 / (alpha * alpha), 2.0);
    out.peak = width / 8 + 0.5 / width;
    return out;
}

}  // namespace

glm::dvec3 greatest_reflection(const prep::Material& m, const MaterialRanges& ranges) {
    if (m.unlit) return glm::dvec3(0);
    const glm::dvec3 albedo = glm::abs(glm::dvec3(m.diffuse)) * ranges.colors * ranges.diffuse.high;
    const glm::dvec3 mirrored =
        glm::abs(glm::dvec3(m.metallic_roughness ? m.reflectance : m.specular)) *
        ranges.specular.high;
    if (!are_factors(albedo) || !are_factors(mirrored)) return glm::dvec3(HUGE_VAL);
    if (!m.metallic_roughness) return albedo + mirrored;
    const MetallicRange range = metallic_range(m, ranges.metallic_roughness);
    if (!is_factor(range.low) || !is_factor(range.high) || !is_factor(range.peak))
        return glm::dvec3(HUGE_VAL);
    // Both parts are convex in metallic: greatest at an end.
    glm::dvec3 most(0);
    for (const double metallic : {range.low, range.high}) {
        const double rest = std::abs(1 - metallic);
        most = glm::max(
            most, albedo * rest + (mirrored * rest + albedo * std::abs(metallic)) * range.peak);
    }
    return most;
}

double greatest_strength(const LightInstance& light, double distance) {
    if (light.kind == prep::LightKind::directional) return 1;
    if (!(distance > 0)) return HUGE_VAL;
    const double squared = distance * distance;
    double strength = 1 / squared;
    if (light.range > 0) {
        const double ratio = squared / (double(light.range) * double(light.range));
        strength *= std::max(1 - ratio * ratio, 0.0);
    }
    return strength;
}

std::vector<bool> smallest_within(const std::vector<double>& values, double allowed) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    std::vector<bool> out(values.size());
    double sum = 0;
    for (std::size_t k = 0; k + 1 < order.size(); ++k) {
        sum += values[order[k]];
        if (!std::isfinite(sum) || !(sum <= allowed)) break;
        out[order[k]] = true;
    }
    return out;
}

}  // namespace rast::detail
