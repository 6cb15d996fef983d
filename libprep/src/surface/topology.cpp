#include "prep/topology.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"
#include "base/step_count.h"
#include "surface/corner_steps.h"
#include "surface/vertex_corners.h"

namespace prep {
namespace {

using Index = std::uint32_t;

// Vertices per block of work; a block's time is about 1 ms, far above the cost of handing it out.
constexpr std::size_t vertex_grain = 16384;
constexpr std::size_t adjacency_grain = 32768;

// An edge's half-edges at its lower end, packed so that sorting groups them by upper end.
std::uint64_t packed(Index upper, Index half_edge) {
    return std::uint64_t(upper) << 32 | half_edge;
}
Index upper_of(std::uint64_t entry) {
    return Index(entry >> 32);
}
Index half_edge_of(std::uint64_t entry) {
    return Index(entry);
}

// A handful in nearly all cases. Gives the number of comparisons.
std::size_t sort_entries(std::vector<std::uint64_t>& entries) {
    std::size_t steps = entries.size();
    if (entries.size() > 24) {
        std::sort(entries.begin(), entries.end(), [&](std::uint64_t a, std::uint64_t b) {
            ++steps;
            return a < b;
        });
        return steps;
    }
    for (std::size_t i = 1; i < entries.size(); ++i) {
        const std::uint64_t e = entries[i];
        std::size_t k = i;
        for (; k > 0 && entries[k - 1] > e; --k) entries[k] = entries[k - 1];
        entries[k] = e;
        steps += i - k;
    }
    return steps;
}

template <class Steps>
class Pairing {
  public:
    Pairing(const Steps& steps, std::span<const Index> points, Topology& topology)
        : steps_(steps), points_(points), topology_(topology) {}

    // Pairs the half-edges without an opposite whose lower end is in [begin, end).
    void run(const detail::VertexCorners& around, std::size_t begin, std::size_t end) {
        std::size_t steps = 0;
        for (std::size_t v = begin; v < end; ++v) {
            entries_.clear();
            for (Index i = around.offsets[v]; i < around.offsets[v + 1]; ++i) {
                const Index c = around.corners[i], before = steps_.previous(c);
                const Index to = points_[steps_.next(c)], from = points_[before];
                if (to > v && takes_part(c)) entries_.push_back(packed(to, c));
                if (from > v && takes_part(before)) entries_.push_back(packed(from, before));
            }
            steps += sort_entries(entries_);
            for (std::size_t i = 0; i < entries_.size();) {
                std::size_t k = i + 1;
                while (k < entries_.size() && upper_of(entries_[k]) == upper_of(entries_[i])) ++k;
                pair({entries_.data() + i, k - i}, Index(v));
                i = k;
            }
        }
        detail::count_steps(steps);
    }

  private:
    bool takes_part(Index c) const {
        return topology_.opposite[c] == no_index && topology_.kinds[c] != EdgeKind::degenerate;
    }

    void link(Index a, Index b) {
        topology_.opposite[a] = b;
        topology_.opposite[b] = a;
        topology_.kinds[a] = topology_.kinds[b] = EdgeKind::interior;
    }

    // All half-edges between `lower` and one other point.
    void pair(std::span<const std::uint64_t> run, Index lower) {
        if (run.size() == 1) {
            topology_.kinds[half_edge_of(run[0])] = EdgeKind::border;
            return;
        }
        const auto forward = [&](Index c) { return points_[c] == lower; };
        if (run.size() == 2) {
            const Index a = half_edge_of(run[0]), b = half_edge_of(run[1]);
            if (forward(a) != forward(b))
                link(a, b);
            else
                topology_.kinds[a] = topology_.kinds[b] = EdgeKind::inconsistent;
            return;
        }
        pair_many(run, lower);
    }

    // A face that has run empty between two points (a triangle with a repeated corner) uses their
    // edge once in either direction. The faces on its sides are neighbours through it: the chain
    // real – empty – … – empty – real. Where no chain can be, it is its own neighbour, as it is on
    // an edge of no other face: it opens no surface.
    void pair_many(std::span<const std::uint64_t> run, Index lower) {
        std::vector<Index> forward, backward;
        std::vector<std::pair<Index, Index>> empty;  // forward, backward half-edge
        for (const std::uint64_t entry : run) {
            const Index c = half_edge_of(entry);
            if (!is_empty_at(c)) {
                (points_[c] == lower ? forward : backward).push_back(c);
            } else if (points_[c] == lower) {
                Index back = c;
                do back = steps_.next(back);
                while (points_[back] == lower);
                // The half-edge that leaves the last corner at the upper point.
                while (points_[steps_.next(back)] != lower) back = steps_.next(back);
                if (takes_part(back)) empty.emplace_back(c, back);
            }
        }
        for (const std::uint64_t entry : run)
            topology_.kinds[half_edge_of(entry)] = EdgeKind::border;
        const std::size_t real = forward.size() + backward.size();
        if (real > 0 && forward.size() <= 1 && backward.size() <= 1) {
            Index open = forward.empty() ? no_index : forward[0];
            for (const auto& [there, back] : empty) {
                if (open != no_index) link(open, back);
                open = there;
            }
            if (open != no_index && !backward.empty()) link(open, backward[0]);
            return;
        }
        for (const auto& [there, back] : empty) link(there, back);
        const EdgeKind kind = real == 2 ? EdgeKind::inconsistent : EdgeKind::non_manifold;
        for (const auto* side : {&forward, &backward})
            for (const Index c : *side) topology_.kinds[c] = kind;
    }

    // Whether the half-edge's face has but two points, visited there and back once. It ends at the
    // third turn: walks from all half-edges of a face take time linear in its corners together.
    bool is_empty_at(Index half_edge) const {
        const Index a = points_[half_edge], b = points_[steps_.next(half_edge)];
        int turns = 0;
        Index c = half_edge;
        do {
            const Index next = steps_.next(c);
            if (points_[next] != a && points_[next] != b) return false;
            turns += points_[c] != points_[next];
            if (turns > 2) return false;
            c = next;
        } while (c != half_edge);
        return true;
    }

    Steps steps_;
    std::span<const Index> points_;
    Topology& topology_;
    std::vector<std::uint64_t> entries_;
};

}  // namespace

Topology build_topology(const MeshView& mesh, std::span<const std::uint32_t> welded, int threads) {
    const std::size_t vertices = mesh.positions.size();
    const std::size_t corners = mesh.corner_count();
    Topology topology;
    topology.welded.resize(vertices);
    bool any_welded = false;
    assert(welded.empty() || welded.size() == vertices);
    for (Index v = 0; v < vertices; ++v) {
        topology.welded[v] = welded.empty() ? v : welded[v];
        any_welded |= topology.welded[v] != v;
    }

    topology.corner_faces.resize(corners);
    topology.opposite.assign(corners, no_index);
    topology.kinds.assign(corners, EdgeKind::border);
    std::vector<Index> welded_points(any_welded ? corners : 0);
    detail::parallel_blocks(
        mesh.face_count(), adjacency_grain, threads, [&](std::size_t first, std::size_t last) {
            for (std::size_t f = first; f < last; ++f) {
                const Index begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
                Index previous = topology.welded[mesh.corner_vertices[end - 1]];
                for (Index c = begin; c < end; ++c) {
                    const Index point = topology.welded[mesh.corner_vertices[c]];
                    topology.corner_faces[c] = Index(f);
                    if (any_welded) welded_points[c] = point;
                    if (point == previous)
                        topology.kinds[c == begin ? end - 1 : c - 1] = EdgeKind::degenerate;
                    previous = point;
                }
            }
        });

    const auto pair_over = [&](std::span<const Index> points) {
        detail::VertexCorners around = detail::corners_by_vertex(points, vertices, threads);
        detail::with_steps(mesh, topology.corner_faces, [&](const auto& steps) {
            detail::parallel_blocks(vertices, vertex_grain, threads,
                                    [&](std::size_t begin, std::size_t end) {
                                        Pairing pairing(steps, points, topology);
                                        pairing.run(around, begin, end);
                                    });
        });
        topology.point_offsets = std::move(around.offsets);
        topology.point_corners = std::move(around.corners);
    };
    pair_over(mesh.corner_vertices);
    if (any_welded) pair_over(welded_points);
    return topology;
}

}  // namespace prep
