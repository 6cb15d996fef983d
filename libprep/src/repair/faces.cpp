#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "base/finite.h"
#include "prep/face_normals.h"
#include "repair/flat_faces.h"
#include "repair/repair_steps.h"
#include "surface/duplicate_faces.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
using Cell = std::array<std::int64_t, 3>;

struct CellHash {
    std::size_t operator()(const Cell& cell) const {
        std::uint64_t h = 0;
        for (const std::int64_t x : cell) {
            h ^= std::uint64_t(x) + 0x9e3779b97f4a7c15u + (h << 6) + (h >> 2);
            h *= 0xbf58476d1ce4e5b9u;
        }
        return std::size_t(h ^ (h >> 31));
    }
};

// `points`: by vertex, as Topology::welded; `keep`: by face whether it stays a face.
void insert_corners(Mesh& mesh, const std::vector<Insertion>& insertions,
                    const std::vector<Index>& points, const std::vector<std::uint8_t>& keep) {
    if (insertions.empty()) return;
    const Mesh old = mesh;
    std::vector<Index> offsets{0}, vertices;
    std::vector<ReplacedEdge> replaced;
    struct Source {
        Index a, b;
        float t;
    };
    std::vector<Source> sources;
    std::size_t next = 0;
    for (Index f = 0; f < old.face_count(); ++f) {
        const Index begin = old.face_offsets[f], end = old.face_offsets[f + 1];
        // An insertion before the first corner lies on the edge from the last one: at the end.
        std::vector<Insertion> last;
        for (Index c = begin; c < end; ++c) {
            while (next < insertions.size() && insertions[next].before == c) {
                const Insertion& in = insertions[next++];
                if (c == begin) {
                    last.push_back(in);
                    continue;
                }
                vertices.push_back(in.vertex);
                sources.push_back({c - 1, c, in.t});
            }
            vertices.push_back(old.corner_vertices[c]);
            sources.push_back({c, c, 0});
        }
        for (const Insertion& in : last) {
            vertices.push_back(in.vertex);
            sources.push_back({end - 1, begin, in.t});
        }
        // Each edge that was cut, in its pieces.
        const std::size_t first = offsets.back(), count = vertices.size() - first;
        for (std::size_t k = first; count > end - begin && k < vertices.size(); ++k) {
            const std::size_t to = k + 1 < vertices.size() ? k + 1 : first;
            // What is no corner of before lies between these two; others are their own ends.
            const Index a = old.corner_vertices[sources[k].a];
            const Index b = old.corner_vertices[sources[to].b];
            if (sources[k].a != sources[k].b || sources[to].a != sources[to].b)
                replaced.push_back(
                    {edge_key(points[a], points[b]), edge_key(vertices[k], vertices[to])});
        }
        offsets.push_back(Index(vertices.size()));
    }
    // New corners have attributes of their own; what they lack, their vertex has.
    number_corner_file_vertices(mesh);
    std::vector<Index> in_file(sources.size());
    for (std::size_t c = 0; c < sources.size(); ++c) {
        const auto [a, b, t] = sources[c];
        in_file[c] = a == b                       ? mesh.corner_file_vertices[a]
                     : mesh.file_vertices.empty() ? vertices[c]
                                                  : mesh.file_vertices[vertices[c]];
    }
    mesh.corner_file_vertices = std::move(in_file);
    mesh.face_offsets = std::move(offsets);
    mesh.corner_vertices = std::move(vertices);
    if (!mesh.hard_marks.empty() || !mesh.subdivision.creases.empty())
        move_marks(mesh, std::move(replaced), points, keep);
    for_each_layer(mesh, [&](auto& layer) {
        if (layer.empty()) return;
        const std::vector<Index> indices = std::move(layer.indices);
        layer.indices.assign(sources.size(), no_index);
        for (std::size_t c = 0; c < sources.size(); ++c) {
            const Index a = indices[sources[c].a], b = indices[sources[c].b];
            if (a == b || a == no_index || b == no_index) {
                layer.indices[c] = a == b ? a : no_index;
                continue;
            }
            const float t = sources[c].t;
            layer.indices[c] = Index(layer.values.size());
            layer.values.push_back(layer.values[a] * (1 - t) + layer.values[b] * t);
        }
    });
    // Directions between two unit vectors are not unit: computed anew where they are missing.
    for (std::size_t c = 0; c < sources.size(); ++c) {
        if (sources[c].a == sources[c].b) continue;
        if (!mesh.normals.empty()) mesh.normals.indices[c] = no_index;
        if (!mesh.tangents.empty()) mesh.tangents.indices[c] = no_index;
    }
}

// Removes corners at the same point as the next one of their face; marks the faces that had some.
void remove_repeated_corners(Mesh& mesh, const Topology& topology,
                             std::vector<std::uint8_t>& changed) {
    std::vector<Index> offsets{0}, kept;
    for (Index f = 0; f < mesh.face_count(); ++f) {
        for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            if (topology.kinds[c] == EdgeKind::degenerate)
                changed[f] = 1;
            else
                kept.push_back(c);
        }
        offsets.push_back(Index(kept.size()));
    }
    if (kept.size() < mesh.corner_count()) keep_corners(mesh, kept, std::move(offsets));
}

// Which cell of the tolerance's width has the coordinate. Beyond 2^62 cells its own grid is coarser
// than the tolerance: there each float has a cell.
std::int64_t cell_along(float x, double tolerance) {
    const double cells = std::floor(double(x) / tolerance);
    if (std::abs(cells) < 0x1p62) return std::int64_t(cells);
    const auto beyond = (std::int64_t(1) << 62) + std::bit_cast<std::uint32_t>(std::abs(x));
    return x < 0 ? -beyond : beyond;
}

// By vertex the one of its point and its part. `points`: by vertex the one that stands for its
// point.
std::vector<Index> targets_of(const Mesh& mesh, const std::vector<Index>& points) {
    const std::vector<Index> parts = parts_of_vertices(mesh);
    std::vector<Index> target(mesh.vertex_count());
    std::unordered_map<std::uint64_t, Index> firsts;  // of a point in a part that is not its first
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
        target[v] = is_finite(mesh.positions[v]) ? points[v] : v;
        if (parts[target[v]] == parts[v]) continue;
        const std::uint64_t key = std::uint64_t(points[v]) << 32 | parts[v];
        target[v] = firsts.emplace(key, v).first->second;
    }
    return target;
}

// By vertex the earliest one of its part within the tolerance that stays.
std::vector<Index> targets_within(const Mesh& mesh, double tolerance) {
    const std::vector<Index> parts = parts_of_vertices(mesh);
    std::vector<Index> target(mesh.vertex_count());
    std::unordered_map<Cell, std::vector<Index>, CellHash> cells;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
        target[v] = v;
        const glm::vec3& at = mesh.positions[v];
        if (!is_finite(at)) continue;
        const Cell home{cell_along(at.x, tolerance), cell_along(at.y, tolerance),
                        cell_along(at.z, tolerance)};
        Index best = no_index;
        for (int k = 0; k < 27; ++k) {
            const Cell near{home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1};
            const auto found = cells.find(near);
            if (found == cells.end()) continue;
            for (const Index u : found->second)
                if (u < best && parts[u] == parts[v] &&
                    glm::length(glm::dvec3(mesh.positions[u]) - glm::dvec3(at)) <= tolerance)
                    best = u;
        }
        if (best != no_index)
            target[v] = best;
        else
            cells[home].push_back(v);
    }
    return target;
}

}  // namespace

void weld_points(Mesh& mesh, const std::vector<Index>& points) {
    const std::vector<Index> target = targets_of(mesh, points);
    for (Index v = 0; v < target.size(); ++v)
        if (target[v] != v) return put_in_place(mesh, target);
}

RepairStep weld_vertices(Mesh& mesh, double tolerance, int threads) {
    RepairStep step;
    step.step = "weld";
    step.place_kind = PlaceKind::vertex;
    step.text = "vertices were welded to an earlier one within the tolerance";
    const std::vector<Index> target = tolerance == 0
                                          ? targets_of(mesh, weld_exact(mesh.positions, threads))
                                          : targets_within(mesh, tolerance);
    std::vector<std::uint8_t> used(mesh.vertex_count(), 0);
    for (const auto* users : {&mesh.corner_vertices, &mesh.line_vertices, &mesh.points})
        for (const Index v : *users) used[v] = 1;
    Places moved;  // of what somebody uses: of the rest nothing changes
    for (Index v = 0; v < mesh.vertex_count(); ++v)
        if (target[v] != v && used[v]) moved.add(v);
    step.changed = moved.count;
    step.places = std::move(moved.first);
    if (step.changed > 0) put_in_place(mesh, target);
    return step;
}

RepairStep remove_degenerate_faces(Mesh& mesh, int threads) {
    RepairStep step;
    step.step = "degenerate";
    step.text =
        "faces that repeat a point or have no area lost the repeated corners or were removed";
    std::vector<std::uint8_t> changed(mesh.face_count(), 0);  // by number before the step
    remove_repeated_corners(mesh, repair_topology(mesh, threads), changed);

    // A face may be left with less than three corners: it goes before anything looks at it.
    std::vector<std::uint8_t> keep(mesh.face_count(), 1);
    std::vector<Index> numbers;  // of the faces that stay, before the step
    for (Index f = 0; f < mesh.face_count(); ++f) {
        keep[f] = mesh.face_offsets[f + 1] - mesh.face_offsets[f] >= 3;
        if (keep[f]) numbers.push_back(f);
    }
    if (numbers.size() < keep.size()) keep_faces(mesh, keep);

    const FaceNormals faces = face_normals(MeshView(mesh), Precision::accurate, threads);
    const Topology topology = repair_topology(mesh, threads);
    const FlatFaces flat = take_out_flat_faces(mesh, faces, topology, parts_of_vertices(mesh));
    bool any = false;
    for (Index f = 0; f < mesh.face_count(); ++f) {
        if (flat.keep[f] != 0) continue;
        any = true;
        changed[numbers[f]] = 1;
    }
    step.left = flat.left;
    if (step.left > 0)
        step.text +=
            "; left: those without area between parts that share no vertices, or beside edges that "
            "run to and fro";
    Places places;
    for (Index f = 0; f < changed.size(); ++f)
        if (changed[f]) places.add(f);
    step.changed = places.count;
    step.places = std::move(places.first);
    if (!any) return step;
    // Insertions shift corners, not faces.
    insert_corners(mesh, flat.insertions, topology.welded, flat.keep);
    keep_faces(mesh, flat.keep);
    return step;
}

RepairStep remove_duplicate_faces(Mesh& mesh, int threads) {
    RepairStep step;
    step.step = "duplicates";
    step.text = "faces with the same points in the same direction as an earlier one were removed";
    std::vector<Index> candidates(mesh.face_count());
    for (Index f = 0; f < mesh.face_count(); ++f) candidates[f] = f;
    const std::vector<Index> welded = weld_exact(mesh.positions, threads);
    const DuplicateFaces found = find_duplicate_faces(mesh, welded, candidates);
    std::vector<std::uint8_t> keep(mesh.face_count(), 1);
    Places places;
    for (const Index f : found.same) {
        keep[f] = 0;
        places.add(f);
    }
    step.changed = places.count;
    step.places = std::move(places.first);
    if (step.changed > 0) keep_faces(mesh, keep);
    return step;
}

}  // namespace prep::detail
