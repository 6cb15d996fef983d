#include "tessellation/limit/ring_cones.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "limit_surface/channel_surface.h"
#include "limit_surface/loop_patch.h"
#include "tessellation/limit/bezier_patch.h"
#include "tessellation/limit/cone_kernels.h"
#include "tessellation/limit/limit_pieces.h"

namespace prep::detail {
namespace {

constexpr int first_level = tip_levels, last_level = 49;
constexpr std::size_t levels = last_level - first_level + 1;

// Patches of one ring's level, in any number.
class ConesOfPatches {
  public:
    ConesOfPatches(bool triangles, const glm::dvec3& normal, SimdLevel simd)
        : triangles_(triangles), normal_{normal.x, normal.y, normal.z}, simd_(simd) {}

    // The cone is widened at the latest by flush().
    void add(const double* controls, double& cone) {
        for (std::size_t c = 0; c < count_of_numbers(); ++c)
            controls_[c * patches_at_once + held_] = controls[c];
        cones_[held_] = &cone;
        if (++held_ == patches_at_once) flush();
    }
    void flush() {
        static const CubicWeights whole = bezier_weights(0, 1);
        std::array<double, patches_at_once> widest;
        if (held_ == 0) return;
        if (triangles_)
            quartic_cones(controls_.data(), loop_bezier_weights()[0].data(), normal_.data(),
                          widest.data(), simd_);
        else
            bicubic_cones(controls_.data(), whole[0].data(), normal_.data(), widest.data(), simd_);
        for (std::size_t p = 0; p < held_; ++p)
            *cones_[p] = std::max(*cones_[p], chord_of_tangent(widest[p]));
        held_ = 0;
    }

  private:
    std::size_t count_of_numbers() const { return triangles_ ? 36 : 48; }

    bool triangles_;
    std::array<double, 3> normal_;
    SimdLevel simd_;
    std::size_t held_ = 0;
    std::array<double, 48 * patches_at_once> controls_{};
    std::array<double*, patches_at_once> cones_{};
};

}  // namespace

double chord_of_tangent(double tangent) {
    constexpr double longest = 2;
    const double length = std::hypot(1.0, tangent);
    return std::min(longest, tangent / length * std::sqrt(2 / (1 + 1 / length)));
}

RingCones::RingCones(const ChannelSurface& surface, int threads, SimdLevel simd) {
    std::size_t sectors = 0;
    for (const Ring& ring : surface.tree.rings) {
        first_.push_back(sectors);
        sectors += ring.shape.sectors;
    }
    cones_.resize(sectors * levels);
    parallel_blocks(first_.size(), 16, threads, [&](std::size_t begin, std::size_t end) {
        RingLevels walked;
        std::vector<double> most;
        for (std::size_t r = begin; r < end; ++r) {
            const Ring& ring = surface.tree.rings[r];
            float* const cones = cones_.data() + first_[r] * levels;
            ConesOfPatches patches(ring.shape.triangles,
                                   surface.rings.normal(std::uint32_t(r)).normal, simd);
            walked.start(ring, 3, surface.rings.level(surface.tree, std::uint32_t(r), 0));
            // Without a margin: where rings grow thin, level by level, roundings are in the end as
            // large as they are wide, here and in what evaluation takes for the normal. After the
            // deepest level that is the vertex' own.
            for (int k = first_level; k < ring.shape.deepest_level(); ++k) {
                const double* const rings = walked.level(k);
                const double* const next = walked.after();
                most.assign(ring.shape.sectors, 0);
                for (std::uint32_t j = 0; j < ring.shape.sectors; ++j)
                    for (int part = 1; part < 4; ++part) {
                        std::array<double, 48> controls;
                        ring_patch(ring.shape, 3, rings, next, j, part & 1, part >> 1,
                                   controls.data());
                        patches.add(controls.data(), most[j]);
                    }
                patches.flush();
                for (std::uint32_t j = 0; j < ring.shape.sectors; ++j)
                    cones[j * levels + std::size_t(k - first_level)] =
                        std::nextafter(float(most[j]), std::numeric_limits<float>::infinity());
            }
            for (std::uint32_t j = 0; j < ring.shape.sectors; ++j)
                for (std::size_t k = levels - 1; k > 0; --k) {
                    float* const cone = cones + j * levels + k;
                    cone[-1] = std::max(cone[-1], cone[0]);
                }
        }
    });
}

double RingCones::from_level(std::uint32_t ring, std::uint32_t sector, int k) const {
    assert(k >= first_level);
    if (k > last_level) return 0;
    return double(cones_[(first_[ring] + sector) * levels + std::size_t(k - first_level)]);
}

}  // namespace prep::detail
