// The cage's own polygons as a surface: plane over each root triangle. The direction is the
// normalised interpolation of unit vectors at the root's corners.
//
// Deviation of the direction n = N/|N|, N linear: for a step d, n'' = −(β² n + 2αβ t)/|N|², where
// N' d = α n + β t with t across n, so |n''| ≤ (2/√3) |N' d|²/|N|². By Taylor's formula at p
// towards the corners v with weights λ, |n − I n| ≤ ½ Σ λ sup|n''(v − p)²|, and Σ λ |N(v) − N(p)|²
// is Σ over pairs λ λ' |N(v) − N(v')|² ≤ ⅓ max |N(v) − N(v')|². Together:
//   |n − I n| ≤ max |N(v) − N(v')|² / (3√3 min |N|²), and never more than 2.
#pragma once

#include <vector>

#include "prep/hard_edges.h"
#include "prep/result.h"
#include "tessellation/domain.h"
#include "tessellation/surface.h"

namespace prep::detail {

class PolygonSurface final : public BaseSurface {
  public:
    // Shading normals are the mesh's own where it has them at all corners, else computed. The mesh
    // and the domain must outlive the surface.
    static Result<PolygonSurface> make(const Mesh& mesh, const Domain& domain,
                                       const HardEdgeOptions& hard_edges, int threads);

    void evaluate(std::span<const RootPoint> at, std::span<BasePoint> points) const override;
    void frames(std::span<const RootPoint> at, std::span<BaseFrame> frames) const override;
    BaseDeviation deviation(std::uint32_t root, const std::array<glm::dvec3, 3>& weights,
                            const std::array<BasePoint, 3>& corners) const override;
    // No coarser, as that takes little time.
    std::optional<BaseDeviation> coarse_deviation(
        std::uint32_t root, const std::array<glm::dvec3, 3>& weights) const override {
        return deviation(root, weights, {});
    }

  private:
    struct Corner {
        glm::dvec3 position{0.0}, direction{0.0}, normal{0.0};
    };
    std::array<Corner, 3> corners(std::uint32_t root) const;

    const Mesh* mesh_ = nullptr;
    const Domain* domain_ = nullptr;
    std::vector<glm::dvec3> directions_;  // per cage vertex
    std::vector<glm::vec3> normals_;      // per corner
    std::vector<Corner> centres_;         // per fan
};

// Bound above for a direction with these values before normalising.
double direction_deviation(const std::array<glm::dvec3, 3>& values);

// Unit, or `otherwise` where the length is not positive and finite.
glm::dvec3 unit_or(const glm::dvec3& vector, const glm::dvec3& otherwise);

}  // namespace prep::detail
