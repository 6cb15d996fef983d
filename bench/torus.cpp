#include "torus.h"

#include <algorithm>
#include <array>
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

prep::Mesh bumpy_torus(const TorusSize& size) {
    const std::uint32_t n = size.rings, m = size.segments;
    prep::Mesh mesh;
    mesh.name = "torus";
    mesh.positions.reserve(std::size_t(n) * m);
    std::vector<double> around(m), across(m), bump(m);
    for (std::uint32_t j = 0; j < m; ++j) {
        const double v = 2 * pi * j / m;
        around[j] = cosine(v);
        across[j] = sine(v);
        bump[j] = sine(16 * v);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        const double u = 2 * pi * i / n, wave = sine(24 * u), c = cosine(u), s = sine(u);
        for (std::uint32_t j = 0; j < m; ++j) {
            const double radius = 0.4 * (1 + 0.06 * wave * bump[j]);
            const double reach = 1 + radius * around[j];
            mesh.positions.emplace_back(millionths(reach * c), millionths(radius * across[j]),
                                        millionths(-reach * s));
        }
    }
    prep::CornerLayer<glm::vec2>& uv = mesh.uvs.emplace_back();
    uv.values.reserve(std::size_t(n + 1) * (m + 1));
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= m; ++j)
            uv.values.emplace_back(millionths(double(i) / n), millionths(1 - double(j) / m));

    const std::size_t triangles = std::size_t(2) * n * m;
    mesh.corner_vertices.reserve(3 * triangles);
    uv.indices.reserve(3 * triangles);
    mesh.face_offsets.reserve(triangles + 1);
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < m; ++j)
            for (const auto& corners : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
                for (const int corner : corners) {
                    const std::uint32_t a = i + (corner == 1 || corner == 2);
                    const std::uint32_t b = j + (corner >= 2);
                    mesh.corner_vertices.push_back(a % n * m + b % m);
                    uv.indices.push_back(a * (m + 1) + b);
                }
                mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
            }
    return mesh;
}

}  // namespace bench
