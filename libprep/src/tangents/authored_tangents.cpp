#include "tangents/authored_tangents.h"

#include <algorithm>
#include <cmath>

#include "base/finite.h"
#include "normals/authored_layers.h"
#include "normals/authored_normals.h"

namespace prep::detail {
namespace {

constexpr double least_agreement = 0.5;  // cosine of 60°

std::uint8_t value_fault(const glm::vec4& t) {
    if (!is_finite(t)) return tangent_non_finite;
    const double length = glm::length(glm::dvec3(t));
    if (length == 0) return tangent_zero;
    if (std::abs(t.w) < 0.5f) return tangent_no_sign;
    const bool unit = std::abs(length - 1.0) <= unit_tolerance && std::abs(t.w) == 1.0f;
    return unit ? 0 : tangent_non_unit;
}

bool off_plane(const glm::vec4& t, const glm::vec3& normal) {
    const glm::dvec3 n(normal), d(t);
    const double lengths = glm::length(n) * glm::length(d);
    return std::isfinite(lengths) && std::abs(glm::dot(n, d)) > plane_tolerance * lengths;
}

bool against(const glm::vec4& t, const glm::vec4& computed) {
    if (glm::vec3(computed) == glm::vec3(0.0f)) return false;
    const glm::dvec3 d(t), c(computed);
    return t.w * computed.w < 0 || glm::dot(d, c) < least_agreement * glm::length(d);
}

// Corners at which the UVs say nothing, though the computed layer has a frame.
std::vector<bool> without_gradient(const CornerTangents& computed) {
    std::vector<bool> result(computed.tangents.indices.size(), false);
    for (const auto& f : computed.fallbacks)
        result[f.corner] = f.source != TangentSource::reprojected;
    return result;
}

}  // namespace

bool TangentReview::any(unsigned bits) const {
    for (int k = 0; k < tangent_fault_kinds; ++k)
        if ((bits >> k & 1u) && counts[std::size_t(k)] > 0) return true;
    return false;
}

void TangentReview::mark_stale(const std::vector<bool>& replaced) {
    for (std::size_t c = 0; c < replaced.size(); ++c) {
        if (!replaced[c] || (faults[c] & tangent_missing)) continue;
        faults[c] |= tangent_stale;
        ++counts[7];
    }
}

void TangentReview::forgive_missing(const std::vector<bool>& corners) {
    for (std::size_t c = 0; c < corners.size(); ++c) {
        if (!corners[c] || !(faults[c] & tangent_missing)) continue;
        faults[c] &= std::uint8_t(~tangent_missing);
        --counts[0];
    }
}

TangentReview review_tangents(const MeshView& mesh, const CornerLayer<glm::vec4>& authored,
                              const CornerTangents* computed) {
    TangentReview review;
    const std::size_t corners = mesh.corner_count();
    review.faults.assign(corners, tangent_missing);
    if (authored.indices.empty()) {
        review.counts[0] = corners;
        return review;
    }
    std::vector<std::uint8_t> value_faults(authored.values.size());
    std::transform(authored.values.begin(), authored.values.end(), value_faults.begin(),
                   value_fault);
    const std::vector<bool> mute = computed ? without_gradient(*computed) : std::vector<bool>();
    for (std::size_t c = 0; c < corners; ++c) {
        const std::uint32_t i = authored.indices[c];
        unsigned fault = i == no_index ? unsigned(tangent_missing) : value_faults[i];
        if (!(fault & tangent_unusable)) {
            const glm::vec4& t = authored.values[i];
            const std::uint32_t n =
                mesh.normals.indices.empty() ? no_index : mesh.normals.indices[c];
            if (n != no_index && off_plane(t, mesh.normals.values[n])) fault |= tangent_off_plane;
            if (computed && !mute[c] &&
                against(t, computed->tangents.values[computed->tangents.indices[c]]))
                fault |= tangent_against_uvs;
        }
        review.faults[c] = std::uint8_t(fault);
        for (int k = 0; k < tangent_fault_kinds; ++k)
            review.counts[std::size_t(k)] += fault >> k & 1u;
    }
    return review;
}

void make_unit(std::vector<glm::vec4>& tangents) {
    for (glm::vec4& t : tangents)
        if ((value_fault(t) & ~tangent_non_unit) == 0)
            t = glm::vec4(unit_normal(glm::vec3(t)), t.w < 0 ? -1.0f : 1.0f);
}

CornerLayer<glm::vec4> merge_tangents(const CornerLayer<glm::vec4>& authored,
                                      const TangentReview& review, unsigned replace,
                                      const CornerLayer<glm::vec4>& computed) {
    CornerLayer<glm::vec4> merged = authored;
    const std::size_t corners = review.faults.size();
    if (merged.indices.empty()) merged.indices.assign(corners, no_index);
    make_unit(merged.values);
    replace_faulty(merged, review.faults, replace, computed);
    return merged;
}

}  // namespace prep::detail
