// The normal of one fan: the weighted sum of its faces' normals, in the cheapest arithmetic whose
// error bound meets the precision's.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "exact/arc_tangent.h"
#include "exact/exact_corner_sums.h"
#include "exact/exact_normals.h"
#include "exact/reproducible_sum.h"
#include "normals/area_vector.h"
#include "prep/corner_normals.h"

namespace prep::detail {

// What is told of the fans that were looked at.
struct FanReport {
    std::vector<CornerNormals::Fallback> fallbacks;
    std::uint64_t exact_sums = 0;
};

inline glm::dvec3 unit_of(const glm::dvec3& v) {
    const glm::dvec3 scaled = v / largest_component(v);
    return scaled / std::sqrt(glm::dot(scaled, scaled));
}

// The sum of area vectors (w: sums of absolute components) that are good to relative_error and
// together to `error`, where it is good enough; zero elsewhere.
inline glm::dvec3 trusted_area_sum(std::span<const glm::dvec4> terms, double relative_error,
                                   double allowed_error, double error = 0) {
    const OrderFreeSum sum = order_free_sum(terms);
    const double allowed = allowed_error * largest_component(sum.value);
    return relative_error * sum.size + sum.error + error <= allowed ? sum.value : glm::dvec3(0.0);
}

template <class Steps>
class FanNormal {
    using Index = std::uint32_t;

  public:
    // `stand_ins`: stand_in_faces().
    FanNormal(const MeshView& mesh, const FaceNormals& faces, const NormalOptions& options,
              const Steps& steps, std::span<const std::uint32_t> stand_ins)
        : mesh_(mesh), faces_(faces), options_(options), steps_(steps), stand_ins_(stand_ins) {}

    // Unit, whatever the fan. Its corners in any order.
    glm::dvec3 operator()(std::span<const Index> corners, FanReport& report) {
        if (options_.precision != Precision::exact) {
            const bool fast = options_.precision == Precision::fast;
            const glm::dvec3 sum = trusted_sum(corners, !fast);
            if (sum != glm::dvec3(0.0)) return unit_of(sum);
            // Of faces with many corners the exact sums are kept, the accurate ones made each time.
            if (fast && !any_large(corners)) {
                const glm::dvec3 better = trusted_sum(corners, true);
                if (better != glm::dvec3(0.0)) return unit_of(better);
            }
        }
        finite_.clear();
        finite_faces_.clear();
        for (const Index c : corners) {
            const Index face = steps_.face(c);
            if (faces_.states[face] != FaceState::regular) continue;
            finite_.push_back(c);
            finite_faces_.push_back(face);
        }
        if (!finite_.empty()) {
            ++report.exact_sums;
            if (!exact_sums_) exact_sums_.emplace(mesh_, options_.weight);
            const glm::dvec3 exact = (*exact_sums_)(finite_, finite_faces_);
            if (exact != glm::dvec3(0.0)) return unit_of(exact);
        }
        return fallback(corners, report);
    }

  private:
    bool any_large(std::span<const Index> corners) const {
        return std::any_of(corners.begin(), corners.end(), [&](Index c) {
            const Index face = steps_.face(c);
            return steps_.end(face) - steps_.begin(face) >= many_corners;
        });
    }

    // Zero where the sum's error bound is not small enough against the sum.
    glm::dvec3 trusted_sum(std::span<const Index> corners, bool accurate) {
        const bool compute_areas = accurate && faces_.relative_error > accurate_face_error;
        // The weights of triangles are good to a few ulps, less than the area vectors by far.
        const double relative_error =
            accurate ? 2 * accurate_face_error : fast_face_error + accurate_face_error;
        terms_.clear();
        double largest_error = 0;  // of a weight; a sum of errors would depend on the order
        for (const Index c : corners) {
            const Index face = steps_.face(c);
            const Term t = term(c, face,
                                compute_areas && faces_.states[face] == FaceState::regular
                                    ? accurate_area_vector(mesh_, face)
                                    : faces_.area_vectors[face],
                                relative_error);
            largest_error = std::max(largest_error, t.error);
            terms_.emplace_back(t.value,
                                std::abs(t.value.x) + std::abs(t.value.y) + std::abs(t.value.z));
        }
        return trusted_area_sum(terms_, relative_error,
                                accurate ? accurate_normal_error : fast_normal_error,
                                largest_error * double(corners.size()));
    }

    struct Term {
        glm::dvec3 value;
        double error = 0;  // that its weight adds
    };

    // The corner's term: its face's normal, weighted; zero where the face has none. `area` is good
    // to `area_error` of its length.
    Term term(Index corner, Index face, const glm::dvec3& area, double area_error) const {
        if (options_.weight == NormalWeight::area || faces_.states[face] != FaceState::regular)
            return {area};
        const glm::dvec3 normal = unit_of(area);
        if (options_.weight == NormalWeight::uniform) return {normal};

        const auto at = [&](Index c) { return mesh_.positions[mesh_.corner_vertices[c]]; };
        const glm::vec3 p = at(corner), next = at(steps_.next(corner)),
                        previous = at(steps_.previous(corner));
        const glm::dvec3 e1 = glm::dvec3(next) - glm::dvec3(p);
        const glm::dvec3 e2 = glm::dvec3(previous) - glm::dvec3(p);
        // In a triangle the corner's cross product is the area vector.
        const bool triangle = steps_.end(face) - steps_.begin(face) == 3;
        const glm::dvec3 cross = triangle ? area : corner_cross(p, next, previous);
        const double sine = glm::length(cross);  // times |e1||e2|
        // Of the cross product, beside |e1||e2|. Rounded edges are off by 2⁻⁵³ of each component,
        // and so each of the two products by twice that (Stability.QuadsOfManyScales).
        constexpr double cross_error = 0x1p-49;
        if (options_.weight == NormalWeight::edge_length) {
            const double l1 = glm::dot(e1, e1), l2 = glm::dot(e2, e2);
            if (!(l1 > 0) || !(l2 > 0)) return {glm::dvec3(0.0)};
            return {normal * (sine / l1 / l2), triangle ? 0 : cross_error / std::sqrt(l1 * l2)};
        }
        const double cosine = glm::dot(e1, e2);
        if (sine == 0 && cosine == 0) return {glm::dvec3(0.0)};
        const double angle = angle_of(sine, cosine);
        const glm::dvec3 weighted = options_.weight == NormalWeight::angle ? normal : area;
        if (triangle) return {weighted * angle};
        // Where the corner's plane is at right angles to the face's, or its edges fold back on each
        // other, rounding decides whether it is reflex.
        const double turn = glm::dot(cross, normal);
        const double lengths = std::sqrt(sine * sine + cosine * cosine);  // |e1||e2|
        const bool decided = std::abs(turn) > area_error * sine + 4 * cross_error * lengths;
        return {
            weighted * (turn < 0 ? 2 * pi - angle : angle),
            (decided ? cross_error : 2 * (pi - angle) + cross_error) * largest_component(weighted)};
    }

    glm::dvec3 fallback(std::span<const Index> corners, FanReport& report) {
        const Index lowest = *std::min_element(corners.begin(), corners.end());
        glm::dvec3 best = largest_area(corners, false);
        NormalFallback kind = NormalFallback::largest_face;
        if (best == glm::dvec3(0.0)) {
            best = largest_area(corners, true);
            kind = NormalFallback::neighbour_face;
        }
        if (best == glm::dvec3(0.0)) {
            best = {0, 0, 1};
            kind = NormalFallback::none_defined;
        }
        report.fallbacks.push_back({lowest, kind});
        return unit_of(best);
    }

    glm::dvec3 largest_area(std::span<const Index> corners, bool of_stand_ins) const {
        glm::dvec3 best(0.0);
        double largest = 0;
        for (const Index c : corners) {
            Index face = steps_.face(c);
            if (of_stand_ins && !stand_ins_.empty()) face = stand_ins_[face];
            if (face == no_index) continue;
            const glm::dvec3& area = faces_.area_vectors[face];
            const double length = glm::dot(area, area);
            // Ties go by value, not by index, so that the order of the faces does not matter.
            if (length > largest ||
                (length == largest && length > 0 && lexicographic(best, area))) {
                largest = length;
                best = area;
            }
        }
        return best;
    }

    static bool lexicographic(const glm::dvec3& a, const glm::dvec3& b) {
        if (a.x != b.x) return a.x < b.x;
        if (a.y != b.y) return a.y < b.y;
        return a.z < b.z;
    }

    const MeshView& mesh_;
    const FaceNormals& faces_;
    const NormalOptions& options_;
    Steps steps_;
    std::span<const Index> stand_ins_;
    std::vector<glm::dvec4> terms_;
    std::vector<Index> finite_, finite_faces_;
    std::optional<ExactCornerSums> exact_sums_;  // where the first fan asked for them
};

}  // namespace prep::detail
