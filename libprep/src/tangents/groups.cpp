#include "tangents/groups.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "tangents/math.h"
#include "tangents/small_stars.h"
#include "tangents/subgroups.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
using Star = std::span<const Index>;
// Listed positions per block of work, about 0.1 ms.
constexpr std::size_t position_grain = 512;
// Lists of larger stars are given back before others are made.
constexpr std::size_t most_kept = 4096;

// Stars that triangles which group with anything touch, grouped in the mesh's triangle order.
class EntangledStars {
  public:
    EntangledStars(const TangentTriangles& triangles, const Terms& terms, const TangentStars& stars,
                   const EdgeOverrides& overrides, int threads)
        : terms_(terms), stars_(stars) {
        if (terms.counts.anything == 0) return;
        collect(threads);
        find_neighbours(overrides, threads);
        flood_all(triangles.count);
    }

    bool empty() const { return firsts_.empty(); }
    // The first star that begins at or behind a place in TangentStars::members.
    std::size_t at(Index place) const {
        return std::size_t(std::lower_bound(firsts_.begin(), firsts_.end(), place) -
                           firsts_.begin());
    }
    bool is(std::size_t star, Star members) const {
        return star < firsts_.size() && stars_.members.data() + firsts_[star] == members.data();
    }
    // The group of each member of the star, or no_index; numbered in the order in which they began.
    std::span<const Index> groups(std::size_t star) const {
        return {groups_.data() + starts_[star], starts_[star + 1] - starts_[star]};
    }

  private:
    void collect(int threads) {
        const std::size_t blocks = (stars_.count + position_grain - 1) / position_grain;
        std::vector<std::vector<Star>> found(blocks);
        parallel_blocks(stars_.count, position_grain, threads,
                        [&](std::size_t begin, std::size_t end) {
                            auto& list = found[begin / position_grain];
                            stars_.for_each(begin, end, [&](Star star) {
                                const auto anything = [&](Index m) {
                                    return (terms_.flags(m >> 2) & group_with_anything) != 0;
                                };
                                if (std::any_of(star.begin(), star.end(), anything))
                                    list.push_back(star);
                            });
                        });
        starts_.push_back(0);
        for (const auto& list : found) {
            for (const Star star : list) {
                firsts_.push_back(Index(star.data() - stars_.members.data()));
                starts_.push_back(starts_.back() + star.size());
            }
        }
    }

    Star members(std::size_t star) const {
        return {stars_.members.data() + firsts_[star], starts_[star + 1] - starts_[star]};
    }

    void find_neighbours(const EdgeOverrides& overrides, int threads) {
        leaving_.resize(starts_.back());
        entering_.resize(starts_.back());
        parallel_blocks(firsts_.size(), 1024, threads, [&](std::size_t begin, std::size_t end) {
            Neighbours neighbours;
            for (std::size_t s = begin; s < end; ++s) {
                const Star star = members(s);
                neighbours.find(stars_, star, overrides);
                for (std::size_t i = 0; i < star.size(); ++i) {
                    leaving_[starts_[s] + i] = neighbours.leaving(i);
                    entering_[starts_[s] + i] = neighbours.entering(i);
                }
            }
        });
    }

    void flood_all(std::size_t triangles) {
        struct Start {
            Index member, star, place;
        };
        std::vector<Start> starts;
        for (std::size_t s = 0; s < firsts_.size(); ++s) {
            const Star star = members(s);
            for (std::size_t i = 0; i < star.size(); ++i)
                if (!(terms_.flags(star[i] >> 2) & group_with_anything))
                    starts.push_back({star[i], Index(s), Index(i)});
        }
        std::sort(starts.begin(), starts.end(),
                  [](const Start& a, const Start& b) { return a.member < b.member; });
        orientation_.resize(triangles);
        for (std::size_t t = 0; t < triangles; ++t)
            orientation_[t] = (terms_.flags(t) & orientation_preserving) ? 1 : 0;
        claimed_.assign(triangles, 0);
        groups_.assign(starts_.back(), no_index);
        std::vector<Index> group_count(firsts_.size(), 0);
        for (const Start& start : starts)
            if (groups_[starts_[start.star] + start.place] == no_index)
                flood(start.star, start.place, group_count[start.star]++);
    }

    void flood(std::size_t star_index, Index first, Index group) {
        const Star star = members(star_index);
        const std::size_t base = starts_[star_index];
        const std::uint8_t wanted = orientation_[star[first] >> 2];
        groups_[base + first] = group;
        claimed_[star[first] >> 2] = 1;
        stack_.clear();
        // Depth first, over the leaving edge before the entering one.
        const auto push = [&](Index i) {
            if (entering_[base + i] != no_index) stack_.push_back(entering_[base + i]);
            if (leaving_[base + i] != no_index) stack_.push_back(leaving_[base + i]);
        };
        push(first);
        while (!stack_.empty()) {
            const Index i = stack_.back();
            stack_.pop_back();
            if (groups_[base + i] != no_index) continue;
            const Index t = star[i] >> 2;
            if ((terms_.flags(t) & group_with_anything) && !claimed_[t]) orientation_[t] = wanted;
            if (orientation_[t] != wanted) continue;
            groups_[base + i] = group;
            claimed_[t] = 1;
            push(i);
        }
    }

    const Terms& terms_;
    const TangentStars& stars_;
    std::vector<Index> firsts_;        // per entangled star: its place in TangentStars::members
    std::vector<std::size_t> starts_;  // and where its entries start in the following
    std::vector<Index> leaving_, entering_, groups_;
    std::vector<std::uint8_t> orientation_, claimed_;
    std::vector<Index> stack_;
};

// Groups and evaluates star after star of one block.
class StarWorker {
  public:
    StarWorker(const CornerReader& read, const TangentTriangles& triangles, const Terms& terms,
               const TangentStars& stars, const EdgeOverrides& overrides,
               const EntangledStars& entangled, const GroupOptions& options,
               const FirstValues& firsts, std::span<Index> corner_values)
        : read_(read),
          triangles_(triangles),
          terms_(terms),
          stars_(stars),
          overrides_(overrides),
          entangled_(entangled),
          options_(options),
          firsts_(firsts),
          corner_values_(corner_values),
          subgroups_(read, triangles, terms, options.angular_threshold, options.bounded_effort),
          sums_tell_(opposites_only(options.angular_threshold) && !triangles.any_quad) {}

    struct Block {
        std::vector<glm::vec4> further;      // values behind the first of a position
        std::vector<Index> further_corners;  // corners with those: indices into `further` so far
        std::vector<Index> unused;           // first values that no corner has
        std::vector<Index> suspects;
    };

    // values: where first values go.
    void run(std::size_t begin, std::size_t end, std::span<glm::vec4> values, Block& block) {
        block_ = &block;
        values_ = values;
        std::size_t next_entangled = entangled_.empty() ? 0 : entangled_.at(stars_.offsets[begin]);
        for (std::size_t i = begin; i < end; ++i) {
            const Index v = stars_.listed[i];
            first_free_ = true;
            first_value_ = firsts_.all_listed ? i : firsts_.places.empty() ? v : firsts_.places[v];
            stars_.for_each(i, i + 1, [&](Star star) {
                if (!entangled_.empty() && entangled_.is(next_entangled, star)) {
                    const std::span<const Index> groups = entangled_.groups(next_entangled++);
                    groups_.assign(groups.begin(), groups.end());
                } else {
                    if (sums_tell_ && take_small(star)) return;
                    find_groups(star);
                }
                evaluate_groups(star);
            });
            if (first_free_) block.unused.push_back(Index(first_value_));
        }
        // They stay until all blocks are done.
        block.further.shrink_to_fit();
        block.further_corners.shrink_to_fit();
    }

  private:
    // The usual listed star; false: not this one.
    bool take_small(Star star) {
        if (star.size() > most_small || overrides_.touch(stars_, star)) return false;
        if (!find_small_groups(stars_, terms_, star, small_)) return false;
        for (std::size_t g = 0; g < small_.count; ++g) {
            const SmallGroups::Group& group = small_.groups[g];
            const float sign = group.preserving ? 1.0f : -1.0f;
            const glm::vec4 value(group.tangent, sign * options_.positive);
            const bool first = std::exchange(first_free_, false);
            const Index place = first ? Index(first_value_) : Index(block_->further.size());
            if (first)
                values_[first_value_] = value;
            else
                block_->further.push_back(value);
            const bool no_frame =
                options_.review &&
                !has_frame(star[std::size_t(std::countr_zero(group.members))], value);
            for (std::uint32_t rest = group.members; rest != 0; rest &= rest - 1) {
                const Index m = star[std::size_t(std::countr_zero(rest))];
                corner_values_[m - (m >> 2)] = place;
                if (!first) block_->further_corners.push_back(m - (m >> 2));
                if (no_frame) block_->suspects.push_back(m);
            }
        }
        return true;
    }

    // Step 6 where no triangle groups with anything.
    void find_groups(Star star) {
        neighbours_.find(stars_, star, overrides_);
        groups_.assign(star.size(), no_index);
        // Neighbours are each other's but for the reference's quirk.
        const bool chains = !overrides_.touch(stars_, star);
        Index count = 0;
        for (std::size_t i = 0; i < star.size(); ++i) {
            if (groups_[i] != no_index) continue;
            groups_[i] = count;
            if (chains) {
                const std::uint32_t wanted = terms_.flags(star[i] >> 2) & orientation_preserving;
                const auto joins = [&](Index m) {
                    return m != no_index && groups_[m] == no_index &&
                           (terms_.flags(star[m] >> 2) & orientation_preserving) == wanted;
                };
                for (Index m = neighbours_.leaving(i); joins(m); m = neighbours_.leaving(m))
                    groups_[m] = count;
                for (Index m = neighbours_.entering(i); joins(m); m = neighbours_.entering(m))
                    groups_[m] = count;
                ++count;
                continue;
            }
            stack_.assign(1, Index(i));
            while (!stack_.empty()) {
                const Index m = stack_.back();
                stack_.pop_back();
                for (const Index other : {neighbours_.leaving(m), neighbours_.entering(m)}) {
                    if (other == no_index || groups_[other] != no_index) continue;
                    if ((terms_.flags(star[other] >> 2) ^ terms_.flags(star[i] >> 2)) &
                        orientation_preserving)
                        continue;
                    groups_[other] = count;
                    stack_.push_back(other);
                }
            }
            ++count;
        }
        // A pole's lists would be beside those of its frames.
        if (star.size() > most_kept) {
            neighbours_ = {};
            release(stack_);
        }
    }

    // Every group of groups_, then the averages of quads.
    void evaluate_groups(Star star) {
        frames_.clear();
        star_values_.clear();
        const auto first = [](Index group) { return group == 0; };
        if (std::all_of(groups_.begin(), groups_.end(), first)) {
            evaluate_group(star, members_values_);
        } else {
            evaluate_each_group(star);
        }
        if (triangles_.any_quad && frames_.size() > 1) average_quads(star);
        if (star.size() <= most_kept) {
            keep_values(star);
            return;
        }
        release(frames_);
        for (std::vector<Index>* list : {&groups_, &order_, &members_, &results_}) release(*list);
        keep_values(star);
        release(star_values_);
        for (std::vector<Index>* list : {&members_values_, &places_}) release(*list);
        release(frame_states_);
    }

    void evaluate_each_group(Star star) {
        order_.resize(star.size());
        std::size_t grouped = 0;
        for (Index i = 0; i < star.size(); ++i) {
            order_[grouped] = i;
            grouped += groups_[i] != no_index;
            if (groups_[i] == no_index && options_.review) block_->suspects.push_back(star[i]);
        }
        order_.resize(grouped);
        const auto earlier = [&](Index a, Index b) { return groups_[a] < groups_[b]; };
        if (!std::is_sorted(order_.begin(), order_.end(), earlier))
            std::stable_sort(order_.begin(), order_.end(), earlier);
        members_values_.assign(star.size(), no_index);
        for (std::size_t i = 0; i < order_.size();) {
            const Index group = groups_[order_[i]];
            const std::size_t first = i;
            while (i < order_.size() && groups_[order_[i]] == group) ++i;
            const std::span<const Index> places(order_.data() + first, i - first);
            Star members = star.subspan(places[0], places.size());
            if (places.back() - places[0] + 1 != places.size()) {
                members_.resize(places.size());
                for (std::size_t k = 0; k < places.size(); ++k) members_[k] = star[places[k]];
                members = members_;
            }
            evaluate_group(members, results_);
            for (std::size_t k = 0; k < places.size(); ++k)
                members_values_[places[k]] = results_[k];
        }
    }

    // Adds the frames of one group; results: which one each member has.
    void evaluate_group(Star members, std::vector<Index>& results) {
        float sign = -1.0f;
        for (const Index m : members) {
            // Triangles that group with anything have the orientation of those that do not.
            const std::uint32_t flags = terms_.flags(m >> 2);
            if (flags & group_with_anything) continue;
            if (flags & orientation_preserving) sign = 1.0f;
            break;
        }
        const std::size_t known = frames_.size();
        if (const auto sum = sum_of_terms(members)) {
            frames_.push_back({*sum, glm::vec3(0.0f), 0, 0});
            results.assign(members.size(), Index(known));
        } else {
            subgroups_.evaluate(members, frames_, results);
        }
        if (members.size() > most_kept) star_values_.reserve(with_slack(frames_.size()));
        for (std::size_t f = known; f < frames_.size(); ++f)
            star_values_.push_back({frames_[f].s, sign * options_.positive});
    }

    // The star's first value goes to its position's place, the others behind those of all.
    void keep_values(Star star) {
        if (star.size() > most_kept) {
            block_->further.reserve(with_slack(block_->further.size() + star_values_.size()));
            block_->further_corners.reserve(block_->further_corners.size() + star.size());
        }
        places_.assign(star_values_.size(), no_index);
        frame_states_.assign(star_values_.size(), FrameState::unknown);
        bool first_taken = !first_free_;
        Index first = no_index;  // the value that has the position's place
        Index last = no_index;   // the last member's, where it is a frame
        Index last_place = 0;
        for (std::size_t i = 0; i < star.size(); ++i) {
            const Index value = members_values_[i];
            if (value == no_index) continue;
            const Index m = star[i];
            Index& corner_value = corner_values_[m - (m >> 2)];
            if (value == last) {
                corner_value = last_place;
                if (value != first) block_->further_corners.push_back(m - (m >> 2));
                continue;
            }
            last = no_index;
            if (!first_taken) {
                first_taken = true;
                first_free_ = false;
                first = value;
                values_[first_value_] = star_values_[value];
            }
            if (value == first) {
                corner_value = Index(first_value_);
            } else {
                if (places_[value] == no_index) {
                    places_[value] = Index(block_->further.size());
                    block_->further.push_back(star_values_[value]);
                }
                corner_value = places_[value];
                block_->further_corners.push_back(m - (m >> 2));
            }
            // All members have one normal.
            last_place = corner_value;
            if (!options_.review) {
                last = value;
                continue;
            }
            FrameState& state = frame_states_[value];
            if (state == FrameState::unknown)
                state = has_frame(m, star_values_[value]) ? FrameState::good : FrameState::bad;
            if (state == FrameState::bad)
                block_->suspects.push_back(m);
            else
                last = value;
        }
    }

    // The sum of a group whose S and T share a half-space. Frames of quads' halves are compared in
    // more than their S: those are evaluated in full.
    std::optional<glm::vec3> sum_of_terms(Star members) const {
        if (!sums_tell_) return std::nullopt;
        glm::vec3 sum(0.0f);
        std::uint32_t all = ~0u;
        const auto told = [](std::uint32_t code) {
            return (code & s_directions) && (code & t_directions);
        };
        for (const Index m : members) {
            const CornerTerm& term = terms_.at(m >> 2, m & 3);
            sum.x += term.x;
            sum.y += term.y;
            sum.z += term.z;
            all &= term.code;
            if (members.size() > most_kept && !told(all)) return std::nullopt;
        }
        if (members.size() > 1 && !told(all)) return std::nullopt;
        return mikk::normalized_or_zero(sum);
    }

    // Step 8: a quad's corner that both halves meet.
    void average_quads(Star star) {
        for (std::size_t i = 0; i + 1 < star.size(); ++i) {
            const Index a = star[i], b = star[i + 1];
            if (!(terms_.flags(a >> 2) & quad_first) || (b >> 2) != (a >> 2) + 1) continue;
            if (triangles_.corner(a >> 2, a & 3) != triangles_.corner(b >> 2, b & 3)) continue;
            const Index x = members_values_[i], y = members_values_[i + 1];
            if (x == no_index || y == no_index || x == y) continue;
            Index value = std::max(x, y);
            if (std::memcmp(&frames_[x], &frames_[y], sizeof(GroupFrame)) != 0) {
                const glm::vec3 sum = glm::vec3(star_values_[x]) + glm::vec3(star_values_[y]);
                // A half that groups with anything can have another orientation: the group that
                // came later has the last word.
                const float w = star_values_[value].w;
                value = Index(star_values_.size());
                star_values_.push_back({mikk::normalized_or_zero(sum), w});
            }
            members_values_[i] = members_values_[i + 1] = value;
        }
    }

    bool has_frame(Index member, const glm::vec4& value) const {
        return is_frame(read_.normal(triangles_.corner(member >> 2, member & 3)), glm::vec3(value));
    }

    const CornerReader& read_;
    const TangentTriangles& triangles_;
    const Terms& terms_;
    const TangentStars& stars_;
    const EdgeOverrides& overrides_;
    const EntangledStars& entangled_;
    const GroupOptions& options_;
    const FirstValues& firsts_;
    std::span<Index> corner_values_;
    SubgroupEvaluator subgroups_;
    bool sums_tell_;  // are frames of sums alone those of groups whose S and T share a half-space?
    SmallGroups small_;
    Block* block_ = nullptr;
    std::span<glm::vec4> values_;
    bool first_free_ = false;      // no corner at the position has its place yet
    std::size_t first_value_ = 0;  // the place
    Neighbours neighbours_;
    std::vector<Index> groups_, stack_, order_, members_, results_, members_values_, places_;
    std::vector<GroupFrame> frames_;
    std::vector<glm::vec4> star_values_;
    enum class FrameState : std::uint32_t { unknown, good, bad };
    std::vector<FrameState> frame_states_;
};

// Closes the gaps that first values leave which no corner has.
void remove_unused(const std::vector<StarWorker::Block>& blocks, std::vector<glm::vec4>& values,
                   std::span<Index> corner_values) {
    std::vector<Index> unused;
    for (const StarWorker::Block& block : blocks)
        unused.insert(unused.end(), block.unused.begin(), block.unused.end());
    std::vector<Index> places(values.size());
    Index kept = 0;
    auto next = unused.begin();
    for (Index i = 0; i < values.size(); ++i) {
        places[i] = kept;
        if (next != unused.end() && *next == i) {
            ++next;
        } else {
            values[kept++] = values[i];
        }
    }
    values.resize(kept);
    for (Index& value : corner_values)
        if (value != no_index) value = places[value];
}

}  // namespace

GroupTangents group_tangents(const CornerReader& read, const TangentTriangles& triangles,
                             Terms& terms, TangentStars& stars, const EdgeOverrides& overrides,
                             const GroupOptions& options, const FirstValues& firsts,
                             std::vector<glm::vec4> values, std::span<Index> corner_values) {
    std::optional<EntangledStars> entangled;
    entangled.emplace(triangles, terms, stars, overrides, options.threads);
    const std::size_t blocks = (stars.count + position_grain - 1) / position_grain;
    std::vector<StarWorker::Block> results(blocks);
    GroupTangents result;
    result.values = std::move(values);
    result.values.resize(firsts.count);
    parallel_blocks(stars.count, position_grain, options.threads,
                    [&](std::size_t begin, std::size_t end) {
                        StarWorker worker(read, triangles, terms, stars, overrides, *entangled,
                                          options, firsts, corner_values);
                        worker.run(begin, end, result.values, results[begin / position_grain]);
                    });
    entangled.reset();
    stars = {};
    for (auto& plane : terms.planes) plane = {};

    std::vector<std::size_t> bases(blocks + 1, firsts.count);
    for (std::size_t b = 0; b < blocks; ++b) bases[b + 1] = bases[b] + results[b].further.size();
    result.values.reserve(bases[blocks] + 1);
    std::size_t unused = 0;
    for (StarWorker::Block& block : results) {
        result.values.insert(result.values.end(), block.further.begin(), block.further.end());
        release(block.further);
        result.suspects.insert(result.suspects.end(), block.suspects.begin(), block.suspects.end());
        unused += block.unused.size();
    }
    parallel_blocks(blocks, 1, options.threads, [&](std::size_t b, std::size_t) {
        for (const Index corner : results[b].further_corners)
            corner_values[corner] += Index(bases[b]);
    });
    if (unused > 0) remove_unused(results, result.values, corner_values);
    return result;
}

}  // namespace prep::detail
