#include "limit_surface/patch_evaluator.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "limit_surface/ring_masks.h"

namespace prep::detail {

GridTables::GridTables(int log2_most, std::span<const float> sharpnesses, bool triangles,
                       std::size_t most_bytes) {
    std::size_t bytes = 0;  // of the tables of one sharpness
    for (int k = 0; k <= log2_most; ++k) {
        const std::uint32_t n = 1U << k;
        if (triangles) triangles_.push_back(LoopTable::make(n));
        smooth_.push_back(BicubicTable::make(n));
        bytes += 2 * 3 * 4 * (std::size_t(n) + 1) * sizeof(double);
    }
    for (const float sharpness :
         sharpnesses.first(std::min(sharpnesses.size(), most_bytes / bytes)))
        for (int k = 0; k <= log2_most; ++k) {
            creases_.push_back(BicubicTable::make_crease(1U << k, sharpness));
            reversed_.push_back(creases_.back().reversed());
        }
}

void PatchEvaluator::grid(std::uint32_t root, std::uint32_t n, bool control_points,
                          const GridTables& tables, const GridOutput& out) {
    tables_ = &tables;
    kept_levels_ = tables.log2_most() + 2;
    control_points_ = control_points;
    const PatchRoot& at = pieces_.tree->roots[root];
    root_level_ = at.level;
    scratch_.resize(bicubic_scratch(pieces_.source.width, n));
    if (pieces_.cage->corners_per_face == 3) return triangle_grid(at, n, out);
    quad_cell({at.level, at.face, 0, 0, n}, out);
}

PointTraits PatchEvaluator::point(std::uint32_t root, double u, double v, double* value, double* du,
                                  double* dv, const SecondDerivatives* second) {
    const PatchRoot& at = pieces_.tree->roots[root];
    if (pieces_.cage->corners_per_face != 3) return quad_point(at, u, v, value, du, dv, second);
    return triangle_point(at.level, at.face, u, v, value, du, dv, second);
}

PatchEvaluator::Corners PatchEvaluator::corner_values(std::uint32_t level,
                                                      std::uint32_t face) const {
    const RefinedLevel& at = pieces_.cage->levels[level];
    const std::uint32_t count = pieces_.cage->corners_per_face;
    const std::uint32_t* const vertices = at.corner_vertices.data() + at.first_corner(face, count);
    Corners corners{};
    for (std::uint32_t c = 0; c < count; ++c)
        corners[c] = pieces_.source.of(at.first_vertex + vertices[c]);
    return corners;
}

PatchEvaluator::RingAccess PatchEvaluator::ring_access(std::uint32_t ring, int k) {
    const PatchTree& tree = *pieces_.tree;
    const RingValues* stored = pieces_.rings;
    if (stored && k < stored->stored_levels())
        return {stored->level(tree, ring, k), stored->level(tree, ring, k + 1),
                stored->centre(ring)};
    const int from = stored ? stored->stored_levels() : 0;
    WalkedRing& walked = walked_ring(ring, k - from);
    const double* const rings = walked.levels.level(k - from);
    return {rings, walked.levels.after(), stored ? stored->centre(ring) : walked.centre.data()};
}

PatchEvaluator::WalkedRing& PatchEvaluator::walked_ring(std::uint32_t ring, int k) {
    const Ring& shape = pieces_.tree->rings[ring];
    const RingValues* stored = pieces_.rings;
    WalkedRing* walked = &walked_;
    if (!stored && shape.shape.sectors >= many_sectors && k + 1 < kept_levels_) {
        const auto known = kept_.find(ring);
        if (known != kept_.end()) return known->second;
        const std::size_t numbers = std::size_t(shape.shape.point_count()) * pieces_.source.width *
                                    std::size_t(kept_levels_);
        if (kept_numbers_ + numbers <= most_kept_numbers_) {
            kept_numbers_ += numbers;
            walked = &kept_[ring];
            walked->levels = RingLevels(true);
        }
    }
    if (walked->ring == ring && walked->levels.can_give(k)) return *walked;
    walked->ring = ring;
    if (stored)
        walked->levels.start(shape, pieces_.source.width,
                             stored->level(*pieces_.tree, ring, stored->stored_levels()));
    else
        walked->centre = walked->levels.start(shape, *pieces_.tree, pieces_.source).numbers;
    gathered_points_ += shape.shape.point_count();
    return *walked;
}

std::size_t PatchEvaluator::held_ring_numbers() const {
    std::size_t sum = walked_.levels.held_numbers();
    for (const auto& [ring, kept] : kept_) sum += kept.levels.held_numbers();
    return sum;
}

void PatchEvaluator::sector_limit(const RingSector& sector, const RingAccess& access, int x, int y,
                                  double* value, double* da, double* db) const {
    const std::uint32_t width = pieces_.source.width;
    const RingShape& shape = pieces_.tree->rings[sector.ring].shape;
    if (x != 0 || y != 0) {
        ring_corner_limit(shape, width, access.rings, sector.sector, x, y, value, da, db);
        for (std::uint32_t d = 0; d < width; ++d) value[d] += access.centre[d];
        return;
    }
    const double *t0 = access.centre + width, *t1 = access.centre + 2 * width;
    const double a = ring_angle(shape) * sector.sector, b = ring_angle(shape) * (sector.sector + 1);
    for (std::uint32_t d = 0; d < width; ++d) {
        value[d] = access.centre[d];
        da[d] = std::cos(a) * t0[d] + std::sin(a) * t1[d];
        db[d] = std::cos(b) * t0[d] + std::sin(b) * t1[d];
    }
}

void PatchEvaluator::sector_point(const RingSector& sector, const RingAccess& access, int x, int y,
                                  double* value) const {
    const RingView ring{pieces_.tree->rings[sector.ring].shape, pieces_.source.width, access.rings};
    const double* const point = ring.point({sector.sector, x, y});
    for (std::uint32_t d = 0; d < ring.width; ++d) value[d] = point[d] + access.centre[d];
}

}  // namespace prep::detail
