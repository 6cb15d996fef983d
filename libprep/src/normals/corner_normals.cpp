#include "prep/corner_normals.h"

#include <algorithm>

#include "base/parallel.h"
#include "normals/degenerate_face_proxies.h"
#include "normals/fan_normal.h"
#include "surface/corner_steps.h"
#include "surface/fans.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t point_grain = 8192;

// One block of points: fans found, normals computed, in order.
struct Block {
    std::vector<glm::vec3> values;
    std::vector<glm::dvec3> doubles;
    detail::FanReport report;
};

// Normals of all fans at the points first … last−1; `indices` get numbers within the block.
template <class Steps>
void compute_block(const detail::FanWalker<Steps>& walker, const Topology& topology,
                   std::size_t first, std::size_t last, bool keep_doubles,
                   detail::FanNormal<Steps>& normal_of, std::vector<Index>& indices, Block& block) {
    std::vector<Index> corners;
    for (std::size_t v = first; v < last; ++v) {
        for (Index i = topology.point_offsets[v]; i < topology.point_offsets[v + 1]; ++i) {
            const Index c = topology.point_corners[i];
            if (indices[c] != no_index) continue;
            walker.collect(c, corners);
            for (const Index k : corners) indices[k] = Index(block.values.size());
            const glm::dvec3 normal = normal_of(corners, block.report);
            block.values.emplace_back(normal);
            if (keep_doubles) block.doubles.push_back(normal);
        }
    }
}

}  // namespace

Result<CornerNormals> corner_normals(const MeshView& mesh, const Topology& topology,
                                     const FaceNormals& faces, const HardEdges& hard,
                                     const NormalOptions& options) {
    const std::size_t points = mesh.positions.size();
    CornerNormals result;
    std::vector<Index>& indices = result.normals.indices;
    indices.assign(mesh.corner_count(), no_index);
    const std::vector<Index> stand_ins = detail::stand_in_faces(mesh, topology, faces);

    std::vector<Block> blocks((points + point_grain - 1) / point_grain);
    detail::with_steps(mesh, topology.corner_faces, [&](const auto& steps) {
        const detail::FanWalker walker(steps, topology, hard.reasons);
        detail::parallel_blocks(
            points, point_grain, options.threads, [&](std::size_t begin, std::size_t end) {
                detail::FanNormal normal_of(mesh, faces, options, steps, stand_ins);
                compute_block(walker, topology, begin, end, options.keep_doubles, normal_of,
                              indices, blocks[begin / point_grain]);
            });
    });

    // Values were numbered within their block; shift them by what the blocks before hold.
    std::vector<Index> bases(blocks.size() + 1, 0);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        bases[b + 1] = bases[b] + Index(blocks[b].values.size());
    result.normals.values.resize(bases.back());
    if (options.keep_doubles) result.doubles.resize(bases.back());
    detail::parallel_blocks(
        points, point_grain, options.threads, [&](std::size_t begin, std::size_t end) {
            const Block& block = blocks[begin / point_grain];
            const Index base = bases[begin / point_grain];
            std::copy(block.values.begin(), block.values.end(),
                      result.normals.values.begin() + base);
            if (options.keep_doubles)
                std::copy(block.doubles.begin(), block.doubles.end(),
                          result.doubles.begin() + base);
            if (base == 0) return;
            for (Index i = topology.point_offsets[begin]; i < topology.point_offsets[end]; ++i)
                indices[topology.point_corners[i]] += base;
        });
    for (const Block& block : blocks) {
        result.fallbacks.insert(result.fallbacks.end(), block.report.fallbacks.begin(),
                                block.report.fallbacks.end());
        result.exact_sums += block.report.exact_sums;
    }
    std::sort(result.fallbacks.begin(), result.fallbacks.end(),
              [](const auto& a, const auto& b) { return a.corner < b.corner; });
    return result;
}

}  // namespace prep
