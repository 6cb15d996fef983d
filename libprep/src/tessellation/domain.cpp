#include "tessellation/domain.h"

#include <algorithm>
#include <optional>
#include <span>

#include "prep/triangulate.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Whether each triangle of the fan about the mean runs the way of them all.
bool is_star_shaped(const Mesh& mesh, Index first, Index last) {
    const auto at = [&](Index c) { return glm::dvec3(mesh.positions[mesh.corner_vertices[c]]); };
    glm::dvec3 mean(0.0);
    for (Index c = first; c < last; ++c) mean += at(c) - at(first);
    mean = mean / double(last - first) + at(first);
    const auto area = [&](Index c) {
        return glm::cross(at(c) - mean, at(c + 1 == last ? first : c + 1) - mean);
    };
    glm::dvec3 sum(0.0);
    for (Index c = first; c < last; ++c) sum += area(c);
    for (Index c = first; c < last; ++c)
        if (glm::dot(area(c), sum) < 0) return false;
    return true;
}

void add_fan(Domain& domain, const Mesh& mesh, Index face, std::span<const Index> corners) {
    const Index fan = domain.fans();
    const Index centre = domain.cage_vertices + fan;
    const auto first = Index(domain.roots.size()), count = Index(corners.size());
    for (Index k = 0; k < count; ++k) {
        const Index a = corners[k], b = corners[(k + 1) % count];
        domain.roots.push_back({face, fan, {a, b}});
        domain.vertices.push_back({mesh.corner_vertices[a], mesh.corner_vertices[b], centre});
        // b – centre is the next root's centre – a.
        domain.next_half_edges.push_back(3 * (first + k));
        domain.next_half_edges.push_back(3 * (first + (k + 1) % count) + 2);
        domain.next_half_edges.push_back(3 * (first + (k + count - 1) % count) + 1);
    }
    domain.fan_roots.push_back(first + count);
}

void link_edges(Domain& domain) {
    struct Edge {
        std::uint64_t vertices;
        Index root;
    };
    std::vector<Edge> edges;
    edges.reserve(domain.roots.size());
    for (Index r = 0; r < domain.roots.size(); ++r) {
        const auto [a, b] = std::minmax(domain.vertices[r][0], domain.vertices[r][1]);
        if (a != b) edges.push_back({std::uint64_t(a) << 32 | b, r});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) {
        return p.vertices != q.vertices ? p.vertices < q.vertices : p.root < q.root;
    });
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        while (end < edges.size() && edges[end].vertices == edges[begin].vertices) ++end;
        for (std::size_t k = begin; k < end; ++k)
            domain.next_half_edges[3 * edges[k].root] =
                3 * edges[k + 1 == end ? begin : k + 1].root;
    }
}

}  // namespace

Domain make_domain(const Mesh& mesh, const std::vector<std::uint8_t>& left_out, bool straight,
                   int threads) {
    Domain domain;
    domain.cage_vertices = Index(mesh.vertex_count());
    std::optional<Triangulation> cut;
    Index triangle = 0;
    std::vector<Index> corners;
    for (Index f = 0; f < mesh.face_count(); ++f) {
        if (!left_out.empty() && left_out[f]) continue;
        const Index first = mesh.face_offsets[f], last = mesh.face_offsets[f + 1];
        if (straight && last - first > 3 && !is_star_shaped(mesh, first, last)) {
            if (!cut) cut = triangulate(MeshView(mesh), threads);
            while (cut->triangle_faces[triangle] != f) ++triangle;
            for (; triangle < cut->triangle_faces.size() && cut->triangle_faces[triangle] == f;
                 ++triangle)
                add_fan(domain, mesh, f, std::span(cut->corners).subspan(3 * triangle, 3));
            continue;
        }
        corners.clear();
        for (Index c = first; c < last; ++c) corners.push_back(c);
        add_fan(domain, mesh, f, corners);
    }
    link_edges(domain);
    return domain;
}

}  // namespace prep::detail
