#include "prep/face_normals.h"

#include <algorithm>
#include <cmath>

#include "difference_of_products.h"
#include "exact_normals.h"
#include "parallel.h"

namespace prep {
namespace {

constexpr std::size_t face_grain = 16384;
constexpr double half_ulp = 0x1p-53;

bool finite(const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

struct AreaVector {
    glm::dvec3 value{0.0};
    double error = 0;
};

struct Edge {
    glm::dvec3 value;
    bool exact;
};

Edge edge_between(const glm::vec3& from, const glm::vec3& to) {
    Edge edge{glm::dvec3(0.0), true};
    for (int k = 0; k < 3; ++k) {
        const detail::TwoDoubles d = detail::two_sum(double(to[k]), -double(from[k]));
        edge.value[k] = d.high;
        edge.exact &= d.low == 0;
    }
    return edge;
}

AreaVector accurate_area_vector(const MeshView& mesh, std::uint32_t begin, std::uint32_t end) {
    const auto edge_to = [&](std::uint32_t c) {
        return edge_between(mesh.positions[mesh.corner_vertices[begin]],
                            mesh.positions[mesh.corner_vertices[c]]);
    };
    Edge previous = edge_to(begin + 1);
    AreaVector sum;
    glm::dvec3 compensation(0.0);
    for (std::uint32_t c = begin + 2; c < end; ++c) {
        const Edge edge = edge_to(c);
        const glm::dvec3 cross = detail::accurate_cross(previous.value, edge.value);
        for (int k = 0; k < 3; ++k) {
            const detail::TwoDoubles s = detail::two_sum(sum.value[k], cross[k]);
            sum.value[k] = s.high;
            compensation[k] += s.low;
        }
        // Two ulps of a term for the products and the sum. An edge between coordinates of very
        // different size is rounded itself, by half an ulp of its length.
        sum.error += 4 * half_ulp * glm::length(cross);
        if (!previous.exact || !edge.exact)
            sum.error += 4 * half_ulp * glm::length(previous.value) * glm::length(edge.value);
        previous = edge;
    }
    sum.value += compensation;
    return sum;
}

AreaVector fast_area_vector(const MeshView& mesh, std::uint32_t begin, std::uint32_t end) {
    const auto at = [&](std::uint32_t c) { return mesh.positions[mesh.corner_vertices[c]]; };
    const glm::vec3 p0 = at(begin);
    glm::vec3 previous = at(begin + 1) - p0;
    // One power of two for the whole face keeps the products inside float's range.
    float largest = 0;
    for (std::uint32_t c = begin + 1; c < end; ++c) {
        const glm::vec3 e = glm::abs(at(c) - p0);
        largest = std::max({largest, e.x, e.y, e.z});
    }
    if (!(largest > 0)) return {};
    const int exponent = std::ilogb(largest);
    const float scale = std::ldexp(1.0f, std::clamp(-exponent, -126, 126));
    previous *= scale;
    glm::vec3 sum(0.0f);
    for (std::uint32_t c = begin + 2; c < end; ++c) {
        const glm::vec3 edge = (at(c) - p0) * scale;
        sum += glm::cross(previous, edge);
        previous = edge;
    }
    const double unscale = 1.0 / double(scale);
    const double spread = double(end - begin) * 16.0;
    return {glm::dvec3(sum) * (unscale * unscale), 0x1p-24 * spread * unscale * unscale};
}

}  // namespace

FaceNormals face_normals(const MeshView& mesh, Precision precision, int threads) {
    const std::size_t faces = mesh.face_count();
    FaceNormals result;
    result.area_vectors.assign(faces, glm::dvec3(0.0));
    result.errors.assign(faces, 0.0);
    result.states.assign(faces, FaceState::regular);
    detail::parallel_blocks(faces, face_grain, threads, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            const std::uint32_t begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
            bool all_finite = true;
            for (std::uint32_t c = begin; c < end; ++c)
                all_finite &= finite(mesh.positions[mesh.corner_vertices[c]]);
            if (!all_finite) {
                result.states[f] = FaceState::non_finite;
                continue;
            }
            AreaVector area;
            if (precision == Precision::fast) {
                area = fast_area_vector(mesh, begin, end);
            } else {
                area = accurate_area_vector(mesh, begin, end);
                // Whether an area is zero is a decision, so it is an exact one.
                const double length = glm::length(area.value);
                if (precision == Precision::exact || length <= 4 * area.error) {
                    area.value = detail::exact_area_vector(mesh, std::uint32_t(f));
                    area.error = half_ulp * glm::length(area.value);
                }
            }
            result.area_vectors[f] = area.value;
            result.errors[f] = area.error;
            if (area.value == glm::dvec3(0.0)) result.states[f] = FaceState::zero_area;
        }
    });
    return result;
}

}  // namespace prep
