// Non-manifold edges and vertices: every sheet of the surface gets vertices of its own.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/disjoint_sets.h"
#include "prep/face_normals.h"
#include "repair/repair_steps.h"
#include "surface/corner_steps.h"
#include "surface/fans.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

struct CrowdedHalfEdge {
    std::uint64_t edge;  // both points, the lower one first
    Index corner;
    bool upward;                                    // runs from the lower point to the higher one
    Index low_fan = no_index, high_fan = no_index;  // at its points, crowded edges not crossed
    double angle = 0;
    bool operator<(const CrowdedHalfEdge& o) const {
        return edge != o.edge ? edge < o.edge : corner < o.corner;
    }
};

// Runs of half-edges that share an edge, where they are not one pair of opposite ones.
std::vector<std::vector<CrowdedHalfEdge>> crowded_edges(const Mesh& mesh,
                                                        const Topology& topology) {
    std::vector<CrowdedHalfEdge> all;
    for (Index c = 0; c < mesh.corner_count(); ++c) {
        if (topology.kinds[c] != EdgeKind::non_manifold) continue;
        const Index to = next_corner(mesh.face_offsets, topology.corner_faces[c], c);
        const Index a = topology.welded[mesh.corner_vertices[c]];
        const Index b = topology.welded[mesh.corner_vertices[to]];
        all.push_back({edge_key(a, b), c, a < b});
    }
    std::sort(all.begin(), all.end());
    std::vector<std::vector<CrowdedHalfEdge>> runs;
    for (const CrowdedHalfEdge& h : all) {
        if (runs.empty() || runs.back().back().edge != h.edge) runs.emplace_back();
        runs.back().push_back(h);
    }
    return runs;
}

// Angles of the faces around the axis from the lower to the higher point. Looking down the axis, a
// face that runs upward has the inside on its clockwise side: each downward face opens a solid
// wedge that the next upward one counter-clockwise closes.
void sort_around(const Mesh& mesh, const Topology& topology, const FaceNormals& faces,
                 std::vector<CrowdedHalfEdge>& run) {
    const auto at = [&](Index v) { return glm::dvec3(mesh.positions[v]); };
    const glm::dvec3 axis =
        glm::normalize(at(Index(run[0].edge & 0xffffffffu)) - at(Index(run[0].edge >> 32)));
    glm::dvec3 x(0.0), y(0.0);
    for (CrowdedHalfEdge& h : run) {
        const glm::dvec3& area = faces.area_vectors[topology.corner_faces[h.corner]];
        // Into the face, across the edge.
        const glm::dvec3 inward = glm::cross(area, h.upward ? axis : -axis);
        if (x == glm::dvec3(0.0) && glm::length(inward) > 0) {
            x = glm::normalize(inward);
            y = glm::cross(axis, x);
        }
        h.angle = std::atan2(glm::dot(inward, y), glm::dot(inward, x));
    }
    std::sort(run.begin(), run.end(), [](const CrowdedHalfEdge& a, const CrowdedHalfEdge& b) {
        return a.angle != b.angle ? a.angle < b.angle : a.corner < b.corner;
    });
}

// Matches openers with closers like brackets around a circle; returns pairs of corners.
std::vector<std::pair<Index, Index>> pair_wedges(const std::vector<CrowdedHalfEdge>& run) {
    std::vector<std::pair<Index, Index>> pairs;
    std::vector<bool> matched(run.size(), false);
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < 2 * run.size(); ++i) {  // twice around: wedges may span the start
        const std::size_t k = i % run.size();
        if (matched[k]) continue;
        if (!run[k].upward) {
            if (i < run.size()) open.push_back(k);
            continue;
        }
        while (!open.empty() && matched[open.back()]) open.pop_back();
        if (open.empty()) continue;
        matched[k] = matched[open.back()] = true;
        pairs.emplace_back(run[open.back()].corner, run[k].corner);
        open.pop_back();
    }
    return pairs;
}

// Half-edges that wait for one that runs the other way, by what they share with it, first come
// first served.
class Waiting {
  public:
    void add(std::uint64_t key, std::size_t i) { queues_[key].members.push_back(i); }
    // The first that is not matched yet; `none` where there is no such.
    std::size_t first(std::uint64_t key, const std::vector<bool>& matched) {
        const auto at = queues_.find(key);
        if (at == queues_.end()) return none;
        Queue& q = at->second;
        while (q.next < q.members.size() && matched[q.members[q.next]]) ++q.next;
        return q.next < q.members.size() ? q.members[q.next] : none;
    }
    static constexpr std::size_t none = std::size_t(-1);

  private:
    struct Queue {
        std::vector<std::size_t> members;
        std::size_t next = 0;
    };
    std::unordered_map<std::uint64_t, Queue> queues_;
};

// Faces that hang together around a point of the edge cannot be parted there: first those that do
// around both points are paired, then around one of them, then the wedges of the rest.
std::vector<std::pair<Index, Index>> pair_faces(const std::vector<CrowdedHalfEdge>& run) {
    std::vector<std::pair<Index, Index>> pairs;
    std::vector<bool> matched(run.size(), false);
    for (const bool both : {true, false}) {
        Waiting waiting[2];  // downward, upward
        for (std::size_t k = 0; k < run.size(); ++k) {
            if (matched[k]) continue;
            const std::uint64_t low = run[k].low_fan, high = run[k].high_fan;
            const std::uint64_t keys[2] = {both ? low << 32 | high : low,
                                           both ? low << 32 | high : std::uint64_t(1) << 32 | high};
            Waiting& others = waiting[run[k].upward ? 0 : 1];
            const std::size_t i =
                std::min(others.first(keys[0], matched), others.first(keys[1], matched));
            if (i == Waiting::none) {
                for (const std::uint64_t key : keys) waiting[run[k].upward ? 1 : 0].add(key, k);
                continue;
            }
            matched[i] = matched[k] = true;
            pairs.emplace_back(run[i].corner, run[k].corner);
        }
    }
    std::vector<CrowdedHalfEdge> rest;
    for (std::size_t i = 0; i < run.size(); ++i)
        if (!matched[i]) rest.push_back(run[i]);
    const auto wedges = pair_wedges(rest);
    pairs.insert(pairs.end(), wedges.begin(), wedges.end());
    return pairs;
}

// Sheets are sets of corners of one point that hang together over edges of two faces. Every sheet
// but the first at a file vertex gets a copy of it. `joined`: fans that belong together all the
// same. Returns the file vertices that were split.
Places give_each_sheet_its_vertices(Mesh& mesh, const Topology& topology,
                                    const std::vector<Index>& fan_of, DisjointSets& joined) {
    struct Use {
        Index vertex, sheet, corner;
        bool operator<(const Use& o) const {
            return vertex != o.vertex ? vertex < o.vertex : corner < o.corner;
        }
    };
    std::vector<Use> uses;
    uses.reserve(mesh.corner_count());
    for (Index c = 0; c < mesh.corner_count(); ++c)
        uses.push_back({mesh.corner_vertices[c], joined.find(fan_of[c]), c});
    std::sort(uses.begin(), uses.end());
    Places places;
    struct Copy {
        Index of = no_index, vertex = no_index;
    };
    std::vector<Copy> copies(fan_of.empty() ? 0
                                            : *std::max_element(fan_of.begin(), fan_of.end()) +
                                                  std::size_t(1));  // by sheet: its latest
    std::vector<Index> origin(mesh.vertex_count());
    std::iota(origin.begin(), origin.end(), Index(0));
    for (std::size_t i = 0; i < uses.size();) {
        const Index vertex = uses[i].vertex;
        copies[uses[i].sheet] = {vertex, vertex};
        bool split = false;
        for (; i < uses.size() && uses[i].vertex == vertex; ++i) {
            Copy& copy = copies[uses[i].sheet];
            if (copy.of != vertex) {
                if (!split) places.add(vertex);
                split = true;
                copy = {vertex, copy_vertex(mesh, vertex)};
                origin.push_back(vertex);
            }
            mesh.corner_vertices[uses[i].corner] = copy.vertex;
        }
    }
    mark_copies(mesh, origin, topology.welded);
    return places;
}

std::vector<Index> number_fans(const Mesh& mesh, const Topology& topology, Index& count) {
    std::vector<Index> fan_of(mesh.corner_count(), no_index), corners;
    const FanWalker walker(PolygonSteps{mesh.face_offsets, topology.corner_faces}, topology);
    count = 0;
    for (Index c = 0; c < mesh.corner_count(); ++c) {
        if (fan_of[c] != no_index) continue;
        walker.collect(c, corners);
        for (const Index k : corners) fan_of[k] = count;
        ++count;
    }
    return fan_of;
}

// Edges of two faces that run the same way hold their fans together: orientation is another step's.
void join_over(const Mesh& mesh, const Topology& topology, const std::vector<Index>& fan_of,
               EdgeKind kind, DisjointSets& joined) {
    struct End {
        std::uint64_t edge;
        Index low, high;
        bool operator<(const End& o) const { return edge < o.edge; }
    };
    std::vector<End> ends;
    for (Index c = 0; c < mesh.corner_count(); ++c) {
        if (topology.kinds[c] != kind) continue;
        const Index to = next_corner(mesh.face_offsets, topology.corner_faces[c], c);
        const Index a = topology.welded[mesh.corner_vertices[c]];
        const Index b = topology.welded[mesh.corner_vertices[to]];
        ends.push_back({edge_key(a, b), fan_of[a < b ? c : to], fan_of[a < b ? to : c]});
    }
    std::stable_sort(ends.begin(), ends.end());
    for (std::size_t i = 1; i < ends.size(); ++i) {
        if (ends[i].edge != ends[i - 1].edge) continue;
        joined.unite(ends[i].low, ends[i - 1].low);
        joined.unite(ends[i].high, ends[i - 1].high);
    }
}

// Whether faces at the edge shared a vertex at one of its ends that they share no more: in files of
// loose faces, and after such a repair, sheets have their vertices already.
bool was_split(const Mesh& mesh, const Topology& topology, const std::vector<CrowdedHalfEdge>& run,
               const std::vector<Index>& before) {
    std::vector<std::pair<Index, Index>> vertices;  // before and now
    for (const CrowdedHalfEdge& h : run) {
        const Index to = next_corner(mesh.face_offsets, topology.corner_faces[h.corner], h.corner);
        for (const Index c : {h.corner, to})
            vertices.emplace_back(before[c], mesh.corner_vertices[c]);
    }
    std::sort(vertices.begin(), vertices.end());
    const auto split = std::adjacent_find(
        vertices.begin(), vertices.end(),
        [](const auto& a, const auto& b) { return a.first == b.first && a.second != b.second; });
    return split != vertices.end();
}

}  // namespace

RepairStep split_non_manifold_edges(Mesh& mesh, int threads) {
    RepairStep step;
    step.step = "edges";
    step.place_kind = PlaceKind::edge;
    step.text = "edges of three or more faces were split into sheets";
    Topology topology = repair_topology(mesh, threads);
    auto runs = crowded_edges(mesh, topology);
    if (runs.empty()) return step;
    const FaceNormals faces = face_normals(MeshView(mesh), Precision::accurate, threads);
    Index fans = 0;
    const std::vector<Index> fans_before = number_fans(mesh, topology, fans);
    for (auto& run : runs) {
        sort_around(mesh, topology, faces, run);
        for (CrowdedHalfEdge& h : run) {
            const Index to =
                next_corner(mesh.face_offsets, topology.corner_faces[h.corner], h.corner);
            h.low_fan = fans_before[h.upward ? h.corner : to];
            h.high_fan = fans_before[h.upward ? to : h.corner];
        }
        for (const auto& [a, b] : pair_faces(run)) {
            topology.opposite[a] = b;
            topology.opposite[b] = a;
            topology.kinds[a] = topology.kinds[b] = EdgeKind::interior;
        }
    }
    const std::vector<Index> fan_of = number_fans(mesh, topology, fans);
    DisjointSets joined(fans);
    join_over(mesh, topology, fan_of, EdgeKind::inconsistent, joined);
    // Where no crowded edge ends, surfaces that touch in a vertex alone stay as they are.
    std::vector<std::uint8_t> crowded(mesh.vertex_count(), 0);
    for (const auto& run : runs)
        for (const Index point : {Index(run[0].edge >> 32), Index(run[0].edge & 0xffffffffu)})
            crowded[point] = 1;
    std::vector<Index> first(mesh.vertex_count(), no_index);
    for (Index c = 0; c < mesh.corner_count(); ++c) {
        const Index point = topology.welded[mesh.corner_vertices[c]];
        if (crowded[point]) continue;
        Index& fan = first[mesh.corner_vertices[c]];
        if (fan == no_index) fan = fan_of[c];
        joined.unite(fan, fan_of[c]);
    }
    const std::vector<Index> before = mesh.corner_vertices;
    give_each_sheet_its_vertices(mesh, topology, fan_of, joined);
    const Topology after = build_topology(MeshView(mesh), {}, threads);
    for (const auto& run : runs) {
        const bool left = std::any_of(run.begin(), run.end(), [&](const CrowdedHalfEdge& h) {
            return after.kinds[h.corner] == EdgeKind::non_manifold;
        });
        const bool split = !left && was_split(mesh, topology, run, before);
        step.left += left;
        step.changed += split;
        if ((split || left) && step.places.size() < Finding::max_places)
            step.places.push_back(std::min_element(run.begin(), run.end())->corner);
    }
    std::sort(step.places.begin(), step.places.end());
    if (step.left > 0)
        step.text += "; left: those whose faces hang together around both ends all the same";
    return step;
}

RepairStep split_non_manifold_vertices(Mesh& mesh, int threads) {
    RepairStep step;
    step.step = "vertices";
    step.place_kind = PlaceKind::vertex;
    step.text = "vertices in which surfaces only touch were split";
    const Topology topology = repair_topology(mesh, threads);
    Index fans = 0;
    const std::vector<Index> fan_of = number_fans(mesh, topology, fans);
    DisjointSets joined(fans);
    join_over(mesh, topology, fan_of, EdgeKind::inconsistent, joined);
    join_over(mesh, topology, fan_of, EdgeKind::non_manifold, joined);
    Places places = give_each_sheet_its_vertices(mesh, topology, fan_of, joined);
    step.changed = places.count;
    step.places = std::move(places.first);
    return step;
}

}  // namespace prep::detail
