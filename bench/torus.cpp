#include "torus.h"

#include <algorithm>
#include <cmath>

#include "../samples/generator/repeatable.h"

namespace bench {
namespace {

using samples::cosine;
using samples::pi;
using samples::sine;

float millionths(double x) {
    return float(std::floor(x * 1e6 + 0.5) / 1e6);
}

}  // namespace

TorusSize torus_size(std::uint64_t triangles) {
    const std::uint64_t quads = std::max<std::uint64_t>(9, triangles / 2);
    const auto root = std::uint64_t(std::sqrt(double(quads)));
    for (std::uint64_t rings = root; rings >= std::max<std::uint64_t>(3, root / 2); --rings)
        if (quads % rings == 0) return {std::uint32_t(rings), std::uint32_t(quads / rings)};
    return {std::uint32_t(root), std::uint32_t(quads / root)};
}

TorusGrid::TorusGrid(const TorusSize& size) : size_(size) {
    for (std::uint32_t i = 0; i < size.rings; ++i) {
        const double u = 2 * pi * i / size.rings;
        wave_.push_back(sine(24 * u));
        cosine_.push_back(cosine(u));
        sine_.push_back(sine(u));
    }
    for (std::uint32_t j = 0; j < size.segments; ++j) {
        const double v = 2 * pi * j / size.segments;
        around_.push_back(cosine(v));
        across_.push_back(sine(v));
        bump_.push_back(sine(16 * v));
    }
}

glm::vec3 TorusGrid::position(std::uint32_t ring, std::uint32_t segment) const {
    const double radius = 0.4 * (1 + 0.06 * wave_[ring] * bump_[segment]);
    const double reach = 1 + radius * around_[segment];
    return {millionths(reach * cosine_[ring]), millionths(radius * across_[segment]),
            millionths(-reach * sine_[ring])};
}

glm::vec2 TorusGrid::uv(std::uint32_t ring, std::uint32_t segment) const {
    return {millionths(double(ring) / size_.rings),
            millionths(1 - double(segment) / size_.segments)};
}

prep::Mesh bumpy_torus(const TorusSize& size) {
    const TorusGrid grid(size);
    const std::uint32_t n = size.rings, m = size.segments;
    prep::Mesh mesh;
    mesh.name = "torus";
    mesh.positions.reserve(std::size_t(n) * m);
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < m; ++j) mesh.positions.push_back(grid.position(i, j));
    prep::CornerLayer<glm::vec2>& uv = mesh.uvs.emplace_back();
    uv.values.reserve(std::size_t(n + 1) * (m + 1));
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= m; ++j) uv.values.push_back(grid.uv(i, j));

    const std::size_t triangles = std::size_t(2) * n * m;
    mesh.corner_vertices.reserve(3 * triangles);
    uv.indices.reserve(3 * triangles);
    mesh.face_offsets.reserve(triangles + 1);
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < m; ++j)
            for (const auto& corners : TorusGrid::triangles) {
                for (const auto& [ring, segment] : corners) {
                    const std::uint32_t a = i + ring, b = j + segment;
                    mesh.corner_vertices.push_back(a % n * m + b % m);
                    uv.indices.push_back(a * (m + 1) + b);
                }
                mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
            }
    return mesh;
}

}  // namespace bench
