#include "model/trs.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace prep::detail {
namespace {

bool is_uniform(const glm::dvec3& s) {
    return s.x == s.y && s.y == s.z;
}

}  // namespace

Trs trs_of(const glm::dmat4& matrix) {
    Trs trs;
    trs.translation = glm::dvec3(matrix[3]);
    glm::dmat3 linear(matrix);
    const auto diagonal = [&] {
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r)
                if (c != r && linear[c][r] != 0) return false;
        return true;
    };
    if (diagonal()) {
        trs.scale = {linear[0][0], linear[1][1], linear[2][2]};
        return trs;
    }
    for (int c = 0; c < 3; ++c) trs.scale[c] = glm::length(linear[c]);
    if (glm::determinant(linear) < 0) trs.scale.x = -trs.scale.x;
    for (int c = 0; c < 3; ++c)
        if (trs.scale[c] != 0) linear[c] /= trs.scale[c];
    // Axes of no length get what is missing to a rotation.
    for (int c = 0; c < 3; ++c) {
        const int a = (c + 1) % 3, b = (c + 2) % 3;
        if (trs.scale[c] == 0 && trs.scale[a] != 0 && trs.scale[b] != 0)
            linear[c] = glm::cross(linear[a], linear[b]);
    }
    linear[1] -= linear[0] * glm::dot(linear[0], linear[1]);
    const double length = glm::length(linear[1]);
    if (!(length > 0) || !std::isfinite(length)) return trs;
    linear[1] /= length;
    linear[2] = glm::cross(linear[0], linear[1]);
    trs.rotation = glm::normalize(glm::quat_cast(linear));
    return trs;
}

double shear_of(const glm::dmat4& matrix, const Trs& trs) {
    const glm::dmat4 back = trs.matrix();
    double worst = 0, size = 0;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) {
            worst = std::max(worst, std::abs(matrix[c][r] - back[c][r]));
            size = std::max(size, std::abs(matrix[c][r]));
        }
    return size > 0 ? worst / size : 0;
}

Trs without_roundings(Trs trs) {
    glm::dvec3& s = trs.scale;
    const double mean = (s.x + s.y + s.z) / 3, close = 1e-5 * std::abs(mean);
    if (std::abs(s.x - mean) < close && std::abs(s.y - mean) < close &&
        std::abs(s.z - mean) < close)
        s = glm::dvec3(std::abs(mean - 1) < 1e-5 ? 1.0 : mean);
    return trs;
}

bool multiply(const Trs& parent, const Trs& child, Trs& product) {
    const bool turns = child.rotation != glm::dquat(1, 0, 0, 0);
    if (turns && !is_uniform(parent.scale)) return false;
    Trs out;
    out.translation = parent.translation + parent.rotation * (parent.scale * child.translation);
    out.rotation = parent.rotation * child.rotation;
    out.scale = parent.scale * child.scale;
    product = out;
    return true;
}

}  // namespace prep::detail
