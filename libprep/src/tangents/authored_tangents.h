// What the file's own tangents are worth, corner by corner, and how computed ones take their place.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prep/mesh.h"
#include "prep/tangents.h"

namespace prep::detail {

enum TangentReviewFault : std::uint8_t {  // bits
    tangent_missing = 1,
    tangent_non_finite = 2,
    tangent_zero = 4,
    tangent_no_sign = 8,       // w is nearer to 0 than to ±1
    tangent_non_unit = 16,     // length off by more than unit_tolerance, or w clear, not ±1
    tangent_off_plane = 32,    // its sine out of the normal's plane is more than plane_tolerance
    tangent_against_uvs = 64,  // more than 60° from the UVs' direction, or of the other sign
    tangent_stale = 128,       // its normal was replaced
};
inline constexpr int tangent_fault_kinds = 8;
// With one of these there is no frame at all.
inline constexpr unsigned tangent_unusable =
    tangent_missing | tangent_non_finite | tangent_zero | tangent_no_sign;

// 1.1°: normals and tangents that were stored as signed bytes are each up to 0.4° off.
inline constexpr double plane_tolerance = 0.02;

struct TangentReview {
    std::vector<std::uint8_t> faults;  // per corner: bits of TangentReviewFault
    std::array<std::uint64_t, tangent_fault_kinds> counts{};  // corners, per bit
    bool any(unsigned bits) const;
    // Corners with a tangent whose normal is not the file's; `replaced` per corner, or empty.
    void mark_stale(const std::vector<bool>& replaced);
    // What these corners (a bit each) have not is not missed.
    void forgive_missing(const std::vector<bool>& corners);
};

// `mesh` with the normals that the tangents are to go with. Against UVs is only checked where
// `computed` is given, and there only at corners whose UVs have a gradient.
TangentReview review_tangents(const MeshView& mesh, const CornerLayer<glm::vec4>& authored,
                              const CornerTangents* computed);

// Scales to unit length, and w to 1 or -1, where a direction and a sign are there; unit tangents
// keep their bits (as unit_normal does).
void make_unit(std::vector<glm::vec4>& tangents);

// Authored tangents, made unit, with computed ones at the corners whose faults intersect `replace`.
CornerLayer<glm::vec4> merge_tangents(const CornerLayer<glm::vec4>& authored,
                                      const TangentReview& review, unsigned replace,
                                      const CornerLayer<glm::vec4>& computed);

}  // namespace prep::detail
