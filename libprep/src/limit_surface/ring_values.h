// The values of all rings of a surface, refined a few levels once, so that sectors share them; and
// the limit at each ring's vertex.
//
// Numbers of a ring are relative to the limit at its vertex: small ones stay exact however deep.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "limit_surface/patch_tree.h"

namespace prep::detail {

// Where the values of control points are: row slots[v], or v where there are no slots.
struct ControlSource {
    const double* numbers = nullptr;
    std::uint32_t width = 0;
    const std::uint32_t* slots = nullptr;
    const double* of(std::uint32_t vertex) const {
        return numbers + std::size_t(slots ? slots[vertex] : vertex) * width;
    }
};

// The first three of a row: a position, or a step.
inline glm::dvec3 vector_at(const double* numbers) {
    return {numbers[0], numbers[1], numbers[2]};
}

struct RingCentre {
    std::vector<double> numbers;  // value, t0, t1: width each
    bool has_tangents = false;
};

// One ring, level by level. Two levels are held, and the level asked for never goes back; or all
// that were asked for.
class RingLevels {
  public:
    explicit RingLevels(bool keeps_all = false) : keeps_all_(keeps_all) {}
    // Gathers level 0.
    RingCentre start(const Ring& ring, const PatchTree& tree, const ControlSource& source);
    // From numbers of some level of the ring.
    void start(const Ring& ring, std::uint32_t width, const double* numbers);
    // Level k from where it started; in place until another one is asked for.
    const double* level(int k);
    const double* after();  // the next level of the one asked for last
    bool can_give(int k) const { return keeps_all_ || k >= last_; }
    std::size_t held_numbers() const { return numbers_.size(); }

  private:
    void reset(const RingShape& shape, std::uint32_t width);
    double* at(int k) { return numbers_.data() + std::size_t(keeps_all_ ? k : k % 2) * size_; }
    void refine_to(int k);
    bool keeps_all_;
    RingShape shape_;
    std::uint32_t width_ = 0;
    std::size_t size_ = 0;      // of a level
    int known_ = 0, last_ = 0;  // the deepest level that is there, the one asked for last
    std::vector<double> numbers_;
};

// A normal and how it came about.
struct RingNormal {
    glm::dvec3 normal{0.0};  // zero: none
    bool nearby = false;
};

class RingValues {
  public:
    RingValues() = default;
    // `levels` levels beyond the first, fewer where that would be more memory than `most_numbers`.
    RingValues(const PatchTree& tree, const ControlSource& source, int levels, bool normals,
               std::size_t most_numbers, int threads);

    std::uint32_t width() const { return width_; }
    int stored_levels() const { return levels_; }
    bool has_normals() const { return with_normals_; }
    const double* level(const PatchTree& tree, std::uint32_t ring, int k) const {
        return numbers_.get() + starts_[ring] +
               std::size_t(k) * tree.rings[ring].shape.point_count() * width_;
    }
    // value, t0, t1: width() numbers each.
    const double* centre(std::uint32_t ring) const {
        return centres_.data() + std::size_t(ring) * 3 * width_;
    }
    const RingNormal& normal(std::uint32_t ring) const { return normals_[ring]; }

  private:
    std::uint32_t width_ = 0;
    int levels_ = 0;
    bool with_normals_ = false;
    std::unique_ptr<double[]> numbers_;  // written as they come, never cleared
    std::vector<double> centres_;
    std::vector<std::size_t> starts_;
    std::vector<RingNormal> normals_;
};

// The unit vector, or zero where its length is nothing beside `size` (a product of lengths).
glm::dvec3 direction_of(const glm::dvec3& vector, double size);
// The normal that two derivatives give, or zero where they vanish or are parallel.
glm::dvec3 normal_of(const glm::dvec3& du, const glm::dvec3& dv);

}  // namespace prep::detail
