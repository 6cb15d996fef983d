#include "prep/hard_edges.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "exact/exact_normals.h"
#include "normals/area_vector.h"
#include "normals/degenerate_face_proxies.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t edge_grain = 8192;
constexpr float infinitely_sharp = 10.0f;  // OpenSubdiv's SHARPNESS_INFINITE

// Edges marked hard, as sorted (low, high) pairs of welded vertices packed into 64 bits.
std::vector<std::uint64_t> marked_edges(const MeshView& mesh, const Topology& topology) {
    std::vector<std::uint64_t> keys;
    const auto add = [&](Index a, Index b) {
        if (a >= topology.welded.size() || b >= topology.welded.size()) return;
        const auto [low, high] = std::minmax(topology.welded[a], topology.welded[b]);
        keys.push_back(std::uint64_t(low) << 32 | high);
    };
    for (const glm::uvec2& e : mesh.hard_marks) add(e.x, e.y);
    for (const EdgeMark& e : mesh.creases)
        if (e.sharpness >= infinitely_sharp) add(e.v0, e.v1);
    std::sort(keys.begin(), keys.end());
    return keys;
}

class Decider {
  public:
    Decider(const MeshView& mesh, const Topology& topology, const FaceNormals& faces,
            const HardEdgeOptions& options)
        : mesh_(mesh), topology_(topology), faces_(faces), options_(options) {
        if (options.angle_degrees) threshold_ = detail::threshold_of(*options.angle_degrees);
        if (options.marks) marks_ = marked_edges(mesh, topology);
        grouped_ = options.smoothing_groups && !mesh.face_smoothing.empty();
        stand_ins_ = detail::stand_in_faces(mesh, topology, faces);
    }

    // Reasons of a half-edge with an opposite. `exact` counts decisions that the filter left open.
    std::uint8_t interior(Index corner, std::uint64_t& exact) const {
        const Index other = topology_.opposite[corner];
        const Index f = topology_.corner_faces[corner], g = topology_.corner_faces[other];
        if (faces_.states[f] == FaceState::non_finite || faces_.states[g] == FaceState::non_finite)
            return hard_border;
        std::uint8_t reasons = hard_none;
        bool use_angle = options_.angle_degrees.has_value();
        if (grouped_) {
            if (!in_common_group(mesh_.face_smoothing[f], mesh_.face_smoothing[g]))
                reasons |= hard_smoothing_group;
            use_angle &= options_.angle_inside_groups;
        }
        if (use_angle && turn_exceeds(f, g, exact)) reasons |= hard_angle;
        if (!marks_.empty() && is_marked(corner)) reasons |= hard_mark;
        if (options_.material_borders && !mesh_.face_materials.empty() &&
            mesh_.face_materials[f] != mesh_.face_materials[g])
            reasons |= hard_material;
        if (options_.uv_borders && !mesh_.uv.empty() && uv_differs(corner, f, other, g))
            reasons |= hard_uv_border;
        return reasons;
    }

    std::uint8_t without_opposite(Index corner) const {
        switch (topology_.kinds[corner]) {
            case EdgeKind::non_manifold:
            case EdgeKind::inconsistent:
                return hard_non_manifold;
            case EdgeKind::border:
                return hard_border;
            default:
                return hard_none;  // degenerate: both ends are one point, nothing to split
        }
    }

  private:
    bool in_common_group(std::uint32_t a, std::uint32_t b) const {
        if (mesh_.smoothing_kind == SmoothingKind::bit_mask) return (a & b) != 0;
        return a == b && a != 0;
    }

    bool turn_exceeds(Index f, Index g, std::uint64_t& exact) const {
        if (!stand_ins_.empty()) {
            f = stand_ins_[f];
            g = stand_ins_[g];
            if (f == g || f == no_index || g == no_index) return false;
        }
        const Verdict verdict =
            classify(faces_.area_vectors[f], faces_.area_vectors[g], faces_.relative_error);
        if (verdict != Verdict::open) return verdict == Verdict::exceeds;
        if (faces_.relative_error > accurate_face_error) {
            const Verdict closer =
                classify(detail::accurate_area_vector(mesh_, f),
                         detail::accurate_area_vector(mesh_, g), accurate_face_error);
            if (closer != Verdict::open) return closer == Verdict::exceeds;
        }
        ++exact;
        return detail::exact_turn_exceeds(mesh_, f, g, threshold_);
    }

    enum class Verdict { exceeds, stays, open };
    Verdict classify(const glm::dvec3& a, const glm::dvec3& b, double relative_error) const {
        const double product = glm::length(a) * glm::length(b);
        const double gap = glm::dot(a, b) - threshold_.cosine.cosine * product;
        // Rounding of the dot product, the lengths and the cosine: under 8 ulps of |a||b|; the
        // vectors' own errors enter through the dot product and through the lengths.
        const double error = (8 * 0x1p-52 + 5 * relative_error) * product;
        return gap < -error ? Verdict::exceeds : gap > error ? Verdict::stays : Verdict::open;
    }

    bool is_marked(Index corner) const {
        const Index f = topology_.corner_faces[corner];
        const Index a = topology_.welded[mesh_.corner_vertices[corner]];
        const Index b =
            topology_.welded[mesh_.corner_vertices[next_corner(mesh_.face_offsets, f, corner)]];
        const auto [low, high] = std::minmax(a, b);
        return std::binary_search(marks_.begin(), marks_.end(), std::uint64_t(low) << 32 | high);
    }

    bool uv_differs(Index corner, Index f, Index other, Index g) const {
        const auto same = [&](Index c, Index d) {
            const Index i = mesh_.uv.indices[c], j = mesh_.uv.indices[d];
            if (i == j) return true;
            if (i == no_index || j == no_index) return false;
            return mesh_.uv.values[i] == mesh_.uv.values[j];
        };
        return !same(corner, next_corner(mesh_.face_offsets, g, other)) ||
               !same(next_corner(mesh_.face_offsets, f, corner), other);
    }

    const MeshView& mesh_;
    const Topology& topology_;
    const FaceNormals& faces_;
    const HardEdgeOptions& options_;
    detail::Threshold threshold_;
    std::vector<std::uint64_t> marks_;
    std::vector<Index> stand_ins_;
    bool grouped_ = false;
};

}  // namespace

Result<HardEdges> hard_edges(const MeshView& mesh, const Topology& topology,
                             const FaceNormals& faces, const HardEdgeOptions& options) {
    if (options.angle_degrees && !(*options.angle_degrees >= 0 && *options.angle_degrees <= 180))
        return Error{ErrorCode::invalid,
                     "the hard-edge angle must be between 0 and 180 degrees, found " +
                         std::to_string(*options.angle_degrees),
                     ""};
    const Decider decider(mesh, topology, faces, options);
    HardEdges result;
    result.reasons.assign(mesh.corner_count(), hard_none);
    std::atomic<std::uint64_t> exact_total{0}, hard_total{0};
    detail::parallel_blocks(mesh.corner_count(), edge_grain * 3, options.threads,
                            [&](std::size_t begin, std::size_t end) {
                                std::uint64_t exact = 0, hard = 0;
                                for (std::size_t i = begin; i < end; ++i) {
                                    const Index c = Index(i), other = topology.opposite[c];
                                    if (other == no_index) {
                                        result.reasons[c] = decider.without_opposite(c);
                                    } else if (c < other) {
                                        // The lower half-edge decides for both; it alone writes to
                                        // either.
                                        const std::uint8_t reasons = decider.interior(c, exact);
                                        result.reasons[c] = result.reasons[other] = reasons;
                                        hard += reasons != hard_none;
                                    }
                                }
                                exact_total += exact;
                                hard_total += hard;
                            });
    result.exact_decisions = exact_total;
    result.hard_count = hard_total;
    return result;
}

}  // namespace prep
