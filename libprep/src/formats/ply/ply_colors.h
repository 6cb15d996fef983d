// Colours of PLY's elements: the properties red, green, blue and alpha of vertices and faces.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "formats/ply/ply_header.h"

namespace prep::detail {

class PlyColors {
  public:
    using Row = std::array<double, 4>;  // red, green, blue, alpha

    PlyColors() = default;
    // Of several properties that mean the same the first counts; all are left where one of red,
    // green and blue is missing.
    explicit PlyColors(const PlyElement& element);

    bool any() const { return any_; }
    // 0 … 3, the place in a row of one of the element's properties; nothing where it is not taken.
    std::optional<int> channel(std::size_t property) const {
        return any_ ? channels_[property] : std::nullopt;
    }
    // Linear: integers are sRGB-encoded from 0 to their type's greatest, alpha is not; 1 where
    // there is no alpha.
    glm::vec4 linear(const Row& row) const;

  private:
    bool any_ = false, has_alpha_ = false;
    std::vector<std::optional<int>> channels_;  // by property
    std::array<PlyType, 4> types_{PlyType::f32, PlyType::f32, PlyType::f32, PlyType::f32};
};

}  // namespace prep::detail
