#include "prep/topology.h"

#include <algorithm>
#include <cassert>

#include "parallel.h"

namespace prep {
namespace {

using Index = std::uint32_t;

// Vertices per block of work; a block's time is about 1 ms, far above the cost of handing it out.
constexpr std::size_t vertex_grain = 16384;

// Half-edges sorted by their lower end (counting sort, so ascending by corner within one vertex).
struct Buckets {
    std::vector<Index> offsets;
    struct Entry {
        Index upper;   // the higher end
        Index corner;  // the half-edge; its direction is read off the mesh
    };
    std::vector<Entry> entries;
};

// Marks the half-edges of one run: all those between the same two points.
void pair_run(std::span<const Buckets::Entry> run, std::span<const Index> from_vertex, Index lower,
              Topology& topology) {
    Index forward = no_index, backward = no_index;
    std::size_t forward_count = 0, backward_count = 0;
    for (const Buckets::Entry& e : run) {
        if (from_vertex[e.corner] == lower) {
            forward = e.corner;
            ++forward_count;
        } else {
            backward = e.corner;
            ++backward_count;
        }
    }
    if (forward_count == 1 && backward_count == 1) {
        topology.opposite[forward] = backward;
        topology.opposite[backward] = forward;
        topology.kinds[forward] = topology.kinds[backward] = EdgeKind::interior;
        return;
    }
    const EdgeKind kind = run.size() == 1   ? EdgeKind::border
                          : run.size() == 2 ? EdgeKind::inconsistent
                                            : EdgeKind::non_manifold;
    for (const Buckets::Entry& e : run) topology.kinds[e.corner] = kind;
}

// Pairs all half-edges that have no opposite yet, with vertices told apart by `point`
// (per corner). Degenerate ones are left out.
void pair_half_edges(std::span<const Index> from, std::span<const Index> to, std::size_t points,
                     int threads, Topology& topology) {
    const std::size_t corners = from.size();
    Buckets buckets;
    buckets.offsets.assign(points + 1, 0);
    const auto takes_part = [&](Index c) {
        return topology.opposite[c] == no_index && topology.kinds[c] != EdgeKind::degenerate;
    };
    std::size_t total = 0;
    for (Index c = 0; c < corners; ++c) {
        if (!takes_part(c)) continue;
        ++buckets.offsets[std::min(from[c], to[c]) + 1];
        ++total;
    }
    for (std::size_t v = 0; v < points; ++v) buckets.offsets[v + 1] += buckets.offsets[v];
    buckets.entries.resize(total);
    std::vector<Index> cursor(buckets.offsets.begin(), buckets.offsets.end() - 1);
    for (Index c = 0; c < corners; ++c) {
        if (!takes_part(c)) continue;
        const Index lower = std::min(from[c], to[c]);
        buckets.entries[cursor[lower]++] = {std::max(from[c], to[c]), c};
    }
    detail::parallel_blocks(points, vertex_grain, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            const auto first = buckets.entries.begin() + buckets.offsets[v];
            const auto last = buckets.entries.begin() + buckets.offsets[v + 1];
            std::sort(first, last, [](const Buckets::Entry& a, const Buckets::Entry& b) {
                return a.upper != b.upper ? a.upper < b.upper : a.corner < b.corner;
            });
            for (auto run = first; run != last;) {
                auto run_end = run + 1;
                while (run_end != last && run_end->upper == run->upper) ++run_end;
                pair_run({run, run_end}, from, Index(v), topology);
                run = run_end;
            }
        }
    });
}

}  // namespace

Topology build_topology(const MeshView& mesh, std::span<const std::uint32_t> welded, int threads) {
    const std::size_t vertices = mesh.positions.size();
    const std::size_t corners = mesh.corner_count();
    const std::size_t faces = mesh.face_count();
    Topology topology;
    topology.welded.resize(vertices);
    if (welded.empty()) {
        for (Index v = 0; v < vertices; ++v) topology.welded[v] = v;
    } else {
        assert(welded.size() == vertices);
        std::copy(welded.begin(), welded.end(), topology.welded.begin());
    }

    topology.corner_faces.resize(corners);
    topology.opposite.assign(corners, no_index);
    topology.kinds.assign(corners, EdgeKind::border);
    std::vector<Index> from(corners), to(corners);
    bool any_welded = false;
    for (Index f = 0; f < faces; ++f) {
        const Index begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        for (Index c = begin; c < end; ++c) {
            const Index a = mesh.corner_vertices[c];
            const Index b = mesh.corner_vertices[c + 1 == end ? begin : c + 1];
            topology.corner_faces[c] = f;
            from[c] = a;
            to[c] = b;
            if (topology.welded[a] == topology.welded[b]) topology.kinds[c] = EdgeKind::degenerate;
            any_welded |= topology.welded[a] != a;
        }
    }
    pair_half_edges(from, to, vertices, threads, topology);
    if (any_welded) {
        for (Index c = 0; c < corners; ++c) {
            from[c] = topology.welded[from[c]];
            to[c] = topology.welded[to[c]];
        }
        pair_half_edges(from, to, vertices, threads, topology);
    }

    topology.point_offsets.assign(vertices + 1, 0);
    for (Index c = 0; c < corners; ++c) ++topology.point_offsets[from[c] + 1];
    for (std::size_t v = 0; v < vertices; ++v)
        topology.point_offsets[v + 1] += topology.point_offsets[v];
    topology.point_corners.resize(corners);
    std::vector<Index> cursor(topology.point_offsets.begin(), topology.point_offsets.end() - 1);
    for (Index c = 0; c < corners; ++c) topology.point_corners[cursor[from[c]]++] = c;
    return topology;
}

}  // namespace prep
