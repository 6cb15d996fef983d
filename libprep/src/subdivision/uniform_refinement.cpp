#include "subdivision/uniform_refinement.h"

#include <algorithm>

#include "base/parallel.h"
#include "prep/topology.h"

namespace prep::detail {

FacePieces pieces_of(std::uint64_t size, int level, bool triangles) {
    if (level == 0) return {1, size};
    if (size == 4 || triangles) return {std::uint64_t(1) << (2 * level), triangles ? 3U : 4U};
    return {size << (2 * (level - 1)), 4};
}

UniformRefinement::UniformRefinement(const Mesh& m, const SubdivideOptions& o,
                                     const SurfaceCage& cage, const RefinedCage& r,
                                     const PatchTree& tree)
    : mesh(m), options(o), positions(cage), refined(r) {
    first_faces.resize(tree.roots.size());
    for (std::uint32_t k = 0; k < tree.roots.size(); ++k) {
        const PatchRoot& root = tree.roots[k];
        if (!refined.has_surface[root.cage_face]) continue;
        roots.push_back(k);
        const std::uint32_t size = face_size(root.cage_face);
        first_faces[k] = face_count;
        if (root.corner > 0 && options.level == 0) continue;
        const FacePieces pieces = pieces_of(size, options.level, triangles());
        const bool whole = size == positions.corners_per_face() || options.level == 0;
        face_count += whole ? pieces.faces : pieces.faces / size;
        corner_count += whole ? pieces.corners() : pieces.corners() / size;
    }
}

NumberedTopology UniformRefinement::topology(std::span<const std::uint32_t> corner_vertices,
                                             std::uint32_t vertex_count) const {
    NumberedTopology topology;
    topology.face_offsets = positions.face_offsets;
    topology.corner_vertices.assign(corner_vertices.begin(), corner_vertices.end());
    topology.vertex_count = vertex_count;
    const RefinedLevel& base = refined.levels[0];
    // One edge of the cage may be several here: one for each pair of ends, low end of the cage
    // first.
    struct Edge {
        std::uint32_t low, high, next;
    };
    std::vector<Edge> edges;
    std::vector<std::uint32_t> first(refined.edge_count, no_index);
    const std::size_t corners = corner_vertices.size();
    topology.corner_edges.resize(corners);
    topology.forward.resize(corners);
    for (std::uint32_t f = 0; f < positions.face_count(); ++f)
        for (std::uint32_t c = positions.face_offsets[f]; c < positions.face_offsets[f + 1]; ++c) {
            const std::uint32_t to = next_corner(positions.face_offsets, f, c);
            const bool forward = positions.corner_vertices[c] <= positions.corner_vertices[to];
            const std::uint32_t low = corner_vertices[forward ? c : to];
            const std::uint32_t high = corner_vertices[forward ? to : c];
            std::uint32_t edge = first[base.edges[c]];
            while (edge != no_index && (edges[edge].low != low || edges[edge].high != high))
                edge = edges[edge].next;
            if (edge == no_index) {
                edge = std::uint32_t(edges.size());
                edges.push_back({low, high, first[base.edges[c]]});
                first[base.edges[c]] = edge;
            }
            topology.corner_edges[c] = edge;
            topology.forward[c] = forward;
        }
    topology.edge_count = std::uint32_t(edges.size());
    return topology;
}

void UniformRefinement::evaluate(const PatchRoot& root, std::uint32_t index,
                                 const GridNumbering& numbering, const SurfacePieces& pieces,
                                 PatchEvaluator& evaluator, const GridTables& tables,
                                 bool derivatives, Scratch& scratch) const {
    numbering.root(root.cage_face, root.corner, scratch.ids, scratch.own);
    const std::uint32_t width = pieces.source.width;
    const std::uint32_t n = std::max(1U, numbering.cells(face_size(root.cage_face)));
    const std::size_t count = std::size_t(n + 1) * (n + 1) * width;
    scratch.value.resize(count);
    if (derivatives) scratch.du.resize(count), scratch.dv.resize(count);
    if (options.level == 0 && options.control_points) {
        // The cage itself; in a quad's order of points.
        const RefinedLevel& base = pieces.cage->levels[0];
        const std::uint32_t first = base.face_offsets[root.cage_face];
        static constexpr std::uint32_t corner_of_point[4] = {0, 1, 3, 2};
        const std::uint32_t size = face_size(root.cage_face);
        const bool whole = size == 4 || triangles();
        for (std::uint32_t k = 0; k < (whole ? size : 1); ++k)
            std::copy_n(pieces.source.of(base.corner_vertices[first + (size == 3 && whole ? k
                                                                       : whole ? corner_of_point[k]
                                                                               : root.corner)]),
                        width, scratch.value.data() + std::size_t(k) * width);
        return;
    }
    GridOutput out;
    out.value = scratch.value.data();
    if (derivatives) out.du = scratch.du.data(), out.dv = scratch.dv.data();
    out.stride = std::size_t(n + 1) * width;
    evaluator.grid(index, n, options.control_points, tables, out);
}

// Row by row, an upright triangle and the inverted one beside it.
void UniformRefinement::write_triangles(std::uint32_t n, std::span<const std::uint32_t> ids,
                                        std::uint32_t* out) {
    std::size_t row = 0;
    for (std::uint32_t j = 0; j < n; ++j) {
        const std::size_t above = row + n + 1 - j;
        for (std::uint32_t i = 0; i + j < n; ++i) {
            *out++ = ids[row + i], *out++ = ids[row + i + 1], *out++ = ids[above + i];
            if (i + j + 1 == n) continue;
            *out++ = ids[row + i + 1], *out++ = ids[above + i + 1], *out++ = ids[above + i];
        }
        row = above;
    }
}

void UniformRefinement::write_corners(const PatchRoot& root, std::uint32_t index,
                                      const GridNumbering& numbering,
                                      std::span<const std::uint32_t> ids,
                                      std::vector<std::uint32_t>& corners) const {
    const std::uint32_t size = face_size(root.cage_face);
    if (options.level == 0) return;  // written face by face
    const std::uint32_t n = numbering.cells(size);
    if (triangles()) return write_triangles(n, ids, corners.data() + 3 * first_faces[index]);
    std::uint32_t* out = corners.data() + 4 * first_faces[index];
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::size_t at = std::size_t(j) * (n + 1) + i;
            *out++ = ids[at];
            *out++ = ids[at + 1];
            *out++ = ids[at + n + 2];
            *out++ = ids[at + n + 1];
        }
}

Result<bool> UniformRefinement::refine_channel(const SurfaceCage& cage,
                                               std::span<const double> numbers, std::uint32_t width,
                                               std::vector<float>& out,
                                               std::vector<std::uint32_t>& corners) const {
    Result<ChannelSurface> surface =
        ChannelSurface::make(cage, numbers, width, false, options.level, options.threads);
    if (!surface) return surface.error();
    const NumberedTopology topology = this->topology(cage.corner_vertices, cage.vertex_count);
    const GridNumbering numbering = this->numbering(topology);
    const GridTables tables(options.level, surface->tree.sharpnesses, triangles());
    out.resize(numbering.count() * width);
    corners.resize(corner_count);
    parallel_blocks(roots.size(), 32, options.threads, [&](std::size_t begin, std::size_t end) {
        const SurfacePieces pieces = surface->pieces();
        PatchEvaluator evaluator(pieces, options.simd);
        Scratch scratch;
        for (std::size_t k = begin; k < end; ++k) {
            const PatchRoot& root = surface->tree.roots[roots[k]];
            evaluate(root, roots[k], numbering, pieces, evaluator, tables, false, scratch);
            for (std::size_t p = 0; p < scratch.ids.size(); ++p) {
                if (!scratch.own[p]) continue;
                float* const to = out.data() + std::size_t(scratch.ids[p]) * width;
                for (std::uint32_t d = 0; d < width; ++d)
                    to[d] = float(scratch.value[p * width + d]);
            }
            write_corners(root, roots[k], numbering, scratch.ids, corners);
        }
    });
    if (options.level == 0) write_cage_corners(numbering, cage.corner_vertices, corners);
    return surface->cage.approximate_seams;
}

void UniformRefinement::write_cage_corners(const GridNumbering& numbering,
                                           std::span<const std::uint32_t> corner_vertices,
                                           std::vector<std::uint32_t>& corners) const {
    corners.clear();
    for (std::uint32_t f = 0; f < positions.face_count(); ++f)
        if (refined.has_surface[f])
            for (std::uint32_t c = positions.face_offsets[f]; c < positions.face_offsets[f + 1];
                 ++c)
                corners.push_back(numbering.vertex(corner_vertices[c]));
}

}  // namespace prep::detail
