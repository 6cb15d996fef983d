#include "exact.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace exact {

double angle_between(const Vector& truth, const glm::dvec3& value) {
    using Real = boost::multiprecision::number<
        boost::multiprecision::cpp_bin_float<300, boost::multiprecision::digit_base_2>,
        boost::multiprecision::et_off>;
    const Vector v = vector(value), c = cross(truth, v);
    const Real sine = sqrt(Real(dot(c, c))), cosine = Real(dot(truth, v));
    return Real(atan2(sine, cosine)).convert_to<double>();
}

}  // namespace exact
