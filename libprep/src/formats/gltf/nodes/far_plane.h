// The far planes of orthographic cameras: glTF has no such camera without one.
#pragma once

#include <cstddef>
#include <vector>

#include "prep/prepared_scene.h"

namespace prep::detail {

class FarPlanes {
  public:
    // O(vertices of all instances) where an orthographic camera has no far plane, else O(cameras).
    // The scene must outlive this.
    explicit FarPlanes(const PreparedScene& prepared);

    // A camera's own; one without is given one behind everything that is drawn, wherever the camera
    // looks. In world units.
    double of(std::size_t camera) const;

  private:
    const Scene& scene_;
    std::vector<glm::dmat4> world_;
    glm::dvec3 low_, high_;  // of what is drawn, where it is needed
};

}  // namespace prep::detail
