// The tangents of one group: step 7 of the definition, with the subgroups that the angular
// threshold parts.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "tangents/stars.h"

namespace prep::detail {

struct GroupFrame {  // all that two results are compared by when the halves of a quad are averaged
    glm::vec3 s, t;
    float s_length, t_length;
};

// Does the threshold part opposite directions alone?
inline bool opposites_only(double angular_threshold) {
    return std::cos(angular_threshold) <= -0.9999;
}

// To reserve where little will follow: what is full doubles.
inline std::size_t with_slack(std::size_t count) {
    return count + count / 16;
}

class SubgroupEvaluator {
  public:
    SubgroupEvaluator(const CornerReader& read, const TangentTriangles& triangles,
                      const Terms& terms, double angular_threshold, bool bounded_effort);

    // members: triangle corners of one group, ascending. Appends a frame for each subgroup whose
    // list of members is a new one; results[i] is the frame of members[i].
    void evaluate(std::span<const std::uint32_t> members, std::vector<GroupFrame>& frames,
                  std::vector<std::uint32_t>& results);

  private:
    struct Member {
        glm::vec3 s, t;  // projected, unit or zero
        float angle, s_length, t_length;
        std::uint32_t triangle, flags;
    };
    bool stay(const Member& a, const Member& b) const;
    bool all_together() const;
    GroupFrame sum(std::span<const std::uint32_t> list) const;
    // The definition's way, O(k²). bounded_effort: above 1024 members by arcs, O(k log k), in
    // double and by S alone.
    void split_by_angle(std::vector<GroupFrame>& frames, std::vector<std::uint32_t>& results);
    void split_by_arcs(std::span<const std::uint32_t> members, std::vector<GroupFrame>& frames,
                       std::vector<std::uint32_t>& results);
    bool lean_one_way(std::span<const std::uint32_t> members) const;

    CornerReader read_;
    const TangentTriangles& triangles_;
    const Terms& terms_;
    float threshold_;
    bool bounded_effort_;
    std::vector<Member> members_;
    std::vector<std::uint32_t> list_;
};

}  // namespace prep::detail
