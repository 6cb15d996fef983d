#include "normal_oracle.h"

#include <algorithm>
#include <cmath>

namespace exact {
namespace {

template <class T>
std::array<T, 3> cross(const std::array<T, 3>& a, const std::array<T, 3>& b) {
    return {T(a[1] * b[2] - a[2] * b[1]), T(a[2] * b[0] - a[0] * b[2]),
            T(a[0] * b[1] - a[1] * b[0])};
}
template <class T>
T dot(const std::array<T, 3>& a, const std::array<T, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void add(NormalSum& sum, const std::array<Integer, 3>& v, const Real& scale) {
    for (int k = 0; k < 3; ++k) {
        const Real x = Real(v[k]) * scale;
        sum.value[k] += x;
        sum.size += abs(x);
    }
}

}  // namespace

NormalOracle::NormalOracle(const prep::Mesh& mesh) : mesh_(mesh) {
    for (const glm::vec3& p : mesh.positions) {
        Vector v;
        for (int k = 0; k < 3; ++k) {
            int exponent = 0;
            const double mantissa = std::frexp(double(p[k]), &exponent);
            const int shift = exponent - 24 + 149;
            v[k] = Integer(std::int64_t(std::ldexp(mantissa, 24)));
            if (shift >= 0)
                v[k] <<= shift;
            else
                v[k] /= Integer(1) << -shift;  // a denormal: divides without a rest
        }
        points_.push_back(v);
    }
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            corner_faces_.push_back(f);
}

NormalOracle::Vector NormalOracle::edge(std::uint32_t from, std::uint32_t to) const {
    const Vector& a = points_[mesh_.corner_vertices[from]];
    const Vector& b = points_[mesh_.corner_vertices[to]];
    return {Integer(b[0] - a[0]), Integer(b[1] - a[1]), Integer(b[2] - a[2])};
}

NormalOracle::Vector NormalOracle::area(std::uint32_t face) const {
    const std::uint32_t begin = mesh_.face_offsets[face], end = mesh_.face_offsets[face + 1];
    Vector sum{0, 0, 0};
    for (std::uint32_t c = begin + 1; c + 1 < end; ++c) {
        const Vector term = cross(edge(begin, c), edge(begin, c + 1));
        for (int k = 0; k < 3; ++k) sum[k] += term[k];
    }
    return sum;
}

std::array<NormalSum, weight_count> NormalOracle::sums(std::span<const std::uint32_t> corners,
                                                       bool angles) const {
    using prep::NormalWeight;
    std::array<NormalSum, weight_count> result;
    const auto of = [&](NormalWeight w) -> NormalSum& { return result[std::size_t(w)]; };
    Vector exact_area{0, 0, 0};
    for (const std::uint32_t c : corners) {
        const std::uint32_t face = corner_faces_[c];
        const std::uint32_t begin = mesh_.face_offsets[face], end = mesh_.face_offsets[face + 1];
        const Vector a = area(face);
        const Integer squared = dot(a, a);
        if (squared == 0) continue;
        for (int k = 0; k < 3; ++k) exact_area[k] += a[k];
        const Real inverse = 1 / sqrt(Real(squared));
        add(of(NormalWeight::uniform), a, inverse);
        const Vector e1 = edge(c, c + 1 == end ? begin : c + 1);
        const Vector e2 = edge(c, c == begin ? end - 1 : c - 1);
        const Vector turn = cross(e1, e2);
        const Real sine = sqrt(Real(dot(turn, turn))), cosine = Real(dot(e1, e2));
        const Integer lengths = dot(e1, e1) * dot(e2, e2);
        if (lengths != 0) add(of(NormalWeight::edge_length), a, inverse * sine / Real(lengths));
        if (!angles || (sine == 0 && cosine == 0)) continue;
        Real angle = atan2(sine, cosine);
        if (dot(turn, a) < 0) angle = 2 * boost::math::constants::pi<Real>() - angle;
        add(of(NormalWeight::angle), a, inverse * angle);
        add(of(NormalWeight::area_angle), a, angle);
    }
    add(of(NormalWeight::area), exact_area, 1);
    for (NormalSum& sum : result) {
        const Real largest =
            std::max({Real(abs(sum.value[0])), Real(abs(sum.value[1])), Real(abs(sum.value[2]))});
        sum.determined = largest > ldexp(sum.size, -150);
    }
    return result;
}

double angle_between(const NormalSum& truth, const glm::dvec3& value) {
    const std::array<Real, 3> v{Real(value.x), Real(value.y), Real(value.z)};
    const std::array<Real, 3> c = cross(truth.value, v);
    return Real(atan2(sqrt(dot(c, c)), dot(truth.value, v))).convert_to<double>();
}

}  // namespace exact
