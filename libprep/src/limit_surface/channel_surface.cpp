#include "limit_surface/channel_surface.h"

#include <algorithm>

namespace prep::detail {

Result<ChannelSurface> ChannelSurface::make(const SurfaceCage& cage,
                                            std::span<const double> numbers, std::uint32_t width,
                                            bool normals, int ring_levels, int threads) {
    Result<RefinedCage> refined = RefinedCage::make(cage);
    if (!refined) return refined.error();
    ChannelSurface surface;
    surface.cage = std::move(*refined);
    Result<PatchTree> tree = PatchTree::make(surface.cage);
    if (!tree) return tree.error();
    surface.tree = std::move(*tree);
    surface.values = surface.cage.refine(numbers, width);
    surface.rings = RingValues(surface.tree, {surface.values.numbers.data(), width, nullptr},
                               ring_levels, normals, most_ring_numbers, threads);
    return surface;
}

PointNormal point_normal(const ChannelSurface& surface, PatchEvaluator& evaluator,
                         std::uint32_t root, double u, double v, const glm::dvec3& du,
                         const glm::dvec3& dv, std::span<const std::uint32_t> face_corners) {
    const glm::dvec3 none(0.0);
    const std::uint32_t width = surface.width();
    std::vector<double> numbers;
    double *value = nullptr, *a = nullptr, *b = nullptr;
    const auto point = [&](double x, double y) {
        if (numbers.empty()) {
            numbers.resize(3 * std::size_t(width));
            value = numbers.data(), a = value + width, b = a + width;
        }
        return evaluator.point(root, x, y, value, a, b);
    };
    // Only corners of roots can be rings' vertices.
    if ((u == 0 || u == 1) && (v == 0 || v == 1) && !surface.tree.is_regular(root)) {
        if (const PointTraits traits = point(u, v); traits.ring != no_index) {
            const RingNormal& normal = surface.rings.normal(traits.ring);
            if (normal.normal != none) return {normal.normal, normal.nearby};
        }
    }
    if (const glm::dvec3 normal = normal_of(du, dv); normal != none) return {normal, false};
    for (const double step : {0x1p-10, 0x1p-6, 0x1p-3}) {
        glm::dvec3 sum(0.0);
        for (const int corner : {0, 1, 2, 3}) {
            const double x = std::clamp(u + (corner & 1 ? step : -step), 0x1p-12, 1 - 0x1p-12);
            const double y = std::clamp(v + (corner & 2 ? step : -step), 0x1p-12, 1 - 0x1p-12);
            point(x, surface.has_triangles() ? std::min(y, std::max(0.0, 1 - x)) : y);
            sum += normal_of(vector_at(a), vector_at(b));
        }
        if (const glm::dvec3 normal = direction_of(sum, 1); normal != none) return {normal, true};
    }
    const glm::dvec3 flat = polygon_normal(face_corners, surface.values.numbers, width);
    if (flat != none) return {flat, true};
    return {glm::dvec3(0, 0, 1), true};
}

glm::dvec3 polygon_normal(std::span<const std::uint32_t> corners, std::span<const double> positions,
                          std::uint32_t width) {
    const auto at = [&](std::size_t c) {
        const double* p = positions.data() + std::size_t(corners[c]) * width;
        return glm::dvec3(p[0], p[1], p[2]);
    };
    glm::dvec3 sum(0.0);
    const glm::dvec3 first = at(0);
    double size = 0;
    for (std::size_t c = 1; c + 1 < corners.size(); ++c) {
        const glm::dvec3 a = at(c) - first, b = at(c + 1) - first;
        sum += glm::cross(a, b);
        size = std::max({size, glm::dot(a, a), glm::dot(b, b)});
    }
    return direction_of(sum, size);
}

}  // namespace prep::detail
