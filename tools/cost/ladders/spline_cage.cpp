#include "cost/ladders/spline_cage.h"

#include <algorithm>
#include <cmath>

#include "cost/measure/surface_distance.h"

namespace cost {
namespace {

constexpr int cage_around = 8, cage_across = 6;

// Points of a torus, every other ring pushed out: no circle, so that nothing is exact by symmetry.
// Floats, as meshes have them.
std::vector<Vector> control_points() {
    std::vector<Vector> points;
    for (int i = 0; i < cage_around; ++i) {
        for (int j = 0; j < cage_across; ++j) {
            const SurfaceSample s = torus_at(Real(i) / cage_around, Real(j) / cage_across, 1,
                                             i % 2 == 0 ? Real(0.5) : Real(0.375));
            points.push_back(Vector(glm::vec3(s.position)));
        }
    }
    return points;
}

}  // namespace

SplineCage::SplineCage() : limit(control_points(), cage_around, cage_across) {
    glm::vec3 low(1e30f), high(-1e30f);
    for (const Vector& p : control_points()) {
        mesh.positions.push_back(glm::vec3(p));
        low = glm::min(low, mesh.positions.back());
        high = glm::max(high, mesh.positions.back());
    }
    diagonal = double(glm::length(high - low));
    const auto vertex = [](int i, int j) {
        return std::uint32_t((i % cage_around) * cage_across + j % cage_across);
    };
    for (int i = 0; i < cage_around; ++i) {
        for (int j = 0; j < cage_across; ++j) {
            for (const std::uint32_t v :
                 {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)})
                mesh.corner_vertices.push_back(v);
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        }
    }
}

LimitErrors limit_errors(const SplineCage& cage, const prep::Mesh& mesh, std::size_t most) {
    LimitErrors errors;
    const std::size_t faces = mesh.face_count();
    // Odd: four children in a row take turns.
    const std::size_t stride = (faces / std::max<std::size_t>(most, 1)) | 1;
    const auto measure = [&](const Vector& p) {
        errors.distances.push_back(double(cage.limit.nearest(p).distance / cage.diagonal));
    };
    for (std::size_t f = 0; f < faces; f += stride) {
        Vector middle(0);
        const std::uint32_t first = mesh.face_offsets[f], last = mesh.face_offsets[f + 1];
        for (std::uint32_t c = first; c < last; ++c) {
            const Vector a(mesh.positions[mesh.corner_vertices[c]]);
            const Vector b(mesh.positions[mesh.corner_vertices[c + 1 < last ? c + 1 : first]]);
            middle += a;
            measure(a);
            measure((a + b) / Real(2));
        }
        middle /= Real(last - first);
        const SplineTorus::Nearest nearest = cage.limit.nearest(middle);
        errors.distances.push_back(double(nearest.distance / cage.diagonal));
        if (mesh.normals.empty() || mesh.normals.indices[first] == prep::no_index) continue;
        Vector mean(0);
        for (std::uint32_t c = first; c < last; ++c)
            if (mesh.normals.indices[c] != prep::no_index)
                mean += Vector(mesh.normals.values[mesh.normals.indices[c]]);
        errors.inside.push_back(degrees_between(mean, nearest.normal));
        const Vector corner(mesh.positions[mesh.corner_vertices[first]]);
        errors.degrees.push_back(
            degrees_between(Vector(mesh.normals.values[mesh.normals.indices[first]]),
                            cage.limit.nearest(corner).normal));
    }
    return errors;
}

double farthest_from(const SplineCage& cage, const prep::Mesh& mesh) {
    std::vector<Triangle> points, triangles;
    // Roberts' R2 sequence (2018): no two lie alike within the faces of any level.
    for (int i = 0; i < 3072; ++i) {
        const Real u = Real(i) * Real(0.75487766624669276L),
                   v = Real(i) * Real(0.56984029099805327L);
        const glm::dvec3 p(
            cage.limit.at(cage_around * (u - std::floor(u)), cage_across * (v - std::floor(v)))
                .position);
        points.push_back({p, p, p});
    }
    const auto corner = [&](std::uint32_t c) {
        return glm::dvec3(mesh.positions[mesh.corner_vertices[c]]);
    };
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f] + 1; c + 1 < mesh.face_offsets[f + 1]; ++c)
            triangles.push_back({corner(mesh.face_offsets[f]), corner(c), corner(c + 1)});
    return one_sided_distance(points, triangles).high / cage.diagonal;
}

}  // namespace cost
