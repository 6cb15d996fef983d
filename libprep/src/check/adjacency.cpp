#include <algorithm>
#include <cmath>
#include <compare>
#include <utility>

#include "base/disjoint_sets.h"
#include "check/check_parts.h"
#include "surface/edge_key.h"
#include "surface/fans.h"
#include "surface/shells.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Half-edges without an opposite that share their edge with others, sorted by edge.
struct CrowdedEdge {
    std::uint64_t edge;  // both points, the lower one first
    Index corner;
    auto operator<=>(const CrowdedEdge&) const = default;
};

class AdjacencyCheck {
  public:
    explicit AdjacencyCheck(CheckContext& context)
        : context_(context),
          topology_(context.topology),
          offsets_(context.view.face_offsets),
          components_(context.mesh.face_count()) {}

    void run() {
        classify_edges();
        find_vertices();
        find_holes();
        measure_components();
        add_findings();
    }

  private:
    Index next(Index c) const { return next_corner(offsets_, topology_.corner_faces[c], c); }
    Index previous(Index c) const {
        const Index face = topology_.corner_faces[c];
        return c == offsets_[face] ? offsets_[face + 1] - 1 : c - 1;
    }

    template <class Body>
    void for_crowded_edges(const Body& body) const {
        for (std::size_t i = 0; i < crowded_.size();) {
            std::size_t end = i + 1;
            while (end < crowded_.size() && crowded_[end].edge == crowded_[i].edge) ++end;
            body(std::span(crowded_).subspan(i, end - i));
            i = end;
        }
    }

    void classify_edges() {
        std::uint64_t interior = 0;
        std::vector<Index> many, mixed;
        for (Index c = 0; c < context_.mesh.corner_count(); ++c) {
            switch (topology_.kinds[c]) {
                case EdgeKind::interior:
                    interior += c < topology_.opposite[c];
                    components_.unite(topology_.corner_faces[c],
                                      topology_.corner_faces[topology_.opposite[c]]);
                    break;
                case EdgeKind::border:
                    open_.add(c);
                    break;
                case EdgeKind::inconsistent:
                case EdgeKind::non_manifold: {
                    const Index a = context_.point_of(c), b = context_.point_of(next(c));
                    crowded_.push_back({edge_key(a, b), c});
                    break;
                }
                case EdgeKind::degenerate:
                    break;
            }
        }
        std::sort(crowded_.begin(), crowded_.end());
        for_crowded_edges([&](std::span<const CrowdedEdge> run) {
            const bool two = topology_.kinds[run[0].corner] == EdgeKind::inconsistent;
            (two ? mixed : many).push_back(run[0].corner);
            for (const CrowdedEdge& e : run)
                components_.unite(topology_.corner_faces[run[0].corner],
                                  topology_.corner_faces[e.corner]);
        });
        std::sort(many.begin(), many.end());
        std::sort(mixed.begin(), mixed.end());
        for (const Index c : many) non_manifold_.add(c);
        for (const Index c : mixed) mixed_.add(c);
        context_.summary.open_edges = open_.count;
        context_.summary.non_manifold_edges = non_manifold_.count;
        context_.summary.mixed_orientation_edges = mixed_.count;
        context_.summary.edges = interior + open_.count + non_manifold_.count + mixed_.count;
    }

    // Vertices of the surface: fans that edges of many faces or a shared file vertex hold together.
    // A vertex of which parts hang together by the vertex alone is not manifold. Where no file
    // vertex is used twice (a soup), the point itself stands for it.
    void find_vertices() {
        const Mesh& mesh = context_.mesh;
        std::vector<Index> fan_of(mesh.corner_count(), no_index), corners;
        const FanWalker walker(PolygonSteps{offsets_, topology_.corner_faces}, topology_);
        Index fans = 0;
        for (Index c = 0; c < mesh.corner_count(); ++c) {
            if (fan_of[c] != no_index) continue;
            walker.collect(c, corners);
            for (const Index k : corners) fan_of[k] = fans;
            ++fans;
        }
        DisjointSets umbrellas(fans);
        for_crowded_edges([&](std::span<const CrowdedEdge> run) {
            const Index low = Index(run[0].edge >> 32);
            Index first[2] = {no_index, no_index};
            for (const CrowdedEdge& e : run) {
                const bool at_low = context_.point_of(e.corner) == low;
                const Index ends[2] = {fan_of[at_low ? e.corner : next(e.corner)],
                                       fan_of[at_low ? next(e.corner) : e.corner]};
                for (int k = 0; k < 2; ++k) {
                    if (first[k] == no_index) first[k] = ends[k];
                    umbrellas.unite(first[k], ends[k]);
                }
            }
        });
        const bool soup = is_soup();
        DisjointSets joined = umbrellas;
        std::vector<Index> fan_of_vertex(mesh.vertex_count(), no_index);
        for (Index c = 0; c < mesh.corner_count(); ++c) {
            Index& fan = fan_of_vertex[soup ? context_.point_of(c) : mesh.corner_vertices[c]];
            if (fan == no_index) fan = fan_of[c];
            joined.unite(fan, fan_of[c]);
        }
        for (Index f = 0; f < fans; ++f) vertices_ += joined.find(f) == f;

        std::vector<Index> sets, wholes;
        for (Index v = 0; v < mesh.vertex_count(); ++v) {
            sets.clear();
            wholes.clear();
            const Index begin = topology_.point_offsets[v], end = topology_.point_offsets[v + 1];
            context_.summary.largest_valence =
                std::max(context_.summary.largest_valence, end - begin);
            for (Index i = begin; i < end; ++i) {
                const Index fan = fan_of[topology_.point_corners[i]];
                sets.push_back(umbrellas.find(fan));
                wholes.push_back(joined.find(fan));
            }
            if (count_distinct(sets) > count_distinct(wholes)) bow_ties_.add(v);
        }
        context_.summary.non_manifold_vertices = bow_ties_.count;
    }

    bool is_soup() const {
        std::vector<bool> used(context_.mesh.vertex_count(), false);
        for (const Index v : context_.mesh.corner_vertices) {
            if (used[v]) return false;
            used[v] = true;
        }
        return true;
    }

    static std::size_t count_distinct(std::vector<Index>& values) {
        std::sort(values.begin(), values.end());
        return std::size_t(std::unique(values.begin(), values.end()) - values.begin());
    }

    // Loops of open edges: each is joined to the one at its end, and at its beginning where faces
    // are turned against each other, as then two may begin at one point.
    void find_holes() {
        DisjointSets loops(context_.mesh.corner_count());
        std::vector<Index> open;
        for (Index c = 0; c < context_.mesh.corner_count(); ++c) {
            if (topology_.kinds[c] != EdgeKind::border) continue;
            open.push_back(c);
            if (const Index k = around(c, next(c), true); k != no_index) loops.unite(c, k);
            if (mixed_.count == 0) continue;
            if (const Index k = around(c, previous(c), false); k != no_index) loops.unite(c, k);
        }
        for (const Index c : open)
            if (loops.find(c) == c) holes_.add(c);
        context_.summary.holes = holes_.count;
    }

    // The open edge that ends the walk around a point of the open edge `from`, from face to face;
    // `k`: the next edge there, which begins at the point (`leaves` it) or ends at it. None where
    // many faces share an edge.
    Index around(Index from, Index k, bool leaves) const {
        while (k != from) {
            if (topology_.kinds[k] == EdgeKind::degenerate) {
                k = leaves ? next(k) : previous(k);
            } else if (const Index o = topology_.opposite[k]; o != no_index) {
                k = leaves ? next(o) : previous(o);
            } else if (const Index m = turned_neighbor(k); m != no_index) {
                // It has the edge the same way: the one beside it, the other way.
                k = leaves ? previous(m) : next(m);
                leaves = !leaves;
            } else {
                break;
            }
        }
        return topology_.kinds[k] == EdgeKind::border ? k : no_index;
    }

    // The half-edge that a face turned against this one's has of the same edge.
    Index turned_neighbor(Index c) const {
        if (topology_.kinds[c] != EdgeKind::inconsistent) return no_index;
        const Index a = context_.point_of(c), b = context_.point_of(next(c));
        const CrowdedEdge first{edge_key(a, b), 0};
        for (auto at = std::lower_bound(crowded_.begin(), crowded_.end(), first);
             at != crowded_.end() && at->edge == first.edge; ++at)
            if (at->corner != c) return at->corner;
        return no_index;
    }

    void measure_components() {
        MeshSummary& summary = context_.summary;
        summary.closed = context_.mesh.face_count() > 0 && open_.count == 0;
        summary.manifold = non_manifold_.count == 0 && bow_ties_.count == 0;
        summary.oriented = mixed_.count == 0;
        const Shells shells = measure_shells(context_.mesh, topology_, context_.faces, components_);
        summary.components = shells.count;
        summary.euler =
            std::int64_t(vertices_) - std::int64_t(summary.edges) + std::int64_t(summary.faces);
        if (summary.closed && summary.manifold && summary.oriented) {
            summary.genus = std::int64_t(summary.components) - summary.euler / 2;
            summary.volume = shells.volume;
        }
        for (const Index face : shells.inside_out) inverted_.add(face);
    }

    void add_findings() {
        context_.add("non-manifold-edge", Severity::warning, PlaceKind::edge,
                     std::move(non_manifold_), "three or more faces share the edge");
        context_.add("mixed-orientation", Severity::warning, PlaceKind::edge, std::move(mixed_),
                     "the two faces of the edge are turned against each other");
        context_.add("non-manifold-vertex", Severity::warning, PlaceKind::vertex,
                     std::move(bow_ties_),
                     "parts of the surface hang together by the vertex alone");
        context_.add("open-edge", Severity::info, PlaceKind::edge, std::move(open_),
                     "only one face has the edge");
        context_.add("hole", Severity::info, PlaceKind::edge, std::move(holes_),
                     "open edges form a loop: a hole or the rim of an open surface");
        context_.add("inside-out-shell", Severity::warning, PlaceKind::face, std::move(inverted_),
                     "the faces of a closed surface look inwards");
    }

    CheckContext& context_;
    const Topology& topology_;
    std::span<const Index> offsets_;
    DisjointSets components_;
    std::vector<CrowdedEdge> crowded_;
    std::uint64_t vertices_ = 0;
    Places open_, non_manifold_, mixed_, bow_ties_, holes_, inverted_;
};

}  // namespace

void check_adjacency(CheckContext& context) {
    AdjacencyCheck(context).run();
}

}  // namespace prep::detail
