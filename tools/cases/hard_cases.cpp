#include "hard_cases.h"

#include <cmath>
#include <functional>
#include <random>

#include "shapes.h"

namespace hard_cases {
namespace {

using prep::Mesh;

// A torus whose quads are not planar.
Mesh rough_torus() {
    std::mt19937_64 random(61);
    Mesh mesh = shapes::torus(12, 8);
    shapes::jitter(mesh, 0.08f, random);
    return mesh;
}

Mesh mapped(Mesh mesh, const std::function<glm::dvec3(const glm::dvec3&)>& map) {
    for (glm::vec3& p : mesh.positions) p = glm::vec3(map(glm::dvec3(p)));
    return mesh;
}

glm::dvec3 turned(const glm::dvec3& p) {  // by an arbitrary rotation
    const double c = std::cos(0.7), s = std::sin(0.7);
    const glm::dvec3 q(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
    return {q.x, c * q.y - s * q.z, s * q.y + c * q.z};
}

// A rough sheet of triangles whose steps along y are `aspect` times shorter than along x.
Mesh slivers(double aspect, bool turn) {
    std::mt19937_64 random(62);
    std::uniform_real_distribution<double> rough(-0.3, 0.3);
    Mesh mesh = shapes::fan_triangulated(shapes::grid(8, 8));
    return mapped(std::move(mesh), [&](const glm::dvec3& p) {
        // Drawn one after the other: the order of arguments is the compiler's.
        const double z = rough(random), y = rough(random), x = rough(random);
        const glm::dvec3 q(p.x + x, (p.y + y) / aspect, z / aspect);
        return turn ? turned(q) : q;
    });
}

Mesh pole(std::uint32_t valence) {
    std::mt19937_64 random(63);
    Mesh mesh = shapes::fan(valence);
    shapes::jitter(mesh, 0.3f / float(valence), random);
    return mesh;
}

// Two sheets on one rim, `thickness` apart in the middle: at the rim their normals cancel but for
// their tilt.
Mesh pillow(double thickness) {
    const std::uint32_t n = 6;
    std::mt19937_64 random(64);
    std::uniform_real_distribution<double> rough(-0.2, 0.2);
    Mesh mesh = shapes::grid(n, n);
    const auto on_rim = [&](const glm::vec3& p) {
        return p.x == 0 || p.y == 0 || p.x == n || p.y == n;
    };
    std::vector<glm::vec3> positions = mesh.positions;
    shapes::Faces faces;
    std::vector<std::uint32_t> below(positions.size());
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        below[v] = v;
        if (on_rim(mesh.positions[v])) continue;
        below[v] = std::uint32_t(positions.size());
        positions.push_back(positions[v]);
        positions[v].z = float(thickness * (1 + rough(random)));
        positions.back().z = float(-thickness * (1 + rough(random)));
    }
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto at = [&](int k) { return mesh.corner_vertices[4 * f + k]; };
        faces.push_back({at(0), at(1), at(2), at(3)});
        faces.push_back({below[at(3)], below[at(2)], below[at(1)], below[at(0)]});
    }
    return shapes::mesh_of(std::move(positions), faces);
}

}  // namespace

std::vector<Case> measured() {
    std::vector<Case> cases;
    const Mesh quads = rough_torus(), triangles = shapes::fan_triangulated(quads);
    for (const int e : {-44, -38, -30, -20, -10, 0, 10, 20, 30, 38}) {
        const double scale = std::pow(10.0, e);
        const auto map = [&](const glm::dvec3& p) { return p * scale; };
        cases.push_back({"scale", scale, mapped(triangles, map)});
        cases.push_back({"scale, quads", scale, mapped(quads, map)});
    }
    for (const double offset : {0.0, 1.0, 1e2, 1e4, 1e5, 1e6, 1e7}) {
        const auto map = [&](const glm::dvec3& p) { return p + offset * glm::dvec3(1, 0.7, -0.3); };
        cases.push_back({"offset", offset, mapped(triangles, map)});
        cases.push_back({"offset, quads", offset, mapped(quads, map)});
    }
    for (const double aspect : {1.0, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12}) {
        cases.push_back({"aspect", aspect, slivers(aspect, false)});
        cases.push_back({"aspect, turned", aspect, slivers(aspect, true)});
    }
    for (const std::uint32_t valence : {3u, 10u, 100u, 1000u, 10'000u, 100'000u})
        cases.push_back({"valence", double(valence), pole(valence)});
    for (const double thickness : {1.0, 1e-3, 1e-6, 1e-10, 1e-20, 1e-30, 1e-44})
        cases.push_back({"thickness", thickness, pillow(thickness)});
    return cases;
}

}  // namespace hard_cases
