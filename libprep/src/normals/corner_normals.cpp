#include "prep/corner_normals.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "exact/arc_tangent.h"
#include "exact/exact_corner_sums.h"
#include "exact/reproducible_sum.h"
#include "normals/area_vector.h"
#include "normals/degenerate_face_proxies.h"
#include "surface/corner_steps.h"
#include "surface/fans.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t point_grain = 8192;

glm::dvec3 unit(const glm::dvec3& v) {
    const glm::dvec3 scaled = v / detail::largest_component(v);
    return scaled / std::sqrt(glm::dot(scaled, scaled));
}

// One block of points: fans found, normals computed, in order.
struct Block {
    std::vector<glm::vec3> values;
    std::vector<glm::dvec3> doubles;
    std::vector<CornerNormals::Fallback> fallbacks;
    std::uint64_t exact_sums = 0;
};

template <class Steps>
class NormalMaker {
  public:
    NormalMaker(const MeshView& mesh, const Topology& topology, const FaceNormals& faces,
                const NormalOptions& options, const Steps& steps,
                const std::vector<Index>& stand_ins)
        : mesh_(mesh),
          topology_(topology),
          faces_(faces),
          options_(options),
          steps_(steps),
          stand_ins_(stand_ins) {}

    glm::dvec3 normal_of(const std::vector<Index>& corners, Block& block) {
        if (options_.precision != Precision::exact) {
            const bool fast = options_.precision == Precision::fast;
            const glm::dvec3 sum = trusted_sum(corners, !fast);
            if (sum != glm::dvec3(0.0)) return unit(sum);
            if (fast) {
                const glm::dvec3 better = trusted_sum(corners, true);
                if (better != glm::dvec3(0.0)) return unit(better);
            }
        }
        finite_.clear();
        for (const Index c : corners)
            if (faces_.states[steps_.face(c)] == FaceState::regular) finite_.push_back(c);
        if (!finite_.empty()) {
            ++block.exact_sums;
            const glm::dvec3 exact =
                detail::exact_corner_sum(mesh_, topology_.corner_faces, finite_, options_.weight);
            if (exact != glm::dvec3(0.0)) return unit(exact);
        }
        return fallback(corners, block);
    }

  private:
    // Zero where the sum's error bound is not small enough against the sum.
    glm::dvec3 trusted_sum(const std::vector<Index>& corners, bool accurate) {
        const bool compute_areas = accurate && faces_.relative_error > accurate_face_error;
        terms_.clear();
        for (const Index c : corners) {
            const Index face = steps_.face(c);
            const glm::dvec3 t = term(c, face,
                                      compute_areas && faces_.states[face] == FaceState::regular
                                          ? detail::accurate_area_vector(mesh_, face)
                                          : faces_.area_vectors[face]);
            terms_.emplace_back(t, std::abs(t.x) + std::abs(t.y) + std::abs(t.z));
        }
        const detail::OrderFreeSum sum = detail::order_free_sum(terms_);
        // The weights are good to a few ulps, less than the area vectors by far.
        const double relative =
            accurate ? 2 * accurate_face_error : fast_face_error + accurate_face_error;
        const double allowed = (accurate ? accurate_normal_error : fast_normal_error) *
                               detail::largest_component(sum.value);
        return relative * sum.size + sum.error <= allowed ? sum.value : glm::dvec3(0.0);
    }

    // The corner's term: its face's normal, weighted; zero where the face has none.
    glm::dvec3 term(Index corner, Index face, const glm::dvec3& area) const {
        if (options_.weight == NormalWeight::area || faces_.states[face] != FaceState::regular)
            return area;
        const glm::dvec3 normal = unit(area);
        if (options_.weight == NormalWeight::uniform) return normal;

        const auto at = [&](Index c) { return mesh_.positions[mesh_.corner_vertices[c]]; };
        const glm::vec3 p = at(corner), next = at(steps_.next(corner)),
                        previous = at(steps_.previous(corner));
        const glm::dvec3 e1 = glm::dvec3(next) - glm::dvec3(p);
        const glm::dvec3 e2 = glm::dvec3(previous) - glm::dvec3(p);
        // In a triangle the corner's cross product is the area vector.
        const bool triangle = steps_.end(face) - steps_.begin(face) == 3;
        const glm::dvec3 cross = triangle ? area : detail::corner_cross(p, next, previous);
        const double sine = glm::length(cross);  // times |e1||e2|
        if (options_.weight == NormalWeight::edge_length) {
            const double l1 = glm::dot(e1, e1), l2 = glm::dot(e2, e2);
            return l1 > 0 && l2 > 0 ? normal * (sine / l1 / l2) : glm::dvec3(0.0);
        }
        const double cosine = glm::dot(e1, e2);
        if (sine == 0 && cosine == 0) return glm::dvec3(0.0);
        double angle = detail::angle_of(sine, cosine);
        if (!triangle && glm::dot(cross, normal) < 0) angle = 2 * detail::pi - angle;
        return (options_.weight == NormalWeight::angle ? normal : area) * angle;
    }

    glm::dvec3 fallback(const std::vector<Index>& corners, Block& block) {
        const Index lowest = *std::min_element(corners.begin(), corners.end());
        glm::dvec3 best = largest_area(corners, false);
        NormalFallback kind = NormalFallback::largest_face;
        if (best == glm::dvec3(0.0)) {
            best = largest_area(corners, true);
            kind = NormalFallback::neighbour_face;
        }
        if (best == glm::dvec3(0.0)) {
            best = {0, 0, 1};
            kind = NormalFallback::none_defined;
        }
        block.fallbacks.push_back({lowest, kind});
        return unit(best);
    }

    glm::dvec3 largest_area(const std::vector<Index>& corners, bool of_stand_ins) const {
        glm::dvec3 best(0.0);
        double largest = 0;
        for (const Index c : corners) {
            Index face = steps_.face(c);
            if (of_stand_ins && !stand_ins_.empty()) face = stand_ins_[face];
            if (face == no_index) continue;
            const glm::dvec3& area = faces_.area_vectors[face];
            const double length = glm::dot(area, area);
            // Ties go by value, not by index, so that the order of the faces does not matter.
            if (length > largest ||
                (length == largest && length > 0 && lexicographic(best, area))) {
                largest = length;
                best = area;
            }
        }
        return best;
    }

    static bool lexicographic(const glm::dvec3& a, const glm::dvec3& b) {
        if (a.x != b.x) return a.x < b.x;
        if (a.y != b.y) return a.y < b.y;
        return a.z < b.z;
    }

    const MeshView& mesh_;
    const Topology& topology_;
    const FaceNormals& faces_;
    const NormalOptions& options_;
    Steps steps_;
    const std::vector<Index>& stand_ins_;
    std::vector<glm::dvec4> terms_;
    std::vector<Index> finite_;
};

// Normals of all fans at the points first … last−1; `indices` get numbers within the block.
template <class Steps>
void compute_block(const detail::FanWalker<Steps>& walker, const Topology& topology,
                   std::size_t first, std::size_t last, bool keep_doubles,
                   NormalMaker<Steps>& maker, std::vector<Index>& indices, Block& block) {
    std::vector<Index> corners;
    for (std::size_t v = first; v < last; ++v) {
        for (Index i = topology.point_offsets[v]; i < topology.point_offsets[v + 1]; ++i) {
            const Index c = topology.point_corners[i];
            if (indices[c] != no_index) continue;
            walker.collect(c, corners);
            for (const Index k : corners) indices[k] = Index(block.values.size());
            const glm::dvec3 normal = maker.normal_of(corners, block);
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
                NormalMaker maker(mesh, topology, faces, options, steps, stand_ins);
                compute_block(walker, topology, begin, end, options.keep_doubles, maker, indices,
                              blocks[begin / point_grain]);
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
        result.fallbacks.insert(result.fallbacks.end(), block.fallbacks.begin(),
                                block.fallbacks.end());
        result.exact_sums += block.exact_sums;
    }
    std::sort(result.fallbacks.begin(), result.fallbacks.end(),
              [](const auto& a, const auto& b) { return a.corner < b.corner; });
    return result;
}

}  // namespace prep
