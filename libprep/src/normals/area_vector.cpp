#include "normals/area_vector.h"

#include "exact/difference_of_products.h"
#include "exact/exact_normals.h"
#include "prep/face_normals.h"

namespace prep::detail {
namespace {

constexpr double half_ulp = 0x1p-53;

glm::dvec3 cross(const glm::dvec3& a, const glm::dvec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Edge {
    glm::dvec3 value;
    bool exact;
};

Edge edge_between(const glm::vec3& from, const glm::vec3& to) {
    Edge edge{glm::dvec3(0.0), true};
    for (int k = 0; k < 3; ++k) {
        const TwoDoubles d = two_sum(double(to[k]), -double(from[k]));
        edge.value[k] = d.high;
        edge.exact &= d.low == 0;
    }
    return edge;
}

}  // namespace

AreaVector plain_area_vector(const MeshView& mesh, std::uint32_t face) {
    const std::uint32_t begin = mesh.face_offsets[face], end = mesh.face_offsets[face + 1];
    const glm::dvec3 first(mesh.positions[mesh.corner_vertices[begin]]);
    const auto edge_to = [&](std::uint32_t c) {
        return glm::dvec3(mesh.positions[mesh.corner_vertices[c]]) - first;
    };
    glm::dvec3 previous = edge_to(begin + 1);
    double previous_size = largest_component(previous), sizes = 0;
    AreaVector area;
    for (std::uint32_t c = begin + 2; c < end; ++c) {
        const glm::dvec3 edge = edge_to(c);
        const double size = largest_component(edge);
        area.value += cross(previous, edge);
        sizes += previous_size * size;
        previous = edge;
        previous_size = size;
    }
    // Bounds of components times √3 < 2.
    area.error = double(16 + 4 * (end - begin - 3)) * half_ulp * sizes;
    return area;
}

AreaVector compensated_area_vector(const MeshView& mesh, std::uint32_t face) {
    const std::uint32_t begin = mesh.face_offsets[face], end = mesh.face_offsets[face + 1];
    const auto edge_to = [&](std::uint32_t c) {
        return edge_between(mesh.positions[mesh.corner_vertices[begin]],
                            mesh.positions[mesh.corner_vertices[c]]);
    };
    Edge previous = edge_to(begin + 1);
    glm::dvec3 sum(0.0), low(0.0);
    double sizes = 0, edge_errors = 0;
    bool zero = true;
    for (std::uint32_t c = begin + 2; c < end; ++c) {
        const Edge edge = edge_to(c);
        const glm::dvec3 &a = previous.value, &b = edge.value;
        for (int k = 0; k < 3; ++k) {
            const int u = (k + 1) % 3, v = (k + 2) % 3;
            const TwoDoubles term = difference_of_products_parts(a[u], b[v], a[v], b[u]);
            const TwoDoubles s = two_sum(sum[k], term.high);
            sum[k] = s.high;
            low[k] += s.low + term.low;
            zero &= two_product(a[u], b[v]) == two_product(a[v], b[u]);
        }
        const double size = largest_component(a) * largest_component(b);
        sizes += size;
        if (!previous.exact || !edge.exact) {
            edge_errors += 8 * half_ulp * size;
            zero = false;
        }
        previous = edge;
    }
    AreaVector area;
    area.value = sum + low;
    if (zero) return {};
    // Low parts are below 2⁻⁵² of the terms and lose 2⁻⁵³ of themselves at every addition.
    area.error = 2 * half_ulp * largest_component(area.value) +
                 double(end - begin) * 0x1p-100 * sizes + edge_errors;
    return area;
}

glm::dvec3 accurate_area_vector(const MeshView& mesh, std::uint32_t face, std::uint64_t* exact) {
    AreaVector area = plain_area_vector(mesh, face);
    if (area.error <= accurate_face_error * largest_component(area.value)) return area.value;
    // Zero without an error is exactly zero.
    area = compensated_area_vector(mesh, face);
    if (area.error <= accurate_face_error * largest_component(area.value)) return area.value;
    if (exact != nullptr) ++*exact;
    return exact_area_vector(mesh, face);
}

glm::dvec3 corner_cross(const glm::vec3& at, const glm::vec3& next, const glm::vec3& previous) {
    const Edge a = edge_between(at, next), b = edge_between(at, previous);
    glm::dvec3 result;
    for (int k = 0; k < 3; ++k) {
        const int u = (k + 1) % 3, v = (k + 2) % 3;
        result[k] = difference_of_products(a.value[u], b.value[v], a.value[v], b.value[u]);
    }
    return result;
}

}  // namespace prep::detail
