// MikkTSpace's groups and their tangents: steps 5 to 8, vertex by vertex.
//
// Every welded vertex is independent of the others, but for triangles that group with anything:
// those take the orientation of the group that reaches them first, in triangle order over the whole
// mesh. Vertices that such triangles touch are grouped in that order beforehand; all others in
// parallel.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "tangents/one_rings.h"

namespace prep::detail {

struct GroupTangents {
    // Tangent and w: the first of each position that has corners, by position, then all others.
    std::vector<glm::vec4> values;
    // Triangle corners (as in OneRings::members) whose value may not be a frame, and those that no
    // group reached; ascending by vertex. Only where `review` is set.
    std::vector<std::uint32_t> suspects;
};

struct GroupOptions {
    double angular_threshold = 0;
    float positive = 1;           // w where the definition's sign is +1
    bool review = false;          // look for values that are not frames
    bool bounded_effort = false;  // large rings in O(k log k), not with the definition's bits
    int threads = 0;
};

// Where positions' first values are.
struct FirstValues {
    std::size_t count = 0;
    bool all_listed = false;                // listed position i's is i; else position v's is
    std::span<const std::uint32_t> places;  // places[v], or v where there are none
};

struct GroupInput {
    const CornerReader& read;
    const TangentTriangles& triangles;
    ContributionStore& store;
    OneRings& rings;
    const EdgeOverrides& overrides;
    GroupOptions options;
    FirstValues firsts;
    // Three per triangle, into the values; those of listed positions, and of degenerate triangles,
    // are no_index, and stay that where no group reached the corner.
    std::span<std::uint32_t> corner_values;
};

// Groups of the positions that `rings` lists. Its lists and the contributions, but not the
// triangles' flags, are given back before the values are put together. values: becomes
// GroupTangents::values; the first values of positions that are not listed are there.
GroupTangents group_tangents(const GroupInput& input, std::vector<glm::vec4> values);

// The tangents of one group: step 7 of the definition, with the subgroups that the angular
// threshold parts (subgroups.cpp).
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
                      const ContributionStore& store, double angular_threshold,
                      bool bounded_effort);

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
    const ContributionStore& store_;
    float threshold_;
    bool bounded_effort_;
    std::vector<Member> members_;
    std::vector<std::uint32_t> list_;
};

}  // namespace prep::detail
