#include "subdivision/grid_numbering.h"

namespace prep::detail {

GridNumbering::GridNumbering(const NumberedTopology& topology, std::span<const std::uint8_t> kept,
                             int level, bool triangles)
    : topology_(topology), segments_(1U << level), triangles_(triangles) {
    const std::size_t faces = topology.face_offsets.size() - 1;
    vertices_.assign(topology.vertex_count, no_index);
    vertex_owners_.assign(topology.vertex_count, no_index);
    edges_.assign(topology.edge_count, no_index);
    edge_owners_.assign(topology.edge_count, no_index);
    faces_.assign(faces, no_index);
    const auto for_corners = [&](const auto& body) {
        for (std::size_t f = 0; f < faces; ++f)
            if (kept[f])
                for (std::uint32_t c = topology.face_offsets[f]; c < topology.face_offsets[f + 1];
                     ++c)
                    body(c);
    };
    for_corners([&](std::uint32_t c) {
        std::uint32_t& owner = vertex_owners_[topology.corner_vertices[c]];
        if (owner == no_index) owner = c;
    });
    // In the cage's own order.
    for (std::uint32_t v = 0; v < topology.vertex_count; ++v)
        if (vertex_owners_[v] != no_index) vertices_[v] = std::uint32_t(count_++);
    if (level == 0) return;
    for_corners([&](std::uint32_t c) {
        const std::uint32_t edge = topology.corner_edges[c];
        if (edge_owners_[edge] != no_index) return;
        edge_owners_[edge] = c;
        edges_[edge] = std::uint32_t(count_);
        count_ += segments_ - 1;
    });
    for (std::size_t f = 0; f < faces; ++f) {
        if (!kept[f]) continue;
        faces_[f] = std::uint32_t(count_);
        const std::uint64_t size = topology.face_offsets[f + 1] - topology.face_offsets[f];
        const std::uint64_t inner = segments_ - 1, half = segments_ / 2 - 1;
        count_ += triangles   ? inner * (inner - 1) / 2
                  : size == 4 ? inner * inner
                              : 1 + size * half + size * half * half;
    }
}

void GridNumbering::root(std::uint32_t face, std::uint32_t corner, std::vector<std::uint32_t>& ids,
                         std::vector<std::uint8_t>& own) const {
    const std::uint32_t size = topology_.face_offsets[face + 1] - topology_.face_offsets[face];
    if (triangles_) return triangle(face, ids, own);
    if (size == 4) return quad(face, ids, own);
    polygon(face, corner, ids, own);
}

void GridNumbering::quad(std::uint32_t face, std::vector<std::uint32_t>& ids,
                         std::vector<std::uint8_t>& own) const {
    const std::uint32_t n = segments_, pitch = n + 1, first = topology_.face_offsets[face];
    ids.resize(std::size_t(pitch) * pitch);
    own.assign(ids.size(), 1);
    const auto put = [&](std::size_t i, std::size_t j, std::uint32_t id, bool owned) {
        ids[j * pitch + i] = id;
        own[j * pitch + i] = owned;
    };
    const auto corner = [&](std::uint32_t c, std::size_t i, std::size_t j) {
        put(i, j, vertices_[topology_.corner_vertices[first + c]], owns_vertex(first + c));
    };
    corner(0, 0, 0), corner(1, n, 0), corner(2, n, n), corner(3, 0, n);
    for (std::uint32_t k = 1; k < n; ++k) {
        put(k, 0, on_edge(first, k), owns_edge(first));
        put(n, k, on_edge(first + 1, k), owns_edge(first + 1));
        put(n - k, n, on_edge(first + 2, k), owns_edge(first + 2));
        put(0, n - k, on_edge(first + 3, k), owns_edge(first + 3));
    }
    std::uint32_t id = faces_[face];
    for (std::uint32_t j = 1; j < n; ++j)
        for (std::uint32_t i = 1; i < n; ++i) ids[std::size_t(j) * pitch + i] = id++;
}

void GridNumbering::polygon(std::uint32_t face, std::uint32_t corner,
                            std::vector<std::uint32_t>& ids, std::vector<std::uint8_t>& own) const {
    const std::uint32_t first = topology_.face_offsets[face];
    const std::uint32_t size = topology_.face_offsets[face + 1] - first;
    const std::uint32_t c = first + corner, before = first + (corner + size - 1) % size;
    const std::uint32_t vertex = vertices_[topology_.corner_vertices[c]];
    if (segments_ == 1) {
        ids.assign(4, no_index);
        own.assign(4, 0);
        ids[0] = vertex;
        own[0] = owns_vertex(c);
        return;
    }
    const std::uint32_t m = segments_ / 2, pitch = m + 1;
    ids.resize(std::size_t(pitch) * pitch);
    own.assign(ids.size(), 1);
    const auto put = [&](std::size_t i, std::size_t j, std::uint32_t id, bool owned) {
        ids[j * pitch + i] = id;
        own[j * pitch + i] = owned;
    };
    const auto spoke = [&](std::uint32_t edge, std::uint32_t k) {  // k from the edge inwards
        return faces_[face] + 1 + edge * (m - 1) + k - 1;
    };
    put(0, 0, vertex, owns_vertex(c));
    for (std::uint32_t k = 1; k <= m; ++k) {
        put(k, 0, on_edge(c, k), owns_edge(c));
        put(0, k, on_edge(before, segments_ - k), owns_edge(before) && k < m);
    }
    for (std::uint32_t k = 1; k < m; ++k) {
        put(m, k, spoke(corner, k), true);
        put(k, m, spoke(before - first, k), false);
    }
    put(m, m, faces_[face], corner == 0);
    std::uint32_t id = faces_[face] + 1 + size * (m - 1) + corner * (m - 1) * (m - 1);
    for (std::uint32_t j = 1; j < m; ++j)
        for (std::uint32_t i = 1; i < m; ++i) ids[std::size_t(j) * pitch + i] = id++;
}

void GridNumbering::triangle(std::uint32_t face, std::vector<std::uint32_t>& ids,
                             std::vector<std::uint8_t>& own) const {
    const std::uint32_t n = segments_, first = topology_.face_offsets[face];
    ids.resize(std::size_t(n + 1) * (n + 2) / 2);
    own.assign(ids.size(), 1);
    std::uint32_t id = faces_[face];
    std::size_t at = 0;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i + j <= n; ++i, ++at) {
            const std::uint32_t corner = i == 0 && j == 0 ? 0 : i == n ? 1 : j == n ? 2 : 3;
            if (corner < 3) {
                ids[at] = vertices_[topology_.corner_vertices[first + corner]];
                own[at] = owns_vertex(first + corner);
            } else if (j == 0 || i + j == n || i == 0) {
                const std::uint32_t edge = first + (j == 0 ? 0 : i + j == n ? 1 : 2);
                ids[at] = on_edge(edge, j == 0 ? i : i + j == n ? j : n - j);
                own[at] = owns_edge(edge);
            } else {
                ids[at] = id++;
            }
        }
}

}  // namespace prep::detail
