#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "prep/face_normals.h"
#include "repair/repair_steps.h"
#include "surface/corner_steps.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

void keep_marked_faces(std::vector<Index>& per_face, const std::vector<std::uint8_t>& keep) {
    if (per_face.empty()) return;
    std::size_t kept = 0;
    for (std::size_t f = 0; f < keep.size(); ++f)
        if (keep[f]) per_face[kept++] = per_face[f];
    per_face.resize(kept);
}

}  // namespace

void number_file_vertices(Mesh& mesh) {
    if (!mesh.file_vertices.empty()) return;
    mesh.file_vertices.resize(mesh.vertex_count());
    std::iota(mesh.file_vertices.begin(), mesh.file_vertices.end(), 0u);
}

void number_corner_file_vertices(Mesh& mesh) {
    if (!mesh.corner_file_vertices.empty()) return;
    const auto& in_file = mesh.file_vertices;
    for (const Index v : mesh.corner_vertices)
        mesh.corner_file_vertices.push_back(in_file.empty() ? v : in_file[v]);
}

std::vector<Index> parts_of_vertices(const Mesh& mesh) {
    std::vector<Index> parts(mesh.vertex_count(), 0);
    if (mesh.face_parts.empty() || !mesh.tied_to_file) return parts;
    for (Index f = 0; f < mesh.face_count(); ++f)
        for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            parts[mesh.corner_vertices[c]] = mesh.face_parts[f];
    return parts;
}

void put_in_place(Mesh& mesh, const std::vector<Index>& target) {
    number_corner_file_vertices(mesh);
    for (auto* users : {&mesh.corner_vertices, &mesh.line_vertices, &mesh.points})
        for (Index& v : *users) v = target[v];
    for (glm::uvec2& m : mesh.hard_marks) m = {target[m.x], target[m.y]};
    for (EdgeMark& m : mesh.subdivision.creases) {
        m.v0 = target[m.v0];
        m.v1 = target[m.v1];
    }
    for (VertexMark& m : mesh.subdivision.corners) m.vertex = target[m.vertex];
}

void keep_corners(Mesh& mesh, const std::vector<Index>& kept, std::vector<Index> face_offsets) {
    const auto gather = [&kept](std::vector<Index>& per_corner) {
        if (per_corner.empty()) return;
        for (std::size_t i = 0; i < kept.size(); ++i) per_corner[i] = per_corner[kept[i]];
        per_corner.resize(kept.size());
    };
    gather(mesh.corner_vertices);
    gather(mesh.corner_file_vertices);
    for_each_layer(mesh, [&](auto& layer) { gather(layer.indices); });
    mesh.face_offsets = std::move(face_offsets);
}

void keep_faces(Mesh& mesh, const std::vector<std::uint8_t>& keep) {
    std::vector<Index> sources;  // per corner kept
    std::vector<Index> offsets{0};
    std::vector<Index> renumbered(keep.size(), no_index);
    for (Index f = 0; f < keep.size(); ++f) {
        if (!keep[f]) continue;
        renumbered[f] = Index(offsets.size() - 1);
        for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            sources.push_back(c);
        offsets.push_back(Index(sources.size()));
    }
    keep_corners(mesh, sources, std::move(offsets));
    for (auto* per_face : {&mesh.face_materials, &mesh.face_smoothing, &mesh.face_parts})
        keep_marked_faces(*per_face, keep);
    std::vector<Index>& holes = mesh.subdivision.holes;
    for (Index& f : holes) f = f < renumbered.size() ? renumbered[f] : no_index;
    holes.erase(std::remove(holes.begin(), holes.end(), no_index), holes.end());
}

void turn_faces(Mesh& mesh, const std::vector<std::uint8_t>& turn, const FaceNormals& faces) {
    // Layers share values between corners: those that turn get values of their own.
    const auto turn_vectors = [&](auto& layer, const auto& turned) {
        if (layer.empty()) return;
        std::vector<Index> copies(layer.values.size(), no_index);
        for (Index f = 0; f < mesh.face_count(); ++f) {
            if (!turn[f]) continue;
            for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
                const Index i = mesh.normals.indices[c];
                Index& at = layer.indices[c];
                if (at == no_index || i == no_index) continue;
                const glm::dvec3 n(mesh.normals.values[i]);
                if (!(glm::dot(n, faces.area_vectors[f]) > 0)) continue;
                if (copies[at] == no_index) {
                    copies[at] = Index(layer.values.size());
                    layer.values.push_back(turned(layer.values[at]));
                }
                at = copies[at];
            }
        }
    };
    if (!mesh.normals.empty()) {
        // B = w · N × T keeps its direction when N turns and w with it.
        turn_vectors(mesh.tangents, [](glm::vec4 t) { return glm::vec4(t.x, t.y, t.z, -t.w); });
        turn_vectors(mesh.normals, [](glm::vec3 n) { return -n; });
    }
    for (Index f = 0; f < mesh.face_count(); ++f) {
        if (!turn[f]) continue;
        const auto reverse = [&](std::vector<Index>& per_corner) {
            if (per_corner.empty()) return;
            std::reverse(per_corner.begin() + mesh.face_offsets[f] + 1,
                         per_corner.begin() + mesh.face_offsets[f + 1]);
        };
        reverse(mesh.corner_vertices);
        reverse(mesh.corner_file_vertices);
        for_each_layer(mesh, [&](auto& layer) { reverse(layer.indices); });
    }
}

std::uint32_t copy_vertex(Mesh& mesh, std::uint32_t vertex) {
    const Index copy = Index(mesh.positions.size());
    number_file_vertices(mesh);
    mesh.file_vertices.push_back(mesh.file_vertices[vertex]);
    mesh.positions.push_back(glm::vec3(mesh.positions[vertex]));
    if (!mesh.vertex_colors.empty())
        mesh.vertex_colors.push_back(glm::vec4(mesh.vertex_colors[vertex]));
    return copy;
}

void move_marks(Mesh& mesh, std::vector<ReplacedEdge> replaced, const std::vector<Index>& points,
                const std::vector<std::uint8_t>& keep) {
    const auto less = [](const ReplacedEdge& a, const ReplacedEdge& b) {
        return a.from != b.from ? a.from < b.from : a.to < b.to;
    };
    std::sort(replaced.begin(), replaced.end(), less);
    replaced.erase(std::unique(replaced.begin(), replaced.end(),
                               [](const ReplacedEdge& a, const ReplacedEdge& b) {
                                   return a.from == b.from && a.to == b.to;
                               }),
                   replaced.end());
    const auto of = [&](std::uint64_t key) {
        return std::equal_range(
            replaced.begin(), replaced.end(), ReplacedEdge{key, 0},
            [](const ReplacedEdge& a, const ReplacedEdge& b) { return a.from < b.from; });
    };
    const auto point_key = [&](Index a, Index b) { return edge_key(points[a], points[b]); };
    std::vector<std::uint64_t> left;  // of the replaced ones, those that a face has still
    for (Index f = 0; f < mesh.face_count(); ++f) {
        if (!keep.empty() && keep[f] == 0) continue;
        for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const Index a = mesh.corner_vertices[c];
            const Index b = mesh.corner_vertices[next_corner(mesh.face_offsets, f, c)];
            const std::uint64_t key = point_key(a, b);
            const auto [begin, end] = of(key);
            if (begin != end &&
                !std::binary_search(begin, end, ReplacedEdge{key, edge_key(a, b)}, less))
                left.push_back(key);
        }
    }
    std::sort(left.begin(), left.end());
    const auto move = [&](auto& marks, const auto& key_of, const auto& with_edge) {
        std::remove_reference_t<decltype(marks)> moved;
        for (const auto& mark : marks) {
            const std::uint64_t key = key_of(mark);
            const auto [begin, end] = of(key);
            if (begin == end || std::binary_search(left.begin(), left.end(), key))
                moved.push_back(mark);
            for (auto edge = begin; edge != end; ++edge)
                moved.push_back(with_edge(mark, Index(edge->to >> 32), Index(edge->to)));
        }
        marks = std::move(moved);
    };
    move(
        mesh.hard_marks, [&](const glm::uvec2& m) { return point_key(m.x, m.y); },
        [](const glm::uvec2&, Index a, Index b) { return glm::uvec2(a, b); });
    move(
        mesh.subdivision.creases, [&](const EdgeMark& m) { return point_key(m.v0, m.v1); },
        [](const EdgeMark& m, Index a, Index b) {
            return EdgeMark{a, b, m.sharpness};
        });
}

void mark_copies(Mesh& mesh, const std::vector<Index>& origin, std::vector<Index> points) {
    std::vector<VertexMark>& corners = mesh.subdivision.corners;
    if (!corners.empty()) {
        std::unordered_multimap<Index, float> tags;
        for (const VertexMark& mark : corners) tags.emplace(mark.vertex, mark.sharpness);
        for (Index v = 0; v < origin.size(); ++v) {
            if (origin[v] == v) continue;
            const auto [begin, end] = tags.equal_range(origin[v]);
            for (auto tag = begin; tag != end; ++tag) corners.push_back({v, tag->second});
        }
    }
    if (mesh.hard_marks.empty() && mesh.subdivision.creases.empty()) return;
    for (Index v = Index(points.size()); v < origin.size(); ++v)
        points.push_back(points[origin[v]]);
    std::vector<ReplacedEdge> replaced;
    for (Index f = 0; f < mesh.face_count(); ++f)
        for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const Index a = mesh.corner_vertices[c];
            const Index b = mesh.corner_vertices[next_corner(mesh.face_offsets, f, c)];
            if (origin[a] != a || origin[b] != b)
                replaced.push_back({edge_key(points[a], points[b]), edge_key(a, b)});
        }
    move_marks(mesh, std::move(replaced), points);
}

Topology repair_topology(const Mesh& mesh, int threads) {
    return build_topology(MeshView(mesh), weld_exact(mesh.positions, threads), threads);
}

RepairStep remove_isolated_vertices(Mesh& mesh) {
    RepairStep step;
    step.step = "isolated";
    step.place_kind = PlaceKind::vertex;
    std::vector<std::uint8_t> used(mesh.vertex_count(), 0);
    for (const auto* users : {&mesh.corner_vertices, &mesh.line_vertices, &mesh.points})
        for (const Index v : *users) used[v] = 1;
    Places gone;
    std::vector<Index> renumbered(mesh.vertex_count(), no_index);
    Index kept = 0;
    for (Index v = 0; v < used.size(); ++v) {
        if (used[v])
            renumbered[v] = kept++;
        else
            gone.add(v);
    }
    step.changed = gone.count;
    step.places = std::move(gone.first);
    step.text = "vertices that nothing uses were removed";
    if (step.changed == 0) return step;

    number_file_vertices(mesh);
    for (Index v = 0; v < used.size(); ++v) {
        if (!used[v]) continue;
        mesh.positions[renumbered[v]] = mesh.positions[v];
        mesh.file_vertices[renumbered[v]] = mesh.file_vertices[v];
        if (!mesh.vertex_colors.empty()) mesh.vertex_colors[renumbered[v]] = mesh.vertex_colors[v];
    }
    mesh.positions.resize(kept);
    mesh.file_vertices.resize(kept);
    if (!mesh.vertex_colors.empty()) mesh.vertex_colors.resize(kept);
    for (auto* users : {&mesh.corner_vertices, &mesh.line_vertices, &mesh.points})
        for (Index& v : *users) v = renumbered[v];
    const auto gone_mark = [&](Index v) { return renumbered[v] == no_index; };
    auto& marks = mesh.hard_marks;
    marks.erase(
        std::remove_if(marks.begin(), marks.end(),
                       [&](const glm::uvec2& m) { return gone_mark(m.x) || gone_mark(m.y); }),
        marks.end());
    for (glm::uvec2& m : marks) m = {renumbered[m.x], renumbered[m.y]};
    auto& creases = mesh.subdivision.creases;
    creases.erase(
        std::remove_if(creases.begin(), creases.end(),
                       [&](const EdgeMark& m) { return gone_mark(m.v0) || gone_mark(m.v1); }),
        creases.end());
    for (EdgeMark& m : creases) {
        m.v0 = renumbered[m.v0];
        m.v1 = renumbered[m.v1];
    }
    auto& corners = mesh.subdivision.corners;
    corners.erase(std::remove_if(corners.begin(), corners.end(),
                                 [&](const VertexMark& m) { return gone_mark(m.vertex); }),
                  corners.end());
    for (VertexMark& m : corners) m.vertex = renumbered[m.vertex];
    return step;
}

}  // namespace prep::detail
