#include "normals/triangle_areas.h"

#include <algorithm>
#include <cmath>

#include "base/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/triangle_areas.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Two edges of each triangle in, area vectors and largest products out; `count` is a multiple of
// every vector length.
void cross_products(const float* HWY_RESTRICT edges, std::size_t count, float* HWY_RESTRICT out) {
    const hn::ScalableTag<float> d;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const auto ax = hn::Load(d, edges + i), ay = hn::Load(d, edges + count + i),
                   az = hn::Load(d, edges + 2 * count + i), bx = hn::Load(d, edges + 3 * count + i),
                   by = hn::Load(d, edges + 4 * count + i), bz = hn::Load(d, edges + 5 * count + i);
        const auto largest = [&](auto x, auto y, auto z) {
            return hn::Max(hn::Abs(x), hn::Max(hn::Abs(y), hn::Abs(z)));
        };
        hn::Store(hn::Sub(hn::Mul(ay, bz), hn::Mul(az, by)), d, out + i);
        hn::Store(hn::Sub(hn::Mul(az, bx), hn::Mul(ax, bz)), d, out + count + i);
        hn::Store(hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx)), d, out + 2 * count + i);
        hn::Store(hn::Mul(largest(ax, ay, az), largest(bx, by, bz)), d, out + 3 * count + i);
    }
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

void triangle_areas(std::span<const glm::vec3> positions,
                    std::span<const std::uint32_t> corner_vertices, std::uint32_t first,
                    std::uint32_t last, std::span<glm::dvec3> area_vectors,
                    std::vector<std::uint32_t>& left_over, SimdLevel simd) {
    constexpr std::size_t batch = 64;  // a multiple of every target's vector length in floats
    alignas(64) float edges[6 * batch] = {}, areas[4 * batch];
    const auto cross = SIMD_KERNEL(simd, cross_products);
    for (std::uint32_t start = first; start < last; start += batch) {
        const std::size_t count = std::min<std::size_t>(batch, last - start);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t c = 3 * (start + i);
            const glm::vec3& p = positions[corner_vertices[c]];
            const glm::vec3 a = positions[corner_vertices[c + 1]] - p;
            const glm::vec3 b = positions[corner_vertices[c + 2]] - p;
            for (int k = 0; k < 3; ++k) {
                edges[std::size_t(k) * batch + i] = a[k];
                edges[std::size_t(k + 3) * batch + i] = b[k];
            }
        }
        cross(edges, batch, areas);
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3 area(areas[i], areas[batch + i], areas[2 * batch + i]);
            const float m = areas[3 * batch + i];
            const float size = std::max({std::abs(area.x), std::abs(area.y), std::abs(area.z)});
            // A vector maximum may lose a NaN; but one in an edge reaches two components of the
            // area.
            const bool finite =
                std::isfinite(area.x) && std::isfinite(area.y) && std::isfinite(area.z);
            // The range keeps every product clear of underflow and overflow.
            if (finite && m >= 0x1p-90f && m <= 0x1p120f && size * 16 >= m)
                area_vectors[start + i] = glm::dvec3(area);
            else
                left_over.push_back(std::uint32_t(start + i));
        }
    }
}

}  // namespace prep::detail
#endif
