// Cages whose limit surfaces are tessellated, of both schemes: closed ones and others, with creases
// and corners of every kind.
#pragma once

#include "tessellation/limit/limit_base.h"
#include "tessellation_checks.h"

namespace tessellation_checks {

// A vertex where `n` quads meet, at the tip of a cone, with a border.
inline prep::Mesh cone(std::uint32_t n) {
    prep::Mesh mesh;
    mesh.positions.emplace_back(0, 0, 1);
    for (std::uint32_t k = 0; k < 2 * n; ++k) {
        const double a = std::numbers::pi * k / n;
        const double r = k % 2 == 0 ? 1 : 1.4;
        mesh.positions.emplace_back(r * std::cos(a), r * std::sin(a), k % 2 == 0 ? 0.2 : 0);
    }
    for (std::uint32_t k = 0; k < n; ++k)
        add_face(mesh, {0, 1 + 2 * k, 2 + 2 * k, 1 + (2 * k + 2) % (2 * n)});
    return mesh;
}

inline prep::Mesh creased_cube(float sharpness) {
    prep::Mesh mesh = cube();
    mesh.subdivision.creases = {{0, 1, sharpness}, {1, 3, sharpness}, {4, 5, sharpness / 2}};
    return mesh;
}

// Polygons as fans of triangles; creases stay.
inline prep::Mesh in_triangles(const prep::Mesh& polygons) {
    prep::Mesh mesh;
    mesh.positions = polygons.positions;
    mesh.subdivision.creases = polygons.subdivision.creases;
    for (std::uint32_t f = 0; f < polygons.face_count(); ++f) {
        const auto* const v = polygons.corner_vertices.data() + polygons.face_offsets[f];
        for (std::uint32_t k = 2; k < polygons.face_offsets[f + 1] - polygons.face_offsets[f]; ++k)
            add_face(mesh, {v[0], v[k - 1], v[k]});
    }
    return mesh;
}

// A vertex where `n` triangles meet, at the tip of a cone; around it another ring of them.
inline prep::Mesh wide_cone(std::uint32_t n) {
    prep::Mesh mesh;
    mesh.positions.emplace_back(0, 0, 1);
    for (const double r : {1.0, 2.0})
        for (std::uint32_t k = 0; k < n; ++k) {
            const double a = 2 * std::numbers::pi * k / n;
            mesh.positions.emplace_back(r * std::cos(a), r * std::sin(a), r == 1 ? 0.3 : 0.1);
        }
    for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t p = 1 + k, q = 1 + (k + 1) % n;
        add_face(mesh, {0, p, q});
        add_face(mesh, {p, p + n, q + n});
        add_face(mesh, {p, q + n, q});
    }
    return mesh;
}

struct Cage {
    prep::Mesh mesh;
    prep::SubdivisionScheme scheme;
};

inline prep::Result<prep::detail::LimitBase> base_of(const Cage& cage) {
    prep::SubdivideOptions options;
    options.scheme = cage.scheme;
    return prep::detail::LimitBase::make(cage.mesh, options, true);
}
inline prep::detail::Domain domain_of(const Cage& cage, const prep::detail::LimitBase& base) {
    return prep::detail::make_domain(cage.mesh, base.left_out(), false, 1);
}

// A triangle within a root, and the surface at its corners.
struct SampledTriangle {
    const prep::detail::BaseSurface& base;
    std::uint32_t root;
    std::array<glm::dvec3, 3> weights;
    std::array<prep::detail::BasePoint, 3> corners;

    SampledTriangle(const prep::detail::BaseSurface& surface, std::uint32_t of_root,
                    std::uint64_t path)
        : base(surface), root(of_root), weights(prep::detail::path_weights(path)) {
        for (std::size_t k = 0; k < 3; ++k) {
            const prep::detail::RootPoint at{root, weights[k]};
            base.evaluate({&at, 1}, {&corners[k], 1});
        }
    }
    prep::detail::BaseDeviation bound() const { return base.deviation(root, weights, corners); }
    // How far the surface is from what is linear, at weights of the corners.
    prep::detail::BaseDeviation off(const glm::dvec3& w) const {
        prep::detail::RootPoint at{root, glm::dvec3(0.0)};
        glm::dvec3 position(0.0), direction(0.0);
        for (std::size_t k = 0; k < 3; ++k) {
            const double share = w[glm::length_t(k)];
            at.weights += share * weights[k];
            position += share * corners[k].position;
            direction += share * corners[k].direction;
        }
        prep::detail::BasePoint point;
        base.evaluate({&at, 1}, {&point, 1});
        return {glm::length(point.position - position), glm::length(point.direction - direction)};
    }
};

inline std::vector<Cage> cages() {
    std::vector<Cage> all;
    for (const prep::Mesh& mesh : {cube(), torus(6, 5), prism(3), prism(5), prism(9), cone(3),
                                   cone(8), creased_cube(10), creased_cube(2.5F)})
        all.push_back({mesh, prep::SubdivisionScheme::catmark});
    for (const prep::Mesh& mesh : {cube(), torus(6, 5), prism(3), cone(8), wide_cone(3),
                                   wide_cone(9), creased_cube(10), creased_cube(2.5F)})
        all.push_back({in_triangles(mesh), prep::SubdivisionScheme::loop});
    return all;
}

}  // namespace tessellation_checks
