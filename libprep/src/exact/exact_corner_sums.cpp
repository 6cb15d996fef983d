#include "exact/exact_corner_sums.h"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <unordered_map>
#include <vector>

#include "exact/exact_normals.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
using Real = boost::multiprecision::number<
    boost::multiprecision::cpp_bin_float<256, boost::multiprecision::digit_base_2>,
    boost::multiprecision::et_off>;

struct Vector {
    Real x, y, z;
};

Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vector operator*(const Vector& a, const Real& s) {
    return {a.x * s, a.y * s, a.z * s};
}
Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
void add(Vector& to, const Vector& v) {
    to.x += v.x;
    to.y += v.y;
    to.z += v.z;
}

}  // namespace

class ExactCornerSums::Sums {
  public:
    Sums(const MeshView& mesh, NormalWeight weight) : mesh_(mesh), weight_(weight), exact_(mesh) {}

    glm::dvec3 sum(std::span<const Index> corners, std::span<const Index> faces) {
        if (weight_ == NormalWeight::area) return exact_.area_sum(faces);
        Vector total{0, 0, 0};
        Real size = 0;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vector t = term(corners[i], faces[i]);
            add(total, t);
            size += abs(t.x) + abs(t.y) + abs(t.z);
        }
        const Real largest = std::max({Real(abs(total.x)), Real(abs(total.y)), Real(abs(total.z))});
        if (largest <= ldexp(size, -150)) return glm::dvec3(0.0);
        const int exponent = ilogb(largest);
        const auto scaled = [&](const Real& x) {
            return Real(ldexp(x, -exponent)).convert_to<double>();
        };
        return {scaled(total.x), scaled(total.y), scaled(total.z)};
    }

  private:
    Vector at(Index corner) const {
        const glm::vec3& p = mesh_.positions[mesh_.corner_vertices[corner]];
        return {Real(p.x), Real(p.y), Real(p.z)};
    }

    Vector area_vector(Index begin, Index end) const {
        const Vector first = at(begin);
        Vector total{0, 0, 0}, previous = at(begin + 1) - first;
        for (Index c = begin + 2; c < end; ++c) {
            const Vector edge = at(c) - first;
            add(total, cross(previous, edge));
            previous = edge;
        }
        return total;
    }

    Vector area_of(Index face) {
        const Index begin = mesh_.face_offsets[face], end = mesh_.face_offsets[face + 1];
        if (!has_many_corners(mesh_, face)) return area_vector(begin, end);
        const auto [at, fresh] = large_.try_emplace(face);
        if (fresh) at->second = area_vector(begin, end);
        return at->second;
    }

    Vector term(Index corner, Index face) {
        const Index begin = mesh_.face_offsets[face], end = mesh_.face_offsets[face + 1];
        const Vector area = area_of(face);
        const Real length = sqrt(dot(area, area));
        if (length == 0) return {0, 0, 0};
        const Vector normal = area * (1 / length);
        if (weight_ == NormalWeight::uniform) return normal;
        const Vector p = at(corner);
        const Vector e1 = at(corner + 1 == end ? begin : corner + 1) - p;
        const Vector e2 = at(corner == begin ? end - 1 : corner - 1) - p;
        const Vector turn = cross(e1, e2);
        const Real sine = sqrt(dot(turn, turn)), cosine = dot(e1, e2);
        if (weight_ == NormalWeight::edge_length) {
            const Real lengths = dot(e1, e1) * dot(e2, e2);
            return lengths > 0 ? normal * (sine / lengths) : Vector{0, 0, 0};
        }
        if (sine == 0 && cosine == 0) return {0, 0, 0};
        Real angle = atan2(sine, cosine);
        // At right angles to the area vector, to within rounding, a corner is convex.
        if (dot(turn, area) < -ldexp(sine * length, -150))
            angle = 2 * boost::math::constants::pi<Real>() - angle;
        return (weight_ == NormalWeight::angle ? normal : area) * angle;
    }

    const MeshView& mesh_;
    NormalWeight weight_;
    ExactFaces exact_;
    std::unordered_map<Index, Vector> large_;
};

ExactCornerSums::ExactCornerSums(const MeshView& mesh, NormalWeight weight)
    : sums_(std::make_unique<Sums>(mesh, weight)) {}
ExactCornerSums::~ExactCornerSums() = default;

glm::dvec3 ExactCornerSums::operator()(std::span<const Index> corners,
                                       std::span<const Index> faces) {
    return sums_->sum(corners, faces);
}

}  // namespace prep::detail
