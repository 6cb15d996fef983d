#include "prep/hard_edges.h"

#include <atomic>

#include "base/parallel.h"
#include "normals/degenerate_face_proxies.h"
#include "normals/edge_decider.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t edge_grain = 8192;

std::uint8_t lone_reasons(EdgeKind kind) {  // of a half-edge without an opposite
    switch (kind) {
        case EdgeKind::non_manifold:
        case EdgeKind::inconsistent:
            return hard_non_manifold;
        case EdgeKind::border:
            return hard_border;
        default:
            return hard_none;  // degenerate: both ends are one point, nothing to split
    }
}

}  // namespace

Result<HardEdges> hard_edges(const MeshView& mesh, const Topology& topology,
                             const FaceNormals& faces, const HardEdgeOptions& options) {
    if (options.angle_degrees && !(*options.angle_degrees >= 0 && *options.angle_degrees <= 180))
        return Error{ErrorCode::invalid,
                     "the hard-edge angle must be between 0 and 180 degrees, found " +
                         std::to_string(*options.angle_degrees),
                     ""};
    const detail::EdgeDecider decider(mesh, topology.welded, faces, options,
                                      detail::stand_in_faces(mesh, topology, faces));
    HardEdges result;
    result.reasons.assign(mesh.corner_count(), hard_none);
    std::atomic<std::uint64_t> exact_total{0}, hard_total{0};
    detail::parallel_blocks(mesh.corner_count(), edge_grain * 3, options.threads,
                            [&](std::size_t begin, std::size_t end) {
                                std::uint64_t exact = 0, hard = 0;
                                for (std::size_t i = begin; i < end; ++i) {
                                    const Index c = Index(i), other = topology.opposite[c];
                                    if (other == no_index) {
                                        result.reasons[c] = lone_reasons(topology.kinds[c]);
                                    } else if (c < other) {
                                        // The lower half-edge decides for both; it alone writes to
                                        // either.
                                        const std::uint8_t reasons =
                                            decider.reasons(c, topology.corner_faces[c], other,
                                                            topology.corner_faces[other], exact);
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
