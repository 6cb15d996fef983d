#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "base/step_count.h"
#include "tangents/groups.h"
#include "tangents/math.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
// Above it comparing all pairs would show: at 1024 it takes about a millisecond.
constexpr std::size_t most_compared = 1024;

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

}  // namespace

SubgroupEvaluator::SubgroupEvaluator(const CornerReader& read, const TangentTriangles& triangles,
                                     const ContributionStore& store, double angular_threshold,
                                     bool bounded_effort)
    : read_(read),
      triangles_(triangles),
      store_(store),
      threshold_(float(std::cos(angular_threshold))),
      bounded_effort_(bounded_effort) {}

void SubgroupEvaluator::evaluate(std::span<const Index> members, std::vector<GroupFrame>& frames,
                                 std::vector<Index>& results) {
    if (bounded_effort_ && members.size() > most_compared && !lean_one_way(members)) {
        split_by_arcs(members, frames, results);
        return;
    }
    members_.clear();
    members_.reserve(members.size());
    for (const Index m : members) {
        const Index triangle = m >> 2;
        const auto position = [&](Index member) {
            return read_.position(triangles_.corner(triangle, member & 3));
        };
        const TriangleFrame frame = triangle_frame(read_, triangles_, triangle);
        const glm::vec3 n = read_.normal(triangles_.corner(triangle, m & 3));
        Member member;
        member.s = mikk::projected(n, frame.s);
        member.t = mikk::projected(n, frame.t);
        member.angle = mikk::corner_angle(n, position(m), position(previous_corner(m)),
                                          position(next_corner(m)));
        member.s_length = frame.s_length;
        member.t_length = frame.t_length;
        member.triangle = triangle;
        member.flags = store_.flags(triangle);
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

// Lists are compared by hash, and on equal hashes by asking again: kept, those of a vertex with
// many triangles would take quadratic memory.
void SubgroupEvaluator::split_by_angle(std::vector<GroupFrame>& frames,
                                       std::vector<Index>& results) {
    const std::size_t n = members_.size();
    count_steps(n * n);
    struct Known {
        Index member, frame;
    };
    std::unordered_multimap<std::uint64_t, Known> lists;
    const auto same_list = [&](const Member& a, const Member& b) {
        return std::all_of(members_.begin(), members_.end(),
                           [&](const Member& m) { return stay(a, m) == stay(b, m); });
    };
    results.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        list_.clear();
        std::uint64_t hash = 0;
        for (std::size_t j = 0; j < n; ++j) {
            if (!stay(members_[i], members_[j])) continue;
            list_.push_back(Index(j));
            hash = (std::rotl(hash, 5) ^ j) * 0x9e3779b97f4a7c15u;
        }
        const auto [first, last] = lists.equal_range(hash);
        const auto known = std::find_if(first, last, [&](const auto& entry) {
            return same_list(members_[i], members_[entry.second.member]);
        });
        if (known != last) {
            results[i] = known->second.frame;
            continue;
        }
        frames.push_back(sum(list_));
        results[i] = Index(frames.size() - 1);
        lists.insert({hash, {Index(i), results[i]}});
    }
}

bool SubgroupEvaluator::lean_one_way(std::span<const Index> members) const {
    if (threshold_ > -0.9999f) return false;
    std::uint32_t shared = ~0u, all = s_directions | t_directions;
    for (const Index m : members) {
        shared &= store_.at(m >> 2, m & 3).code;
        if (!(shared & s_directions) || !(shared & t_directions)) break;
    }
    if ((shared & s_directions) && (shared & t_directions)) return true;
    // Looked at more closely: at a cone's point the normals are far from the triangles'. Some from
    // all around first: they mostly tell.
    const std::size_t stride = members.size() / 64 + 1;
    for (const std::size_t step : {stride, std::size_t(1)}) {
        for (std::size_t i = 0; i < members.size(); i += step) {
            const Index m = members[i], t = m >> 2;
            if (store_.flags(t) & group_with_anything) continue;
            const TriangleFrame frame = triangle_frame(read_, triangles_, t);
            all &= direction_code(read_.normal(triangles_.corner(t, m & 3)), frame.s, frame.t);
            if (!(all & s_directions) || !(all & t_directions)) return false;
        }
    }
    return true;
}

// All members have one normal, so their S lie in a plane: those within the threshold of one are an
// arc, and its sum a difference of running sums.
void SubgroupEvaluator::split_by_arcs(std::span<const Index> members,
                                      std::vector<GroupFrame>& frames,
                                      std::vector<Index>& results) {
    const auto contribution = [&](Index m) {
        const Contribution& t = store_.at(m >> 2, m & 3);
        return glm::dvec3(t.x, t.y, t.z);
    };
    struct Ray {
        double angle;
        Index member;
    };
    constexpr double turn = 2 * std::numbers::pi;
    const glm::dvec3 normal =
        unit_or_zero(read_.normal(triangles_.corner(members[0] >> 2, members[0] & 3)));
    std::vector<Ray> rays;
    rays.reserve(members.size());
    glm::dvec3 x(0.0), y(0.0);
    double weights = 0;
    for (Index i = 0; i < members.size(); ++i) {
        // Most of a pole's are zero: the cosines of such narrow angles round to 1.
        const glm::dvec3 t = contribution(members[i]);
        if (t == glm::dvec3(0.0)) continue;
        const double length = glm::length(t);
        if (!(length > 0) || !std::isfinite(length)) continue;
        if (rays.empty()) {
            x = t / length;
            y = glm::cross(normal, x);
        }
        const double angle = std::atan2(glm::dot(t, y), glm::dot(t, x));
        rays.push_back({angle < 0 ? angle + turn : angle, i});
        weights += length;
    }
    const auto before = [](const Ray& a, const Ray& b) {
        return a.angle != b.angle ? a.angle < b.angle : a.member < b.member;
    };
    if (!std::is_sorted(rays.begin(), rays.end(), before))
        std::sort(rays.begin(), rays.end(), before);
    const std::size_t m = rays.size();
    glm::dvec3 sum_of_all(0.0);
    for (const Ray& ray : rays) sum_of_all += contribution(members[ray.member]);
    const auto add_frame = [&](const glm::dvec3& total, const glm::dvec3& own) {
        // What rounding leaves of sums that cancel is no direction.
        const bool cancels = glm::length(total) <= 1e-9 * weights;
        frames.push_back({glm::vec3(unit_or_zero(cancels ? own : total)), glm::vec3(0.0f), 0, 0});
        return Index(frames.size() - 1);
    };
    const Index whole = add_frame(sum_of_all, m > 0 ? contribution(members[rays[0].member]) : x);
    results.assign(members.size(), whole);
    frames.reserve(with_slack(frames.size() + m));
    // A cosine of −1 in float is up to 3.5e-4 from half a turn.
    const double reach = std::min(std::acos(double(threshold_)), std::numbers::pi - 3.5e-4);
    // The arc about each ray, seen from one turn further on: rays[begin … end) of three turns.
    const auto angle_of = [&](std::size_t i) { return rays[i % m].angle + double(i / m) * turn; };
    // An end of the arc, and the sum of what is before it in its turn.
    struct End {
        std::size_t at = 0;
        glm::dvec3 sum{0.0};
    };
    const auto advance = [&](End& end) {
        end.sum += contribution(members[rays[end.at % m].member]);
        if (++end.at % m == 0) end.sum = glm::dvec3(0.0);
    };
    const auto sum_below = [&](const End& end) {
        return double(end.at / m) * sum_of_all + end.sum;
    };
    End begin, end;
    std::size_t last_begin = 0, last_end = 0;
    for (std::size_t i = 0; i < m; ++i) {
        const double centre = rays[i].angle + turn;
        while (angle_of(begin.at) <= centre - reach) advance(begin);
        while (end.at < 3 * m && angle_of(end.at) < centre + reach) advance(end);
        if (end.at - begin.at >= m) continue;
        Index& result = results[rays[i].member];
        if (i > 0 && begin.at == last_begin && end.at == last_end) {
            result = results[rays[i - 1].member];
            continue;
        }
        result =
            add_frame(sum_below(end) - sum_below(begin), contribution(members[rays[i].member]));
        last_begin = begin.at;
        last_end = end.at;
    }
    count_steps(members.size() + begin.at + end.at);
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
