// What displaces each root of a domain: its height, noise and vectors, and the UVs they are read
// at.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <span>
#include <vector>

#include "prep/displacement/tessellate.h"
#include "prep/result.h"
#include "tessellation/domain.h"
#include "tessellation/surface.h"
#include "tessellation/tangent_frames.h"

namespace prep::detail {

class RootHeights {
  public:
    RootHeights() = default;
    RootHeights(RootHeights&&) = default;
    RootHeights& operator=(RootHeights&&) = default;
    // Errors as tessellate's. The domain and `displacements` must outlive it.
    static Result<RootHeights> make(const Mesh& mesh, const Domain& domain, const BaseSurface& base,
                                    const TessellateOptions& options);

    // The noise of the same roots, without maps and vectors.
    RootHeights noise_alone() const;
    bool has_noise_over_maps() const;

    const Domain& domain() const { return *domain_; }
    const Displacement* of(std::uint32_t root) const {
        const std::uint32_t k = which_.empty() ? no_index : which_[root];
        return k == no_index ? nullptr : &displacements_[k];
    }
    glm::dvec2 uv(const RootPoint& at) const;
    std::array<glm::dvec2, 2> uv_steps(std::uint32_t root) const;
    // What the height function has there; 0 without one.
    double raw(const RootPoint& at) const;
    // With the noise at `position`, the surface's.
    double height(const RootPoint& at, double raw, const glm::dvec3& position) const;
    // As the map has it, and as it moves the surface, whose direction is there `direction`.
    glm::dvec3 map_vector(const RootPoint& at) const;
    glm::dvec3 vector(const RootPoint& at, const glm::dvec3& direction) const;
    // Those that the map of this root is in; null where its vectors are x, y, z.
    const TangentFrames* frames(std::uint32_t root) const {
        const Displacement* displacement = of(root);
        if (!displacement || !displacement->vector || !displacement->tangent_space) return nullptr;
        return &frames_.at(displacement->uv_set);
    }
    TangentFrame frame(const TangentFrames& frames, const RootPoint& at,
                       const glm::dvec3& direction) const {
        return frames.at(domain_->roots[at.root], at.weights, direction);
    }
    // The change of `vector` by a step of the weights (BaseFrame), `steps` of the map's vector.
    glm::dvec3 vector_step(const BaseFrame& base, const RootPoint& at, std::size_t axis,
                           const VectorFunction::Sample& sample) const;

  private:
    const Domain* domain_ = nullptr;
    std::map<std::size_t, TangentFrames> frames_;  // by UV set
    std::span<const Displacement> displacements_;
    std::vector<Displacement> own_;                   // what they are of, of noise_alone()
    std::vector<std::uint32_t> which_;                // per root
    std::vector<std::array<glm::dvec2, 3>> corners_;  // per root
};

}  // namespace prep::detail
