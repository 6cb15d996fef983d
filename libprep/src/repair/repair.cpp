#include "prep/repair.h"

#include <cmath>

#include "repair/repair_steps.h"

namespace prep {

Result<std::vector<RepairStep>> repair(Mesh& mesh, const RepairOptions& options,
                                       std::uint32_t mesh_index, int threads) {
    using namespace detail;
    if (options.weld_tolerance &&
        !(std::isfinite(*options.weld_tolerance) && *options.weld_tolerance >= 0))
        return Error{ErrorCode::invalid,
                     "the weld tolerance must be a finite number that is not negative",
                     {}};
    std::vector<RepairStep> log;
    const auto add = [&](RepairStep step) {
        step.mesh = mesh_index;
        log.push_back(std::move(step));
    };
    Mesh work = mesh;
    if (options.weld_tolerance) add(weld_vertices(work, *options.weld_tolerance, threads));
    if (options.degenerate_faces) add(remove_degenerate_faces(work, threads));
    if (options.duplicate_faces) add(remove_duplicate_faces(work, threads));
    if (options.non_manifold_edges) add(split_non_manifold_edges(work, threads));
    if (options.non_manifold_vertices) add(split_non_manifold_vertices(work, threads));
    if (options.orientation) add(unify_orientation(work, threads));
    if (options.hole_edges > 0) add(fill_holes(work, options.hole_edges, threads));
    if (options.outward) add(turn_outward(work, threads));
    if (options.isolated_vertices) add(remove_isolated_vertices(work));
    if (work.positions.size() >= no_index || work.corner_vertices.size() >= no_index)
        return Error{
            ErrorCode::limit, "the repaired mesh has more than 2^32 - 2 vertices or corners", {}};
    mesh = std::move(work);
    return log;
}

}  // namespace prep
