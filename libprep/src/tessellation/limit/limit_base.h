// The limit surface of a cage (Catmull–Clark, Loop, or bilinear) as the surface that is displaced,
// along its limit normals.
//
// Parameters: a triangle of Loop's scheme is one (limit_pieces.h). Else a quad's fan is its unit
// square cut by both diagonals. An n-gon's consists of n quads, each with a corner, the middles of
// its edges and the centre: a root (a, b, centre) is half of a's quad and half of b's. Before it is
// halved its deviation is the larger one of its halves', and how far the middle of ab is from where
// it would be if all were linear.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "prep/result.h"
#include "tessellation/domain.h"
#include "tessellation/limit/limit_bounds.h"
#include "tessellation/surface.h"

namespace prep::detail {

class LimitBase final : public BaseSurface {
  public:
    // Errors: those of LimitSurface. The mesh must outlive the surface.
    static Result<LimitBase> make(const Mesh& mesh, const SubdivideOptions& options,
                                  bool has_heights);

    const std::vector<std::uint8_t>& left_out() const { return left_out_; }  // per face
    // The domain, made with left_out(), must outlive the surface.
    void set_domain(const Domain& domain) { domain_ = &domain; }
    void evaluate(std::span<const RootPoint> at, std::span<BasePoint> points) const override;
    void frames(std::span<const RootPoint> at, std::span<BaseFrame> frames) const override;
    BaseDeviation deviation(std::uint32_t root, const std::array<glm::dvec3, 3>& weights,
                            const std::array<BasePoint, 3>& corners) const override;
    std::optional<BaseDeviation> coarse_deviation(
        std::uint32_t root, const std::array<glm::dvec3, 3>& weights) const override;

  private:
    // A root of the patch tree, the parameters' values at the corners a, b and the centre.
    struct Chart {
        std::uint32_t tree_root;
        std::array<glm::dvec2, 3> corners;
        double side = 1;  // of the root
        glm::dvec2 at(const glm::dvec3& weights) const {
            return weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2];
        }
        // Of the patch tree's root.
        glm::dvec2 parameters(const glm::dvec3& weights) const { return at(weights) / side; }
    };
    // Faces have one parameter triangle each.
    bool has_triangles() const { return surface_->has_triangles(); }
    bool is_in_two_halves(std::uint32_t root, const std::array<glm::dvec3, 3>& weights) const;
    // `towards_a`: of an n-gon's two halves.
    Chart chart(std::uint32_t root, bool towards_a) const;
    Chart chart(std::uint32_t root, const std::array<glm::dvec3, 3>& weights) const;
    struct Point {
        glm::dvec3 position, du, dv, normal;
        bool extraordinary, fallback;  // the normal is not that of the derivatives
    };
    struct SecondSteps {
        glm::dvec3 uu{0.0}, uv{0.0}, vv{0.0};
    };
    Point point(PatchEvaluator& evaluator, std::uint32_t root, std::uint32_t tree_root,
                const glm::dvec2& uv, SecondSteps* second = nullptr) const;
    static bool tells_turn(const Point& p);
    // The normal's derivative by u (axis 0) or v, by differences at a point that is farther than
    // those from the piece's sides.
    glm::dvec3 turn_by_differences(PatchEvaluator& evaluator, std::uint32_t root,
                                   std::uint32_t tree_root, const glm::dvec2& uv,
                                   glm::length_t axis) const;

    const Mesh* mesh_ = nullptr;
    const Domain* domain_ = nullptr;
    std::unique_ptr<ChannelSurface> surface_;
    std::unique_ptr<RingCones> cones_;
    std::unique_ptr<CellBounds> cells_;
    std::vector<std::uint8_t> left_out_;
};

}  // namespace prep::detail
