#include "model/primitive_shapes.h"

#include <cmath>
#include <numbers>

namespace prep::detail {
namespace {

struct Builder {
    Mesh mesh;
    Builder() { mesh.uvs.resize(1); }

    void corner(std::uint32_t vertex, glm::vec2 uv) {
        mesh.corner_vertices.push_back(vertex);
        mesh.uvs[0].indices.push_back(static_cast<std::uint32_t>(mesh.uvs[0].values.size()));
        mesh.uvs[0].values.push_back(uv);
    }
    void end_face() {
        mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corner_vertices.size()));
    }
};

// Cosine and sine of turn k of n, exact at the quarter turns so that shapes close on the axes.
glm::dvec2 turn(std::uint32_t k, std::uint32_t n) {
    k %= n;
    if (k == 0) return {1, 0};
    if (std::uint64_t(4) * k == n) return {0, 1};
    if (std::uint64_t(2) * k == n) return {-1, 0};
    if (std::uint64_t(4) * k == std::uint64_t(3) * n) return {0, -1};
    const double angle = 2 * std::numbers::pi * k / n;
    return {std::cos(angle), std::sin(angle)};
}

float fraction(std::uint32_t k, std::uint32_t n) {
    return static_cast<float>(static_cast<double>(k) / n);
}

}  // namespace

Mesh plane_shape(glm::vec2 size, std::uint32_t columns, std::uint32_t rows) {
    Builder b;
    for (std::uint32_t j = 0; j <= rows; ++j)
        for (std::uint32_t i = 0; i <= columns; ++i)
            b.mesh.positions.emplace_back(size.x * (fraction(i, columns) - 0.5f), 0.0f,
                                          size.y * (fraction(j, rows) - 0.5f));
    const auto add = [&](std::uint32_t i, std::uint32_t j) {
        b.corner(j * (columns + 1) + i, {fraction(i, columns), fraction(j, rows)});
    };
    for (std::uint32_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < columns; ++i) {
            add(i, j);
            add(i, j + 1);
            add(i + 1, j + 1);
            add(i + 1, j);
            b.end_face();
        }
    }
    return std::move(b.mesh);
}

Mesh box_shape(glm::vec3 size) {
    Builder b;
    for (int i = 0; i < 8; ++i)
        b.mesh.positions.emplace_back(size.x * ((i & 1) ? 0.5f : -0.5f),
                                      size.y * ((i & 2) ? 0.5f : -0.5f),
                                      size.z * ((i & 4) ? 0.5f : -0.5f));
    // Each face from its lower left corner, counter-clockwise seen from outside, +Y (or −Z) up.
    constexpr std::uint32_t faces[6][4] = {{5, 1, 3, 7}, {0, 4, 6, 2}, {6, 7, 3, 2},
                                           {0, 1, 5, 4}, {4, 5, 7, 6}, {1, 0, 2, 3}};
    constexpr glm::vec2 uv[4] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    for (const auto& face : faces) {
        for (int k = 0; k < 4; ++k) b.corner(face[k], uv[k]);
        b.end_face();
    }
    return std::move(b.mesh);
}

Mesh sphere_shape(float radius, std::uint32_t segments, std::uint32_t rings) {
    Builder b;
    b.mesh.positions.emplace_back(0.0f, radius, 0.0f);
    for (std::uint32_t j = 1; j < rings; ++j) {
        const glm::dvec2 latitude = turn(j, 2 * rings);  // from the north pole
        for (std::uint32_t i = 0; i < segments; ++i) {
            const glm::dvec2 longitude = turn(i, segments);
            b.mesh.positions.emplace_back(radius * latitude.y * longitude.x, radius * latitude.x,
                                          -radius * latitude.y * longitude.y);
        }
    }
    b.mesh.positions.emplace_back(0.0f, -radius, 0.0f);
    const std::uint32_t south = 1 + (rings - 1) * segments;
    const auto ring = [&](std::uint32_t i, std::uint32_t j) {
        b.corner(1 + (j - 1) * segments + i % segments,
                 {fraction(i, segments), fraction(j, rings)});
    };
    const auto pole = [&](std::uint32_t vertex, std::uint32_t i, float v) {
        b.corner(vertex, {static_cast<float>((i + 0.5) / segments), v});
    };
    for (std::uint32_t j = 0; j < rings; ++j) {
        for (std::uint32_t i = 0; i < segments; ++i) {
            if (j == 0) {
                pole(0, i, 0.0f);
            } else {
                ring(i, j);
            }
            if (j + 1 == rings) {
                pole(south, i, 1.0f);
            } else {
                ring(i, j + 1);
                ring(i + 1, j + 1);
            }
            if (j > 0) ring(i + 1, j);
            b.end_face();
        }
    }
    return std::move(b.mesh);
}

Mesh cylinder_shape(float radius, float height, std::uint32_t segments) {
    Builder b;
    for (const float y : {0.5f * height, -0.5f * height}) {
        for (std::uint32_t i = 0; i < segments; ++i) {
            const glm::dvec2 t = turn(i, segments);
            b.mesh.positions.emplace_back(radius * t.x, y, -radius * t.y);
        }
    }
    const auto side = [&](std::uint32_t i, std::uint32_t row) {
        b.corner(row * segments + i % segments, {fraction(i, segments), static_cast<float>(row)});
    };
    for (std::uint32_t i = 0; i < segments; ++i) {
        side(i, 0);
        side(i, 1);
        side(i + 1, 1);
        side(i + 1, 0);
        b.end_face();
    }
    for (const std::uint32_t row : {0u, 1u}) {
        for (std::uint32_t k = 0; k < segments; ++k) {
            const std::uint32_t i = row == 0 ? k : segments - 1 - k;
            const glm::dvec2 t = turn(i, segments);
            b.corner(row * segments + i, {0.5 + 0.5 * t.x, 0.5 - (row == 0 ? 0.5 : -0.5) * t.y});
        }
        b.end_face();
    }
    return std::move(b.mesh);
}

Mesh torus_shape(float radius, float tube, std::uint32_t segments, std::uint32_t sides) {
    Builder b;
    for (std::uint32_t i = 0; i < segments; ++i) {
        const glm::dvec2 around = turn(i, segments);
        for (std::uint32_t j = 0; j < sides; ++j) {
            const glm::dvec2 t = turn(j, sides);
            const double r = radius + tube * t.x;
            b.mesh.positions.emplace_back(r * around.x, tube * t.y, -r * around.y);
        }
    }
    const auto add = [&](std::uint32_t i, std::uint32_t j) {
        b.corner((i % segments) * sides + j % sides,
                 {fraction(i, segments), 1.0f - fraction(j, sides)});
    };
    for (std::uint32_t i = 0; i < segments; ++i) {
        for (std::uint32_t j = 0; j < sides; ++j) {
            add(i, j);
            add(i + 1, j);
            add(i + 1, j + 1);
            add(i, j + 1);
            b.end_face();
        }
    }
    return std::move(b.mesh);
}

}  // namespace prep::detail
