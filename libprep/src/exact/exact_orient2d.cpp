#include <CGAL/Exact_rational.h>
#include <CGAL/number_utils.h>

#include "exact/orient2d.h"

namespace prep::detail {

int exact_orient2d(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
    using Rational = CGAL::Exact_rational;
    const Rational ax(a.x), ay(a.y);
    const Rational determinant =
        (Rational(b.x) - ax) * (Rational(c.y) - ay) - (Rational(b.y) - ay) * (Rational(c.x) - ax);
    return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
}

}  // namespace prep::detail
