#include "shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace shapes {
namespace {

using Index = std::uint32_t;

template <class T>
void append_layer(prep::CornerLayer<T>& to, const prep::CornerLayer<T>& from,
                  const std::vector<Index>& corners) {
    to.values = from.values;
    if (from.empty()) return;
    for (const Index c : corners) to.indices.push_back(from.indices[c]);
}

}  // namespace

prep::Mesh mesh_of(std::vector<glm::vec3> positions, const Faces& faces) {
    prep::Mesh mesh;
    mesh.positions = std::move(positions);
    for (const auto& face : faces) {
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), face.begin(), face.end());
        mesh.face_offsets.push_back(Index(mesh.corner_vertices.size()));
    }
    return mesh;
}

prep::Mesh cube() {
    std::vector<glm::vec3> positions;
    for (int i = 0; i < 8; ++i)
        positions.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
    return mesh_of(
        std::move(positions),
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

prep::Mesh grid(Index width, Index depth) {
    std::vector<glm::vec3> positions;
    for (Index y = 0; y <= depth; ++y)
        for (Index x = 0; x <= width; ++x) positions.push_back({x, y, 0});
    Faces faces;
    for (Index y = 0; y < depth; ++y)
        for (Index x = 0; x < width; ++x) {
            const Index v = y * (width + 1) + x;
            faces.push_back({v, v + 1, v + width + 2, v + width + 1});
        }
    return mesh_of(std::move(positions), faces);
}

prep::Mesh uv_sphere(Index segments, Index rings) {
    std::vector<glm::vec3> positions{{0, 0, 1}};
    for (Index r = 1; r < rings; ++r)
        for (Index s = 0; s < segments; ++s) {
            const double theta = std::numbers::pi * r / rings;
            const double phi = 2 * std::numbers::pi * s / segments;
            positions.push_back({float(std::sin(theta) * std::cos(phi)),
                                 float(std::sin(theta) * std::sin(phi)), float(std::cos(theta))});
        }
    positions.push_back({0, 0, -1});
    const auto at = [&](Index r, Index s) { return 1 + (r - 1) * segments + s % segments; };
    const Index south = Index(positions.size()) - 1;
    Faces faces;
    for (Index s = 0; s < segments; ++s) faces.push_back({0, at(1, s), at(1, s + 1)});
    for (Index r = 1; r + 1 < rings; ++r)
        for (Index s = 0; s < segments; ++s)
            faces.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s + 1)});
    for (Index s = 0; s < segments; ++s)
        faces.push_back({south, at(rings - 1, s + 1), at(rings - 1, s)});
    return mesh_of(std::move(positions), faces);
}

prep::Mesh icosphere(int levels) {
    const double g = std::numbers::phi;
    std::vector<glm::dvec3> points{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                   {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                   {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    for (auto& p : points) p = glm::normalize(p);
    Faces faces{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<Index, Index>, Index> middles;
        const auto middle = [&](Index a, Index b) {
            const auto [it, fresh] = middles.try_emplace(std::minmax(a, b), Index(points.size()));
            if (fresh) points.push_back(glm::normalize(points[a] + points[b]));
            return it->second;
        };
        Faces finer;
        for (const auto& f : faces) {
            const Index ab = middle(f[0], f[1]), bc = middle(f[1], f[2]), ca = middle(f[2], f[0]);
            finer.push_back({f[0], ab, ca});
            finer.push_back({f[1], bc, ab});
            finer.push_back({f[2], ca, bc});
            finer.push_back({ab, bc, ca});
        }
        faces = std::move(finer);
    }
    return mesh_of({points.begin(), points.end()}, faces);
}

prep::Mesh prism(const std::vector<glm::vec2>& outline) {
    const Index n = Index(outline.size());
    std::vector<glm::vec3> positions;
    for (const float z : {-1.0f, 1.0f})
        for (const glm::vec2& p : outline) positions.push_back({p.x, p.y, z});
    Faces faces;
    std::vector<Index> bottom, top;
    for (Index s = 0; s < n; ++s) {
        const Index t = (s + 1) % n;
        faces.push_back({s, t, n + t, n + s});
        bottom.push_back(n - 1 - s);
        top.push_back(n + s);
    }
    faces.push_back(bottom);
    faces.push_back(top);
    return mesh_of(std::move(positions), faces);
}

prep::Mesh cylinder(Index segments) {
    std::vector<glm::vec2> circle;
    for (Index s = 0; s < segments; ++s) {
        const double phi = 2 * std::numbers::pi * s / segments;
        circle.push_back({float(std::cos(phi)), float(std::sin(phi))});
    }
    return prism(circle);
}

prep::Mesh torus(Index around, Index across) {
    std::vector<glm::vec3> positions;
    for (Index i = 0; i < around; ++i)
        for (Index j = 0; j < across; ++j) {
            const double u = 2 * std::numbers::pi * i / around;
            const double v = 2 * std::numbers::pi * j / across;
            const double r = 1 + 0.4 * std::cos(v);
            positions.push_back(
                {float(r * std::cos(u)), float(r * std::sin(u)), float(0.4 * std::sin(v))});
        }
    const auto at = [&](Index i, Index j) { return i % around * across + j % across; };
    Faces faces;
    for (Index i = 0; i < around; ++i)
        for (Index j = 0; j < across; ++j)
            faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    return mesh_of(std::move(positions), faces);
}

prep::Mesh fan(Index valence, double height) {
    std::vector<glm::vec3> positions{{0, 0, 0}};
    Faces faces;
    for (Index i = 0; i < valence; ++i) {
        const double phi = 2 * std::numbers::pi * i / valence;
        positions.push_back({float(std::cos(phi)), float(std::sin(phi)), float(-height)});
        faces.push_back({0, 1 + i, 1 + (i + 1) % valence});
    }
    return mesh_of(std::move(positions), faces);
}

prep::Mesh wedge(const glm::ivec3& n0, const glm::ivec3& n1) {
    const auto cross = [](const glm::ivec3& a, const glm::ivec3& b) {
        return glm::ivec3{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    };
    const glm::ivec3 edge = cross(n0, n1);
    // n × edge lies in the plane of n; edge × (n × edge) = n · |edge|².
    const glm::ivec3 left = cross(n0, edge), right = -cross(n1, edge);
    return mesh_of({glm::vec3(0), glm::vec3(edge), glm::vec3(left), glm::vec3(right)},
                   {{0, 1, 2}, {1, 0, 3}});
}

prep::Mesh bow_tie() {
    std::vector<glm::vec3> positions{{0, 0, 0},  {1, 0, 1},   {-1, 1, 1},  {-1, -1, 1},
                                     {1, 0, -1}, {-1, 1, -1}, {-1, -1, -1}};
    return mesh_of(
        std::move(positions),
        {{1, 2, 3}, {0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {4, 6, 5}, {0, 4, 5}, {0, 5, 6}, {0, 6, 4}});
}

prep::Mesh book(Index faces, bool alternating) {
    std::vector<glm::vec3> positions{{0, 0, 0}, {0, 0, 1}};
    Faces list;
    for (Index i = 0; i < faces; ++i) {
        const double phi = 2 * std::numbers::pi * i / faces;
        positions.push_back({float(std::cos(phi)), float(std::sin(phi)), 0.5f});
        if (alternating && i % 2 == 1)
            list.push_back({1, 0, i + 2});
        else
            list.push_back({0, 1, i + 2});
    }
    return mesh_of(std::move(positions), list);
}

prep::Mesh moebius(Index segments) {
    std::vector<glm::vec3> positions;
    for (Index i = 0; i < segments; ++i) {
        const double u = 2 * std::numbers::pi * i / segments;
        for (const double s : {-0.3, 0.3}) {
            const double r = 1 + s * std::cos(u / 2);
            positions.push_back(
                {float(r * std::cos(u)), float(r * std::sin(u)), float(s * std::sin(u / 2))});
        }
    }
    Faces faces;
    for (Index i = 0; i < segments; ++i) {
        const bool last = i + 1 == segments;
        const Index a = 2 * i, b = 2 * i + 1;
        const Index c = last ? 0 : 2 * i + 3, d = last ? 1 : 2 * i + 2;
        faces.push_back({a, d, c, b});
    }
    return mesh_of(std::move(positions), faces);
}

prep::Mesh polygon(const std::vector<glm::vec3>& corners) {
    std::vector<Index> face;
    for (Index i = 0; i < corners.size(); ++i) face.push_back(i);
    return mesh_of(corners, {face});
}

prep::Mesh soup(const prep::Mesh& mesh) {
    prep::Mesh result = mesh;
    result.positions.clear();
    for (Index c = 0; c < mesh.corner_count(); ++c) {
        result.positions.push_back(mesh.positions[mesh.corner_vertices[c]]);
        result.corner_vertices[c] = c;
    }
    return result;
}

prep::Mesh fan_triangulated(const prep::Mesh& mesh, Index first) {
    Faces faces;
    for (Index f = 0; f < mesh.face_count(); ++f) {
        const Index begin = mesh.face_offsets[f], size = mesh.face_offsets[f + 1] - begin;
        const auto at = [&](Index k) { return mesh.corner_vertices[begin + (first + k) % size]; };
        for (Index k = 1; k + 1 < size; ++k) faces.push_back({at(0), at(k), at(k + 1)});
    }
    return mesh_of(mesh.positions, faces);
}

prep::Mesh with_face_order(const prep::Mesh& mesh, std::span<const Index> order) {
    prep::Mesh result = mesh;
    result.face_offsets = {0};
    result.corner_vertices.clear();
    std::vector<Index> corners;
    for (const Index f : order) {
        for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            corners.push_back(c);
        result.face_offsets.push_back(Index(corners.size()));
    }
    for (const Index c : corners) result.corner_vertices.push_back(mesh.corner_vertices[c]);
    const auto follow = [&](std::vector<Index>& to, const std::vector<Index>& from) {
        if (from.empty()) return;
        for (std::size_t i = 0; i < order.size(); ++i) to[i] = from[order[i]];
    };
    follow(result.face_materials, mesh.face_materials);
    follow(result.face_smoothing, mesh.face_smoothing);
    follow(result.face_parts, mesh.face_parts);
    result.normals = {};
    append_layer(result.normals, mesh.normals, corners);
    result.tangents = {};
    append_layer(result.tangents, mesh.tangents, corners);
    for (std::size_t s = 0; s < mesh.uvs.size(); ++s) {
        result.uvs[s] = {};
        append_layer(result.uvs[s], mesh.uvs[s], corners);
    }
    for (std::size_t s = 0; s < mesh.colors.size(); ++s) {
        result.colors[s] = {};
        append_layer(result.colors[s], mesh.colors[s], corners);
    }
    return result;
}

prep::Mesh with_vertex_order(const prep::Mesh& mesh, std::span<const Index> new_index) {
    prep::Mesh result = mesh;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
        result.positions[new_index[v]] = mesh.positions[v];
    for (Index& v : result.corner_vertices) v = new_index[v];
    for (Index& v : result.line_vertices) v = new_index[v];
    for (Index& v : result.points) v = new_index[v];
    for (glm::uvec2& e : result.hard_marks) e = {new_index[e.x], new_index[e.y]};
    return result;
}

prep::Mesh joined(const prep::Mesh& a, const prep::Mesh& b) {
    prep::Mesh result = a;
    const Index vertices = Index(a.vertex_count()), corners = Index(a.corner_count());
    result.positions.insert(result.positions.end(), b.positions.begin(), b.positions.end());
    for (const Index v : b.corner_vertices) result.corner_vertices.push_back(v + vertices);
    for (std::size_t f = 1; f < b.face_offsets.size(); ++f)
        result.face_offsets.push_back(b.face_offsets[f] + corners);
    return result;
}

std::vector<Index> random_order(std::size_t count, std::mt19937_64& random) {
    std::vector<Index> order(count);
    for (Index i = 0; i < count; ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    return order;
}

void jitter(prep::Mesh& mesh, float amount, std::mt19937_64& random) {
    std::uniform_real_distribution<float> offset(-amount, amount);
    for (glm::vec3& p : mesh.positions) {
        // One after the other: the order of arguments is the compiler's.
        for (const int axis : {2, 1, 0}) p[axis] += offset(random);
    }
}

prep::Mesh random_triangles(std::size_t vertices, std::size_t faces, std::mt19937_64& random) {
    std::uniform_real_distribution<float> coordinate(-1, 1);
    std::vector<glm::vec3> positions(vertices);
    for (glm::vec3& p : positions) p = {coordinate(random), coordinate(random), coordinate(random)};
    std::uniform_int_distribution<Index> vertex(0, Index(vertices) - 1);
    Faces list;
    for (std::size_t f = 0; f < faces; ++f)
        list.push_back({vertex(random), vertex(random), vertex(random)});
    return mesh_of(std::move(positions), list);
}

}  // namespace shapes
