// The true corner normals, for tests and for the stability table: integers where the sum is
// rational, 320-bit floats where it is not. Shares no arithmetic with the product.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prep/corner_normals.h"
#include "prep/mesh.h"

namespace exact {

using Integer = boost::multiprecision::cpp_int;
using Real = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<320, boost::multiprecision::digit_base_2>,
    boost::multiprecision::et_off>;

inline constexpr std::size_t weight_count = 5;  // indexed by NormalWeight

// A weighted sum of face normals, scaled by anything.
struct NormalSum {
    std::array<Real, 3> value{0, 0, 0};
    Real size = 0;  // of the terms' absolute components
    // False where the sum is zero, or for the irrational weights below 2⁻¹⁵⁰ of the terms.
    bool determined = false;
};

class NormalOracle {
  public:
    // Finite positions.
    explicit NormalOracle(const prep::Mesh& mesh);
    // Sums over a fan for every weight; those by angle are left out (not determined) unless
    // `angles`: an arc tangent takes about 0.1 ms.
    std::array<NormalSum, weight_count> sums(std::span<const std::uint32_t> corners,
                                             bool angles) const;

  private:
    using Vector = std::array<Integer, 3>;
    Vector edge(std::uint32_t from, std::uint32_t to) const;  // between corners
    Vector area(std::uint32_t face) const;

    const prep::Mesh& mesh_;
    std::vector<Vector> points_;  // positions times 2^149: any float is an integer then
    std::vector<std::uint32_t> corner_faces_;
};

// The angle in radians between a sum and a vector that need not be unit.
double angle_between(const NormalSum& truth, const glm::dvec3& value);

}  // namespace exact
