// The defects of hard_cases.h.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "hard_cases.h"
#include "shapes.h"

namespace hard_cases {
namespace {

using prep::Mesh;
using Index = std::uint32_t;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

Mesh torus() {
    return shapes::torus(12, 8);
}

// Every face again, turned round or not.
Mesh with_twins(Mesh mesh, bool turned) {
    const Index faces = Index(mesh.face_count());
    for (Index f = 0; f < faces; ++f) {
        const Index begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        for (Index k = 0; k < end - begin; ++k)
            mesh.corner_vertices.push_back(mesh.corner_vertices[turned ? end - 1 - k : begin + k]);
        mesh.face_offsets.push_back(Index(mesh.corner_vertices.size()));
    }
    return mesh;
}

Mesh with_turned_faces(Mesh mesh, Index each) {
    for (Index f = 0; f < mesh.face_count(); f += each)
        std::reverse(mesh.corner_vertices.begin() + mesh.face_offsets[f],
                     mesh.corner_vertices.begin() + mesh.face_offsets[f + 1]);
    return mesh;
}

// Edges of no length, faces of no area, a face all at one point.
Mesh collapsed() {
    Mesh mesh = shapes::fan_triangulated(torus());
    for (const Index v : {3u, 17u, 40u, 41u, 42u})
        mesh.positions[v] = mesh.positions[mesh.corner_vertices[3 * v]];
    mesh.positions[60] = 0.5f * (mesh.positions[61] + mesh.positions[59]);
    for (const Index v : {5u, 5u, 6u, 7u, 7u, 7u}) mesh.corner_vertices.push_back(v);
    for (int i = 0; i < 2; ++i) mesh.face_offsets.push_back(mesh.face_offsets.back() + 3);
    return mesh;
}

// A polygon on a circle: every `step`-th corner (2: a star that crosses itself), every second
// `inner` times as far from the middle, `height` off the plane.
Mesh round_polygon(Index corners, Index step, double inner, double height) {
    std::vector<glm::vec3> points;
    for (Index i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * double(i) * step / corners;
        const double radius = i % 2 == 1 ? inner : 1;
        points.push_back(
            {radius * std::cos(angle), radius * std::sin(angle), height * std::cos(3 * angle)});
    }
    return shapes::polygon(points);
}

template <class Make>
Mesh with_uvs_from(Mesh mesh, const Make& make) {
    mesh = with_uvs(std::move(mesh));
    for (glm::vec2& uv : mesh.uvs[0].values) uv = make(uv);
    return mesh;
}

template <class Make>
Mesh with_normals_from(Mesh mesh, const Make& make) {
    for (Index v = 0; v < mesh.vertex_count(); ++v)
        mesh.normals.values.push_back(make(v, mesh.positions[v]));
    mesh.normals.indices = mesh.corner_vertices;
    return mesh;
}

Mesh with_position(Mesh mesh, Index vertex, const glm::vec3& position) {
    mesh.positions[vertex] = position;
    return mesh;
}

Mesh any_floats() {
    std::mt19937_64 random(71);
    Mesh mesh = shapes::random_triangles(40, 80, random);
    for (glm::vec3& p : mesh.positions)
        for (int k = 0; k < 3; ++k) {
            const float x = std::bit_cast<float>(Index(random()));
            p[k] = std::isfinite(x) ? x : 0.0f;
        }
    return mesh;
}

glm::dmat4 linear(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) {
    return glm::dmat4(glm::dmat3(x, y, z));
}

}  // namespace

Mesh with_uvs(Mesh mesh) {
    if (!mesh.uvs.empty()) return mesh;
    glm::dvec3 low(0), high(0);
    bool any = false;
    for (const glm::vec3& p : mesh.positions) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) continue;
        low = any ? glm::min(low, glm::dvec3(p)) : glm::dvec3(p);
        high = any ? glm::max(high, glm::dvec3(p)) : glm::dvec3(p);
        any = true;
    }
    mesh.uvs.resize(1);
    for (const glm::vec3& p : mesh.positions) {
        glm::dvec2 uv(0.5);
        for (int k = 0; k < 2; ++k)
            if (high[k] > low[k]) uv[k] = (double(p[k]) - low[k]) / (high[k] - low[k]);
        mesh.uvs[0].values.push_back(glm::vec2(uv));
    }
    mesh.uvs[0].indices = mesh.corner_vertices;
    return mesh;
}

prep::Scene scene_of(const Case& hard_case) {
    prep::Scene scene;
    scene.meshes.push_back(hard_case.mesh);
    prep::Node node;
    node.mesh = 0;
    node.transform = hard_case.transform;
    scene.nodes.push_back(node);
    return scene;
}

std::vector<Case> odd() {
    std::vector<Case> cases;
    const auto add = [&](const char* axis, double value, Mesh mesh) {
        cases.push_back({axis, value, std::move(mesh)});
    };
    add("faces without area", 0, collapsed());
    add("repeated vertices", 0, shapes::soup(torus()));
    add("repeated faces", 0, with_twins(torus(), false));
    add("opposite faces", 0, with_twins(torus(), true));
    add("bow-tie", 0, shapes::bow_tie());
    for (const Index faces : {3u, 4u, 16u, 64u}) {
        add("faces at an edge", faces, shapes::book(faces, false));
        add("faces at an edge, alternating", faces, shapes::book(faces, true));
    }
    add("Möbius strip", 13, shapes::moebius(13));
    add("mixed orientation", 3, with_turned_faces(torus(), 3));
    add("pole", 100'000, shapes::uv_sphere(100'000, 2));
    add("concave polygon", 24, round_polygon(24, 1, 0.4, 0));
    add("non-planar polygon", 24, round_polygon(24, 1, 0.8, 0.2));
    add("self-crossing polygon", 5, round_polygon(5, 2, 1, 0));
    add("figure of eight", 4, shapes::polygon({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}));
    add("collinear corners", 6,
        shapes::polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}}));
    add("polygon of many corners", 10'000, round_polygon(10'000, 1, 0.9, 0.01));
    add("dihedral", 90, shapes::cube());
    add("dihedral", 0, shapes::fan_triangulated(shapes::grid(3, 3)));
    add("dihedral", 180,
        shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, 0.25f, 0}},
                        {{0, 1, 2}, {1, 0, 3}}));
    add("UVs: none", 0, torus());
    add("UVs: constant", 0, with_uvs_from(torus(), [](auto) { return glm::vec2(0.25f); }));
    add("UVs: mirrored", 0,
        with_uvs_from(torus(), [](auto uv) { return glm::vec2(std::abs(uv.x - 0.5f), uv.y); }));
    add("UVs: collinear", 0, with_uvs_from(torus(), [](auto uv) { return glm::vec2(uv.x); }));
    add("UVs: huge", 1e30, with_uvs_from(torus(), [](auto uv) { return uv * 1e30f; }));
    add("UVs: tiny", 1e-30, with_uvs_from(torus(), [](auto uv) { return uv * 1e-30f; }));
    add("UVs: NaN", 0,
        with_uvs_from(torus(), [](auto uv) { return uv.x > 0.7f ? glm::vec2(nan, inf) : uv; }));
    add("normals: zero", 0, with_normals_from(torus(), [](Index v, auto p) {
            return v % 5 == 0 ? glm::vec3(0) : glm::normalize(p);
        }));
    add("normals: not unit", 1e20, with_normals_from(torus(), [](Index v, auto p) {
            return glm::normalize(p) * (v % 3 == 0 ? 1e20f : v % 3 == 1 ? 1e-20f : 2.0f);
        }));
    add("normals: NaN", 0, with_normals_from(torus(), [](Index v, auto p) {
            return v % 5 == 0 ? glm::vec3(nan, 0, inf) : glm::normalize(p);
        }));
    add("normals: opposite", -1,
        with_normals_from(torus(), [](Index, auto p) { return -glm::normalize(p); }));
    add("NaN position", 0, with_position(torus(), 7, {nan, 0, 0}));
    add("infinite position", 0, with_position(torus(), 7, {0, -inf, 0}));
    Mesh tiny = torus();
    for (glm::vec3& p : tiny.positions) p *= 1e-42f;
    add("denormal coordinates", 1e-42, tiny);
    Mesh signed_zeros = shapes::grid(4, 4);
    for (std::size_t v = 0; v < signed_zeros.vertex_count(); v += 2)
        signed_zeros.positions[v].z = -0.0f;
    add("negative zero", 0, signed_zeros);
    add("any floats", 0, any_floats());
    add("empty", 0, Mesh{});
    Mesh loose;
    loose.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    loose.points = {0};
    add("one point", 0, loose);
    loose.line_vertices = {0, 1, 2};
    loose.line_offsets = {0, 3};
    add("points and lines", 0, loose);
    const auto placed = [&](const char* name, double value, const glm::dmat4& transform) {
        cases.push_back({name, value, torus(), transform});
    };
    placed("transform: mirrored", -1, linear({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
    placed("transform: flat", 2, linear({1, 0, 0}, {0, 1, 0}, {0, 0, 0}));
    placed("transform: of one line", 1, linear({1, 2, 3}, {2, 4, 6}, {-1, -2, -3}));
    placed("transform: zero", 0, linear({0, 0, 0}, {0, 0, 0}, {0, 0, 0}));
    placed("transform: shear", 1e6, linear({1, 0, 0}, {1e6, 1, 0}, {0, 0, 1}));
    placed("transform: scale", 1e30, linear({1e30, 0, 0}, {0, 1e30, 0}, {0, 0, 1e30}));
    placed("transform: scale", 1e-30, linear({1e-30, 0, 0}, {0, 1e-30, 0}, {0, 0, 1e-30}));
    placed("transform: NaN", 0, linear({double(nan), 0, 0}, {0, 1, 0}, {0, 0, 1}));
    return cases;
}

}  // namespace hard_cases
