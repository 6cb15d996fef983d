#include "normals/authored_normals.h"

#include <cmath>

#include "base/finite.h"
#include "normals/authored_layers.h"

namespace prep::detail {
namespace {

std::uint8_t fault_of(const glm::vec3& n) {
    if (!is_finite(n)) return normal_non_finite;
    const double length = glm::length(glm::dvec3(n));
    if (length == 0) return normal_zero;
    return std::abs(length - 1.0) > unit_tolerance ? normal_non_unit : 0;
}

}  // namespace

NormalReview review_normals(const MeshView& mesh, const FaceNormals* faces) {
    NormalReview review;
    review.faults.assign(mesh.corner_count(), normal_missing);
    if (mesh.normals.empty()) {
        review.missing = mesh.corner_count();
        return review;
    }
    std::vector<std::uint8_t> value_faults(mesh.normals.values.size());
    for (std::size_t i = 0; i < value_faults.size(); ++i)
        value_faults[i] = fault_of(mesh.normals.values[i]);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const std::uint32_t i = mesh.normals.indices[c];
            std::uint8_t fault = i == no_index ? std::uint8_t(normal_missing) : value_faults[i];
            if (faces && i != no_index && (fault == 0 || fault == normal_non_unit) &&
                glm::dot(glm::dvec3(mesh.normals.values[i]), faces->area_vectors[f]) < 0)
                fault |= normal_flipped;
            review.faults[c] = fault;
            review.missing += (fault & normal_missing) != 0;
            review.non_finite += (fault & normal_non_finite) != 0;
            review.zero += (fault & normal_zero) != 0;
            review.non_unit += (fault & normal_non_unit) != 0;
            review.flipped += (fault & normal_flipped) != 0;
        }
    }
    return review;
}

CornerLayer<glm::vec3> merge_normals(const CornerLayer<glm::vec3>& authored,
                                     const NormalReview& review, unsigned replace,
                                     const CornerLayer<glm::vec3>& computed) {
    CornerLayer<glm::vec3> merged = authored;
    const std::size_t corners = review.faults.size();
    if (merged.indices.empty()) merged.indices.assign(corners, no_index);
    replace_faulty(merged, review.faults, replace, computed);
    return merged;
}

glm::vec3 unit_normal(const glm::vec3& n) {
    const glm::dvec3 d(n);
    const double length = glm::length(d);
    if (!(length > 0) || !std::isfinite(length)) return n;
    return std::abs(length - 1.0) <= rounded_unit ? n : glm::vec3(d / length);
}

}  // namespace prep::detail
