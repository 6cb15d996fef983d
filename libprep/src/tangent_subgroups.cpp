#include "tangent_subgroups.h"

#include <algorithm>
#include <cmath>

#include "tangent_math.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

}  // namespace

SubgroupEvaluator::SubgroupEvaluator(const CornerReader& read, const TangentTriangles& triangles,
                                     const Terms& terms, double angular_threshold,
                                     bool bounded_effort)
    : read_(read),
      triangles_(triangles),
      terms_(terms),
      threshold_(float(std::cos(angular_threshold))),
      bounded_effort_(bounded_effort) {}

void SubgroupEvaluator::evaluate(std::span<const Index> members, std::vector<GroupFrame>& frames,
                                 std::vector<Index>& results) {
    members_.clear();
    for (const Index m : members) {
        const Index triangle = m >> 2;
        glm::vec3 p[3];
        glm::vec2 uv[3];
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = read_.position(triangles_.corner(triangle, k));
            uv[k] = read_.uv(triangles_.corner(triangle, k));
        }
        const TriangleFrame frame = triangle_frame(p, uv);
        const glm::vec3 n = read_.normal(triangles_.corner(triangle, m & 3));
        Member member;
        member.s = mikk::projected(n, frame.s);
        member.t = mikk::projected(n, frame.t);
        member.angle =
            mikk::corner_angle(n, p[m & 3], p[previous_corner(m) & 3], p[next_corner(m) & 3]);
        member.s_length = frame.s_length;
        member.t_length = frame.t_length;
        member.triangle = triangle;
        member.flags = terms_.flags(triangle);
        members_.push_back(member);
    }
    if (all_together()) {
        list_.resize(members.size());
        for (Index i = 0; i < list_.size(); ++i) list_[i] = i;
        frames.push_back(sum(list_));
        results.assign(members.size(), Index(frames.size() - 1));
        return;
    }
    split_by_angle(frames, results);
}

bool SubgroupEvaluator::stay(const Member& a, const Member& b) const {
    if ((a.flags | b.flags) & group_with_anything) return true;
    const bool one_quad = (a.triangle + 1 == b.triangle && (a.flags & quad_first)) ||
                          (b.triangle + 1 == a.triangle && (b.flags & quad_first)) ||
                          a.triangle == b.triangle;
    if (one_quad) return true;
    return mikk::dot(a.s, b.s) > threshold_ && mikk::dot(a.t, b.t) > threshold_;
}

// Quick sufficient test: all within 89.4° of the first (dot > 0.01) are within 178.8° of each
// other, far from the antipodal pairs that a threshold of −1 parts.
bool SubgroupEvaluator::all_together() const {
    if (members_.size() == 1) return true;
    if (threshold_ > -0.9999f) return false;
    const auto near = [&](const Member& m) {
        return mikk::dot(members_[0].s, m.s) > 0.01f && mikk::dot(members_[0].t, m.t) > 0.01f;
    };
    return std::all_of(members_.begin(), members_.end(), near);
}

void SubgroupEvaluator::split_by_angle(std::vector<GroupFrame>& frames,
                                       std::vector<Index>& results) {
    const std::size_t n = members_.size();
    std::vector<std::vector<Index>> lists;
    std::vector<Index> list_frames;
    results.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        list_.clear();
        for (std::size_t j = 0; j < n; ++j)
            if (stay(members_[i], members_[j])) list_.push_back(Index(j));
        const auto known = std::find(lists.begin(), lists.end(), list_);
        if (known != lists.end()) {
            results[i] = list_frames[std::size_t(known - lists.begin())];
            continue;
        }
        frames.push_back(sum(list_));
        lists.push_back(list_);
        list_frames.push_back(Index(frames.size() - 1));
        results[i] = list_frames.back();
    }
}

GroupFrame SubgroupEvaluator::sum(std::span<const Index> list) const {
    GroupFrame total{glm::vec3(0.0f), glm::vec3(0.0f), 0, 0};
    float angles = 0;
    for (const Index i : list) {
        const Member& m = members_[i];
        if (m.flags & group_with_anything) continue;
        total.s += mikk::scaled(m.angle, m.s);
        total.t += mikk::scaled(m.angle, m.t);
        total.s_length += m.angle * m.s_length;
        total.t_length += m.angle * m.t_length;
        angles += m.angle;
    }
    total.s = mikk::normalized_or_zero(total.s);
    total.t = mikk::normalized_or_zero(total.t);
    if (angles > 0) {
        total.s_length /= angles;
        total.t_length /= angles;
    }
    return total;
}

}  // namespace prep::detail
