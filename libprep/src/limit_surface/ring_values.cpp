#include "limit_surface/ring_values.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/parallel.h"

namespace prep::detail {
namespace {

// Sines of angles below this are rounding: derivatives carry errors of some 1e-13.
constexpr double parallel_below = 1e-11;

// The largest distance of the first ring from the vertex.
double ring_size(const RingShape& shape, std::uint32_t width, const double* numbers) {
    double size = 0;
    for (std::uint32_t i = 0; i < shape.edges(); ++i)
        for (std::uint32_t d = 0; d < 3; ++d)
            size = std::max(size, std::abs(numbers[std::size_t(shape.one_step(i)) * width + d]));
    for (std::uint32_t j = 0; j < shape.sectors; ++j)
        for (std::uint32_t d = 0; d < 3; ++d)
            size = std::max(size, std::abs(numbers[std::size_t(shape.inner(j, 0)) * width + d]));
    return size;
}

// Where the vertex' own tangents give none: the mean of the limit normals at the sectors' inner
// points, as far in as rounding allows (1/65536 of the ring's size).
glm::dvec3 nearby_normal(const RingShape& shape, RingLevels levels, std::uint32_t width) {
    std::vector<double> value(width), da(width), db(width);
    const int y = shape.triangles ? 0 : 1;  // at (1, y) of each sector
    const double begin = ring_size(shape, width, levels.level(0));
    int deepest = 0;
    while (deepest < 40 && ring_size(shape, width, levels.level(deepest)) > begin * 0x1p-16)
        ++deepest;
    const double* numbers = levels.level(deepest);
    glm::dvec3 sum{0.0};
    for (std::uint32_t j = 0; j < shape.sectors; ++j) {
        ring_corner_limit(shape, width, numbers, j, 1, y, value.data(), da.data(), db.data());
        sum += normal_of(vector_at(da.data()), vector_at(db.data()));
    }
    return direction_of(sum, 1);
}

}  // namespace

glm::dvec3 direction_of(const glm::dvec3& vector, double size) {
    const double scale = std::max({std::abs(vector.x), std::abs(vector.y), std::abs(vector.z)});
    if (!(scale > 0) || !(scale > size * parallel_below)) return glm::dvec3(0.0);
    const glm::dvec3 scaled = vector / scale;
    return scaled / std::sqrt(glm::dot(scaled, scaled));
}

glm::dvec3 normal_of(const glm::dvec3& du, const glm::dvec3& dv) {
    // The common case: far from overflow, underflow and parallel.
    const glm::dvec3 plain = glm::cross(du, dv);
    const double square = glm::dot(plain, plain), product = glm::dot(du, du) * glm::dot(dv, dv);
    if (square > 1e-200 && product < 1e200 && square > 1e-16 * product)
        return plain / std::sqrt(square);
    const double u = std::max({std::abs(du.x), std::abs(du.y), std::abs(du.z)});
    const double v = std::max({std::abs(dv.x), std::abs(dv.y), std::abs(dv.z)});
    if (!(u > 0) || !(v > 0) || !std::isfinite(u) || !std::isfinite(v)) return glm::dvec3(0.0);
    return direction_of(glm::cross(du / u, dv / v), 1);
}

void RingLevels::reset(const RingShape& shape, std::uint32_t width) {
    shape_ = shape;
    width_ = width;
    size_ = std::size_t(shape.point_count()) * width;
    known_ = last_ = 0;
    if (numbers_.size() < size_) numbers_.resize(size_);
}

RingCentre RingLevels::start(const Ring& ring, const PatchTree& tree, const ControlSource& source) {
    reset(ring.shape, source.width);
    const std::size_t count = shape_.point_count();
    for (std::size_t p = 0; p < count; ++p)
        std::copy_n(source.of(tree.ring_points[ring.first_point + p]), width_,
                    numbers_.data() + p * width_);
    RingCentre centre;
    centre.numbers.resize(3 * std::size_t(width_));
    double* const value = centre.numbers.data();
    std::vector<double> scratch(shape_.closed && shape_.sharp_edge ? 2 * size_ : 0);
    centre.has_tangents = ring_limit(shape_, width_, numbers_.data(), value, value + width_,
                                     value + 2 * width_, scratch)
                              .has_tangents;
    for (std::size_t p = 0; p < count; ++p)
        for (std::uint32_t d = 0; d < width_; ++d) numbers_[p * width_ + d] -= value[d];
    return centre;
}

void RingLevels::start(const Ring& ring, std::uint32_t width, const double* numbers) {
    reset(ring.shape, width);
    std::copy_n(numbers, size_, numbers_.data());
}

void RingLevels::refine_to(int k) {
    for (; known_ < k; ++known_) refine_ring(shape_, width_, at(known_), at(known_ + 1));
}

const double* RingLevels::level(int k) {
    assert(can_give(k));
    const std::size_t needed =
        std::size_t(keeps_all_ ? k + 2 : 2) * size_;  // after() moves nothing
    if (numbers_.size() < needed) numbers_.resize(needed);
    refine_to(k);
    last_ = k;
    return at(k);
}

const double* RingLevels::after() {
    refine_to(last_ + 1);
    return at(last_ + 1);
}

RingValues::RingValues(const PatchTree& tree, const ControlSource& source, int levels, bool normals,
                       std::size_t most_numbers, int threads)
    : width_(source.width), with_normals_(normals) {
    const std::size_t per_level = tree.ring_points.size() * width_;
    levels_ = levels;
    while (levels_ > 1 && per_level * std::size_t(levels_ + 1) > most_numbers) --levels_;
    levels_ = std::max(levels_, 1);
    numbers_ = std::make_unique_for_overwrite<double[]>(per_level * std::size_t(levels_ + 1));
    centres_.resize(tree.rings.size() * 3 * width_);
    if (normals) normals_.resize(tree.rings.size());
    starts_.reserve(tree.rings.size());
    for (const Ring& ring : tree.rings)
        starts_.push_back(std::size_t(ring.first_point) * width_ * std::size_t(levels_ + 1));
    parallel_blocks(tree.rings.size(), 64, threads, [&](std::size_t begin, std::size_t end) {
        RingLevels rings;
        for (std::size_t r = begin; r < end; ++r) {
            const Ring& ring = tree.rings[r];
            const std::size_t size = std::size_t(ring.shape.point_count()) * width_;
            const RingCentre known = rings.start(ring, tree, source);
            double* out = numbers_.get() + starts_[r];
            const double* const first = out;
            std::copy_n(rings.level(0), size, out);
            for (int k = 0; k < levels_; ++k, out += size)
                refine_ring(ring.shape, width_, out, out + size);
            double* const centre = centres_.data() + r * 3 * width_;
            std::copy_n(known.numbers.data(), 3 * std::size_t(width_), centre);
            if (!normals) continue;
            RingNormal& normal = normals_[r];
            if (known.has_tangents)
                normal.normal =
                    normal_of(vector_at(centre + width_), vector_at(centre + 2 * width_));
            if (normal.normal == glm::dvec3(0.0)) {
                normal.nearby = true;
                RingLevels again;
                again.start(ring, width_, first);
                normal.normal = nearby_normal(ring.shape, std::move(again), width_);
            }
        }
    });
}

}  // namespace prep::detail
