#include "sheets/surfaces/curvature.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

namespace report {
namespace {

// Vertices that a UV seam keeps apart: the lowest of one place and normal.
std::vector<std::uint32_t> joined_vertices(const prep::VertexMesh& mesh) {
    // By bits, of which what is no number has some as well; 0 and -0 are one place.
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x + 0.0f); };
    const auto key = [&](std::uint32_t v) {
        const glm::vec3 &p = mesh.positions[v], &n = mesh.normals[v];
        return std::array{bits(p.x), bits(p.y), bits(p.z), bits(n.x), bits(n.y), bits(n.z)};
    };
    std::vector<std::uint32_t> order(mesh.vertex_count()), joined(order.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    for (std::size_t k = 0; k < order.size(); ++k)
        joined[order[k]] =
            k > 0 && key(order[k]) == key(order[k - 1]) ? joined[order[k - 1]] : order[k];
    return joined;
}

// The trace of the form, halved; false where the triangle has no extent.
bool triangle_curvature(const std::array<glm::dvec3, 3>& p, const std::array<glm::dvec3, 3>& n,
                        double& curvature, double& area) {
    const glm::dvec3 across = glm::cross(p[1] - p[0], p[2] - p[0]);
    area = glm::length(across) / 2;
    const double side = glm::length(p[2] - p[1]);
    if (!(area > 0) || !(side > 0)) return false;
    const glm::dvec3 t = (p[2] - p[1]) / side;
    const glm::dvec3 b = glm::cross(across / (2 * area), t);
    // (u v 0; 0 u v) (l, m, n) = the normals' difference, for each edge.
    double uu = 0, uv = 0, vv = 0;
    glm::dvec3 right(0);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 e = p[(k + 2) % 3] - p[(k + 1) % 3], dn = n[(k + 2) % 3] - n[(k + 1) % 3];
        const double u = glm::dot(e, t), v = glm::dot(e, b);
        const double du = glm::dot(dn, t), dv = glm::dot(dn, b);
        uu += u * u, uv += u * v, vv += v * v;
        right += glm::dvec3(u * du, v * du + u * dv, v * dv);
    }
    const glm::dmat3 normal(uu, uv, 0, uv, uu + vv, uv, 0, uv, vv);
    const double determinant = glm::determinant(normal);
    if (!(determinant > 0)) return false;
    const glm::dvec3 form = glm::inverse(normal) * right;
    curvature = (form.x + form.z) / 2;
    return std::isfinite(curvature);
}

}  // namespace

std::vector<double> mean_curvature(const prep::VertexMesh& mesh) {
    std::vector<double> found(mesh.vertex_count(), 0.0);
    if (mesh.normals.empty()) return found;
    const std::vector<std::uint32_t> joined = joined_vertices(mesh);
    std::vector<double> areas(mesh.vertex_count(), 0.0);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        std::array<glm::dvec3, 3> p, n;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = mesh.positions[mesh.indices[3 * t + k]];
            n[k] = mesh.normals[mesh.indices[3 * t + k]];
        }
        double curvature = 0, area = 0;
        if (!triangle_curvature(p, n, curvature, area)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = joined[mesh.indices[3 * t + k]];
            found[v] += curvature * area;
            areas[v] += area;
        }
    }
    for (std::size_t v = 0; v < found.size(); ++v)
        if (areas[v] > 0) found[v] /= areas[v];
    for (std::size_t v = 0; v < found.size(); ++v) found[v] = found[joined[v]];
    return found;
}

double color_by_curvature(prep::PreparedScene& scene) {
    std::vector<std::vector<double>> found;
    std::vector<double> sizes;
    for (const prep::VertexMesh& mesh : scene.meshes) {
        found.push_back(mean_curvature(mesh));
        for (const double h : found.back()) sizes.push_back(std::abs(h));
    }
    const auto at = sizes.begin() + std::ptrdiff_t(sizes.size() * 95 / 100);
    std::nth_element(sizes.begin(), at, sizes.end());
    const double full = at != sizes.end() ? *at : 0;
    const glm::vec4 white(0.85f, 0.85f, 0.85f, 1), red(0.62f, 0.04f, 0.02f, 1),
        blue(0.03f, 0.16f, 0.60f, 1);
    for (std::size_t m = 0; m < found.size(); ++m) {
        auto& colors = scene.meshes[m].colors;
        colors.assign(1, {});
        colors[0].reserve(found[m].size());
        for (const double h : found[m]) {
            const double part = full > 0 ? std::clamp(h / full, -1.0, 1.0) : 0;
            colors[0].push_back(
                glm::mix(white, part > 0 ? red : blue, static_cast<float>(std::abs(part))));
        }
    }
    return full;
}

}  // namespace report
