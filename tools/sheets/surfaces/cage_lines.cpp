#include "sheets/surfaces/cage_lines.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace report {
namespace {

using Ends = std::pair<std::uint32_t, std::uint32_t>;

struct Edge {
    std::uint32_t face, corner, v0, v1;  // the corner's number in its face
    float sharpness;
};

Ends ends(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

// Each edge at the first face that `wanted` accepts.
template <class Wanted>
std::vector<Edge> edges_of(const prep::Mesh& cage, const Wanted& wanted) {
    std::map<Ends, float> sharpness;
    for (const prep::EdgeMark& mark : cage.subdivision.creases) {
        float& s = sharpness[ends(mark.v0, mark.v1)];
        s = std::max(s, mark.sharpness);
    }
    std::vector<Edge> edges;
    std::map<Ends, bool> known;
    for (std::uint32_t f = 0; f < cage.face_count(); ++f) {
        if (!wanted(f)) continue;
        const std::uint32_t first = cage.face_offsets[f], size = cage.face_offsets[f + 1] - first;
        for (std::uint32_t k = 0; k < size; ++k) {
            const std::uint32_t v0 = cage.corner_vertices[first + k];
            const std::uint32_t v1 = cage.corner_vertices[first + (k + 1) % size];
            if (!known.try_emplace(ends(v0, v1), true).second) continue;
            const auto crease = sharpness.find(ends(v0, v1));
            edges.push_back({f, k, v0, v1, crease == sharpness.end() ? 0 : crease->second});
        }
    }
    return edges;
}

// Where a face's edge is after a part t of it, in the parameters of prep/subdivide.h.
prep::SurfaceLocation along(const Edge& edge, std::uint32_t size, bool loop, double t) {
    if (loop) {
        const glm::dvec2 corners[] = {{0, 0}, {1, 0}, {0, 1}, {0, 0}};
        const glm::dvec2 at = glm::mix(corners[edge.corner], corners[edge.corner + 1], t);
        return {edge.face, at.x, at.y};
    }
    if (size == 4) {
        const glm::dvec2 corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
        const glm::dvec2 at = glm::mix(corners[edge.corner], corners[edge.corner + 1], t);
        return {edge.face, at.x, at.y};
    }
    const auto d = std::uint32_t(1 + std::floor(std::sqrt(double(size - 1))));
    const std::uint32_t next = (edge.corner + 1) % size;
    if (t <= 0.5) return {edge.face, edge.corner % d + t, double(edge.corner / d)};
    return {edge.face, double(next % d), next / d + (1 - t)};
}

}  // namespace

std::vector<CageLine> cage_edges(const prep::Mesh& cage) {
    std::vector<CageLine> lines;
    for (const Edge& edge : edges_of(cage, [](std::uint32_t) { return true; }))
        lines.push_back({{glm::dvec3(cage.positions[edge.v0]) + cage.origin,
                          glm::dvec3(cage.positions[edge.v1]) + cage.origin},
                         edge.sharpness});
    return lines;
}

prep::Result<std::vector<CageLine>> limit_edges(const prep::Mesh& cage,
                                                const prep::SubdivideOptions& options) {
    const auto surface = prep::LimitSurface::make(cage, options);
    if (!surface) return surface.error();
    const bool loop = options.scheme == prep::SubdivisionScheme::loop;
    constexpr std::size_t segments = 16;
    std::vector<CageLine> lines;
    std::vector<prep::SurfaceLocation> places;
    for (const Edge& edge :
         edges_of(cage, [&](std::uint32_t f) { return surface->has_limit(f); })) {
        lines.push_back({{}, edge.sharpness});
        const std::uint32_t size = cage.face_offsets[edge.face + 1] - cage.face_offsets[edge.face];
        for (std::size_t k = 0; k <= segments; ++k)
            places.push_back(along(edge, size, loop, double(k) / segments));
    }
    std::vector<prep::SurfacePoint> points(places.size());
    surface->evaluate(places, points);
    for (std::size_t k = 0; k < points.size(); ++k)
        lines[k / (segments + 1)].points.push_back(points[k].position + cage.origin);
    return lines;
}

std::vector<std::uint32_t> extraordinary_vertices(const prep::Mesh& mesh,
                                                  const prep::Topology& topology, bool loop) {
    std::vector<bool> border(mesh.vertex_count());
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        if (topology.kinds[c] != prep::EdgeKind::border) continue;
        const std::uint32_t next =
            prep::next_corner(mesh.face_offsets, topology.corner_faces[c], c);
        for (const std::uint32_t corner : {c, next})
            border[topology.welded[mesh.corner_vertices[corner]]] = true;
    }
    const std::uint32_t inside = loop ? 6 : 4, at_border = inside / 2;
    std::vector<std::uint32_t> found;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        const std::uint32_t faces = topology.point_offsets[v + 1] - topology.point_offsets[v];
        if (faces == 0) continue;
        if (border[v] ? faces != 1 && faces != at_border : faces != inside) found.push_back(v);
    }
    return found;
}

}  // namespace report
