#include "subdivision/refined_positions.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "base/parallel.h"
#include "model/vertex_deltas.h"
#include "prep/topology.h"

namespace prep::detail {
namespace {

// The topology of normals: that of positions, cut open along infinitely sharp edges.
NumberedTopology normal_topology(const UniformRefinement& refinement) {
    const RefinedLevel& base = refinement.refined.levels[0];
    const auto& offsets = refinement.positions.face_offsets;
    const std::size_t corners = base.corner_vertices.size();
    NumberedTopology topology;
    topology.face_offsets = offsets;
    // Corners around one vertex that smooth edges join, by the lowest.
    std::vector<std::uint32_t> lowest(corners);
    std::iota(lowest.begin(), lowest.end(), 0U);
    const auto root = [&](std::uint32_t c) {
        while (lowest[c] != c) c = lowest[c] = lowest[lowest[c]];
        return c;
    };
    topology.corner_edges.resize(corners);
    topology.forward.assign(corners, 1);
    std::vector<std::uint32_t> faces(corners);
    for (std::uint32_t f = 0; f + 1 < offsets.size(); ++f)
        for (std::uint32_t c = offsets[f]; c < offsets[f + 1]; ++c) faces[c] = f;
    for (std::uint32_t c = 0; c < corners; ++c) {
        const std::uint32_t o = base.sharp[c] ? no_index : base.opposite[c];
        if (o == no_index || c < o) {
            topology.corner_edges[c] = topology.edge_count++;
            if (o == no_index) continue;
        } else {
            topology.corner_edges[c] = topology.corner_edges[o];
            topology.forward[c] = 0;
        }
        const std::uint32_t a = root(c), b = root(next_corner(offsets, faces[o], o));
        lowest[std::max(a, b)] = std::min(a, b);
    }
    topology.corner_vertices.resize(corners);
    for (std::uint32_t c = 0; c < corners; ++c)
        topology.corner_vertices[c] =
            root(c) == c ? topology.vertex_count++ : topology.corner_vertices[root(c)];
    return topology;
}

}  // namespace

TargetDeltas target_deltas(const Mesh& mesh) {
    TargetDeltas all;
    for (std::size_t t = 0; t < mesh.morph_targets.size(); ++t) {
        const auto& runs = mesh.morph_targets[t].positions;
        if (runs.empty()) continue;
        std::vector<glm::vec3> deltas(mesh.vertex_count(), glm::vec3(0.0F));
        for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
            if (const glm::vec3* d = delta_of(runs, mesh.file_vertex(v))) deltas[v] = *d;
        all.targets.push_back(t);
        all.deltas.push_back(std::move(deltas));
    }
    return all;
}

RefinedPositions refined_positions(const UniformRefinement& refinement,
                                   const ChannelSurface& surface, const GridNumbering& numbering) {
    const SubdivideOptions& options = refinement.options;
    const bool with_normals = !options.control_points, triangles = refinement.triangles();
    const std::uint32_t width = surface.width();
    RefinedPositions out;
    out.positions.resize(numbering.count());
    out.corner_vertices.resize(refinement.corner_count);
    const NumberedTopology topology =
        with_normals ? normal_topology(refinement) : NumberedTopology{};
    std::unique_ptr<GridNumbering> normal_numbering;
    if (with_normals) {
        normal_numbering = std::make_unique<GridNumbering>(refinement.numbering(topology));
        out.normals.values.resize(normal_numbering->count());
        out.normals.indices.resize(refinement.corner_count);
    }
    const GridTables tables(options.level, surface.tree.sharpnesses, refinement.triangles());
    std::atomic<std::uint64_t> fallbacks{0};
    const auto& positions = refinement.positions;
    parallel_blocks(
        refinement.roots.size(), 32, options.threads, [&](std::size_t begin, std::size_t end) {
            const SurfacePieces pieces = surface.pieces();
            PatchEvaluator evaluator(pieces, options.simd);
            UniformRefinement::Scratch scratch;
            std::vector<std::uint32_t> normal_ids;
            std::vector<std::uint8_t> normal_own;
            std::uint64_t block_fallbacks = 0;
            for (std::size_t k = begin; k < end; ++k) {
                const std::uint32_t index = refinement.roots[k];
                const PatchRoot& root = surface.tree.roots[index];
                refinement.evaluate(root, index, numbering, pieces, evaluator, tables, with_normals,
                                    scratch);
                for (std::size_t p = 0; p < scratch.ids.size(); ++p) {
                    if (!scratch.own[p]) continue;
                    const double* from = scratch.value.data() + p * width;
                    out.positions[scratch.ids[p]] = {float(from[0]), float(from[1]),
                                                     float(from[2])};
                }
                refinement.write_corners(root, index, numbering, scratch.ids, out.corner_vertices);
                if (!with_normals) continue;
                normal_numbering->root(root.cage_face, root.corner, normal_ids, normal_own);
                const std::uint32_t n =
                    std::max(1U, numbering.cells(positions.face_size(root.cage_face)));
                const auto corners = std::span(positions.corner_vertices)
                                         .subspan(positions.face_offsets[root.cage_face],
                                                  positions.face_size(root.cage_face));
                for (std::uint32_t j = 0, p = 0; j <= n; ++j)
                    for (std::uint32_t i = 0; i + (triangles ? j : 0) <= n; ++i, ++p) {
                        if (!normal_own[p]) continue;
                        const double *du = scratch.du.data() + std::size_t(p) * width,
                                     *dv = scratch.dv.data() + std::size_t(p) * width;
                        const PointNormal normal =
                            point_normal(surface, evaluator, index, double(i) / n, double(j) / n,
                                         {du[0], du[1], du[2]}, {dv[0], dv[1], dv[2]}, corners);
                        block_fallbacks += normal.fallback;
                        out.normals.values[normal_ids[p]] = glm::vec3(normal.normal);
                    }
                refinement.write_corners(root, index, *normal_numbering, normal_ids,
                                         out.normals.indices);
            }
            fallbacks += block_fallbacks;
        });
    if (options.level == 0) {
        refinement.write_cage_corners(numbering, positions.corner_vertices, out.corner_vertices);
        if (with_normals)
            refinement.write_cage_corners(*normal_numbering, topology.corner_vertices,
                                          out.normals.indices);
    }
    out.fallback_normals = fallbacks;
    return out;
}

std::vector<std::vector<glm::vec3>> refined_targets(const UniformRefinement& refinement,
                                                    const ChannelSurface& surface,
                                                    const GridNumbering& numbering,
                                                    const TargetDeltas& targets) {
    constexpr std::size_t at_once = 8;
    const SubdivideOptions& options = refinement.options;
    const std::size_t count = targets.deltas.size();
    std::vector<std::vector<glm::vec3>> out(count);
    if (count == 0) return out;
    const GridTables tables(options.level, surface.tree.sharpnesses, refinement.triangles());
    for (std::size_t first = 0; first < count; first += at_once) {
        const std::size_t end = std::min(count, first + at_once);
        const auto width = std::uint32_t(3 * (end - first));
        std::vector<double> numbers;
        numbers.reserve(refinement.mesh.vertex_count() * width);
        for (std::size_t v = 0; v < refinement.mesh.vertex_count(); ++v)
            for (std::size_t t = first; t < end; ++t) {
                const glm::vec3& d = targets.deltas[t][v];
                numbers.insert(numbers.end(), {d.x, d.y, d.z});
            }
        const RefinedValues values = surface.cage.refine(numbers, width);
        const ControlSource source{values.numbers.data(), width, nullptr};
        const RingValues rings(surface.tree, source, options.level, false, most_ring_numbers,
                               options.threads);
        const SurfacePieces pieces{&surface.cage, &surface.tree, source, &rings};
        for (std::size_t t = first; t < end; ++t) out[t].resize(numbering.count());
        parallel_blocks(refinement.roots.size(), 32, options.threads,
                        [&](std::size_t begin, std::size_t last) {
                            PatchEvaluator evaluator(pieces, options.simd);
                            UniformRefinement::Scratch scratch;
                            for (std::size_t k = begin; k < last; ++k) {
                                const std::uint32_t index = refinement.roots[k];
                                refinement.evaluate(surface.tree.roots[index], index, numbering,
                                                    pieces, evaluator, tables, false, scratch);
                                for (std::size_t p = 0; p < scratch.ids.size(); ++p) {
                                    if (!scratch.own[p]) continue;
                                    const double* from = scratch.value.data() + p * width;
                                    for (std::size_t t = first; t < end; ++t, from += 3)
                                        out[t][scratch.ids[p]] = {float(from[0]), float(from[1]),
                                                                  float(from[2])};
                                }
                            }
                        });
    }
    return out;
}

}  // namespace prep::detail
