#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "tessellation/tessellation.h"

namespace prep::detail {

// Triangles in turn, at points of the sequence of Roberts 2018 ("R2"), folded into the triangle.
double measured_error(const DisplacedSurface& surface, const BisectionMesh& mesh,
                      const VertexSamples& vertices, std::uint64_t samples, int threads) {
    const std::uint64_t count = mesh.triangles().size();
    if (count == 0 || samples == 0) return 0;
    constexpr double step_x = 0.7548776662466927, step_y = 0.5698402909980532;
    constexpr std::size_t block = 256;
    std::vector<double> largest((samples + block - 1) / block, 0.0);
    parallel_blocks(samples, block, threads, [&](std::size_t begin, std::size_t end) {
        double& most = largest[begin / block];
        for (std::size_t k = begin; k < end; ++k) {
            const auto t =
                samples < count
                    ? std::uint32_t(std::uint64_t(double(k) / double(samples) * double(count)))
                    : std::uint32_t(k % count);
            double x = std::fmod(0.5 + double(k) * step_x, 1.0);
            double y = std::fmod(0.5 + double(k) * step_y, 1.0);
            if (x + y > 1) x = 1 - x, y = 1 - y;
            const BisectedTriangle& triangle = mesh.triangles()[t];
            const glm::dvec3 w(1 - x - y, x, y);
            const RootPoint at = surface.points(triangle).at(w);
            glm::dvec3 facet(0.0);
            for (int c = 0; c < 3; ++c)
                facet += w[c] * glm::dvec3(vertices[triangle.vertices[std::size_t(c)]].position);
            most = std::max(most, glm::length(surface.truth(at) - facet));
        }
    });
    return *std::max_element(largest.begin(), largest.end());
}

}  // namespace prep::detail
