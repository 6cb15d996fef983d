// Where the origin of a mesh's positions belongs (io.h, set_positions), from coordinates seen one
// by one or in pieces.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace prep::detail {

class PositionBounds {
  public:
    void add(const glm::dvec3& p) {
        const glm::dvec3 zero = p - p;  // not 0 where a coordinate is not finite
        if (!(zero == glm::dvec3(0.0))) return;
        low_ = any_ ? glm::min(low_, p) : p;
        high_ = any_ ? glm::max(high_, p) : p;
        any_ = true;
        float_exact_ = float_exact_ && glm::dvec3(glm::vec3(p)) == p;
    }
    void add(const PositionBounds& other) {
        if (!other.any_) return;
        low_ = any_ ? glm::min(low_, other.low_) : other.low_;
        high_ = any_ ? glm::max(high_, other.high_) : other.high_;
        any_ = true;
        float_exact_ = float_exact_ && other.float_exact_;
    }
    glm::dvec3 origin() const;
    // The same whether or not floats hold the coordinates.
    glm::dvec3 far_origin() const;
    // Whether a reader of text, of which these may be a part, might choose an origin: digits that
    // tell floats apart are then too few, as they are not read as floats.
    bool may_be_far() const;

    double diagonal() const;

  private:
    glm::dvec3 centre() const;
    glm::dvec3 low_{0.0}, high_{0.0};
    bool any_ = false, float_exact_ = true;
};

bool may_be_far(std::span<const glm::vec3> positions);

}  // namespace prep::detail
