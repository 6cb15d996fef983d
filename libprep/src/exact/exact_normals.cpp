#include "exact/exact_normals.h"

#include <CGAL/Exact_rational.h>
#include <CGAL/number_utils.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>
#include <unordered_map>
#include <vector>

namespace prep::detail {
namespace {

using Rational = CGAL::Exact_rational;
using RationalVector = std::array<Rational, 3>;

RationalVector area_vector(const MeshView& mesh, std::uint32_t face) {
    const std::uint32_t begin = mesh.face_offsets[face], end = mesh.face_offsets[face + 1];
    const auto edge_to = [&](std::uint32_t c) {
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        const glm::vec3& o = mesh.positions[mesh.corner_vertices[begin]];
        return RationalVector{Rational(p.x) - Rational(o.x), Rational(p.y) - Rational(o.y),
                              Rational(p.z) - Rational(o.z)};
    };
    RationalVector sum{0, 0, 0};
    RationalVector a = edge_to(begin + 1);
    for (std::uint32_t c = begin + 2; c < end; ++c) {
        RationalVector b = edge_to(c);
        sum[0] += a[1] * b[2] - a[2] * b[1];
        sum[1] += a[2] * b[0] - a[0] * b[2];
        sum[2] += a[0] * b[1] - a[1] * b[0];
        a = std::move(b);
    }
    return sum;
}

Rational dot(const RationalVector& a, const RationalVector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

class ExactFaces::Kept {
  public:
    explicit Kept(const MeshView& mesh) : mesh_(mesh) {}

    // What `use` makes of the faces' area vectors. Numbers that threads share are looked at by one
    // at a time: copies of them count their owners.
    template <class Use>
    auto of(std::span<const std::uint32_t> faces, const Use& use) {
        const bool any_large = std::any_of(faces.begin(), faces.end(), [&](std::uint32_t face) {
            return has_many_corners(mesh_, face);
        });
        const std::unique_lock<std::mutex> lock =
            any_large ? std::unique_lock(mutex_) : std::unique_lock<std::mutex>();
        std::vector<RationalVector> small;
        small.reserve(faces.size());
        std::vector<const RationalVector*> all;
        for (const std::uint32_t face : faces) {
            if (!has_many_corners(mesh_, face)) {
                all.push_back(&small.emplace_back(area_vector(mesh_, face)));
                continue;
            }
            const auto [at, fresh] = large_.try_emplace(face);
            if (fresh) {
                at->second = area_vector(mesh_, face);
                ++made_;
            }
            all.push_back(&at->second);
        }
        return use(all);
    }

    std::size_t made() {
        const std::unique_lock lock(mutex_);
        return made_;
    }

  private:
    const MeshView& mesh_;
    std::mutex mutex_;
    std::unordered_map<std::uint32_t, RationalVector> large_;
    std::size_t made_ = 0;
};

ExactFaces::ExactFaces(const MeshView& mesh) : kept_(std::make_unique<Kept>(mesh)) {}
ExactFaces::~ExactFaces() = default;

std::size_t ExactFaces::kept_made() const {
    return kept_->made();
}

glm::dvec3 exact_area_vector(const MeshView& mesh, std::uint32_t face) {
    const RationalVector v = area_vector(mesh, face);
    return {CGAL::to_double(v[0]), CGAL::to_double(v[1]), CGAL::to_double(v[2])};
}

glm::dvec3 ExactFaces::area_sum(std::span<const std::uint32_t> faces) const {
    return kept_->of(faces, [](const std::vector<const RationalVector*>& vectors) {
        RationalVector sum{0, 0, 0};
        for (const RationalVector* const v : vectors)
            for (int k = 0; k < 3; ++k) sum[k] += (*v)[k];
        Rational largest = 0;
        for (const Rational& x : sum) {
            const Rational magnitude = CGAL::abs(x);
            if (magnitude > largest) largest = magnitude;
        }
        if (largest == 0) return glm::dvec3(0.0);
        // The smallest sum of products of float differences is 2^-298: inside double's range.
        const int exponent = std::ilogb(CGAL::to_double(largest)) + 1;
        glm::dvec3 result;
        for (int k = 0; k < 3; ++k) result[k] = std::ldexp(CGAL::to_double(sum[k]), -exponent);
        return result;
    });
}

Threshold threshold_of(double degrees) {
    Threshold t;
    const auto exact = [&](int sign, double numerator, double denominator) {
        t.exact_square = true;
        t.cosine = {sign, numerator, denominator, sign * std::sqrt(numerator / denominator)};
    };
    if (degrees == 0)
        exact(1, 1, 1);
    else if (degrees == 30)
        exact(1, 3, 4);
    else if (degrees == 45)
        exact(1, 1, 2);
    else if (degrees == 60)
        exact(1, 1, 4);
    else if (degrees == 90)
        exact(0, 0, 1);
    else if (degrees == 120)
        exact(-1, 1, 4);
    else if (degrees == 135)
        exact(-1, 1, 2);
    else if (degrees == 150)
        exact(-1, 3, 4);
    else if (degrees == 180)
        exact(-1, 1, 1);
    else {
        const double c = std::cos(degrees * (std::numbers::pi / 180.0));
        t.cosine.cosine = c;
        t.cosine.sign = c > 0 ? 1 : c < 0 ? -1 : 0;
    }
    return t;
}

bool ExactFaces::turn_exceeds(std::uint32_t face0, std::uint32_t face1,
                              const Threshold& threshold) const {
    const std::uint32_t faces[] = {face0, face1};
    return kept_->of(faces, [&](const std::vector<const RationalVector*>& normals) {
        const RationalVector &n0 = *normals[0], &n1 = *normals[1];
        const Rational l0 = dot(n0, n0), l1 = dot(n1, n1);
        if (l0 == 0 || l1 == 0) return false;
        const Rational s = dot(n0, n1);
        Rational squared;
        if (threshold.exact_square) {
            squared = Rational(threshold.cosine.squared_numerator) /
                      Rational(threshold.cosine.squared_denominator);
        } else {
            squared = Rational(threshold.cosine.cosine);
            squared *= squared;
        }
        // turn > θ  ⇔  s < cos θ · |n0||n1|, compared by signs and squares.
        const Rational right = squared * l0 * l1, left = s * s;
        if (threshold.cosine.sign >= 0) return s < 0 || left < right;
        return s < 0 && left > right;
    });
}

}  // namespace prep::detail
