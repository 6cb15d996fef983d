#include "tangents/groups.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "tangents/math.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
using OneRing = std::span<const Index>;
// Listed positions per block of work, about 0.1 ms.
constexpr std::size_t position_grain = 512;
// Lists of larger rings are given back before others are made.
constexpr std::size_t most_kept = 4096;
constexpr std::size_t most_usual = 16;  // members of a usual ring

template <class Body>
void for_each_bit(std::uint32_t bits, const Body& body) {
    for (; bits != 0; bits &= bits - 1) body(std::size_t(std::countr_zero(bits)));
}

// Step 6: gives group `number` to `first` and to all that is reached from it over pairs. joins(i):
// may member i?
template <class Joins>
void flood(std::span<const Index> leaving, std::span<const Index> entering, Index first,
           Index number, std::span<Index> groups, std::vector<Index>& stack, const Joins& joins) {
    stack.assign(1, first);
    while (!stack.empty()) {
        const Index i = stack.back();
        stack.pop_back();
        if (groups[i] != no_index || !joins(i)) continue;
        groups[i] = number;
        // Depth first, over the leaving edge before the entering one.
        if (entering[i] != no_index) stack.push_back(entering[i]);
        if (leaving[i] != no_index) stack.push_back(leaving[i]);
    }
}

// One-rings that triangles which group with anything touch, grouped in the mesh's triangle order.
class EntangledRings {
  public:
    EntangledRings(const TangentTriangles& triangles, const ContributionStore& store,
                   const OneRings& rings, const EdgeOverrides& overrides, int threads)
        : store_(store), rings_(rings) {
        if (store.counts.anything == 0) return;
        collect(threads);
        find_neighbours(overrides, threads);
        flood_all(triangles.count);
    }

    bool empty() const { return firsts_.empty(); }
    // The first ring that begins at or behind a place in OneRings::members.
    std::size_t at(Index place) const {
        return std::size_t(std::lower_bound(firsts_.begin(), firsts_.end(), place) -
                           firsts_.begin());
    }
    bool is(std::size_t ring, OneRing members) const {
        return ring < firsts_.size() && rings_.members.data() + firsts_[ring] == members.data();
    }
    // The group of each member of the ring, or no_index; numbered in the order in which they began.
    std::span<const Index> groups(std::size_t ring) const {
        return {groups_.data() + starts_[ring], starts_[ring + 1] - starts_[ring]};
    }

  private:
    void collect(int threads) {
        const std::size_t blocks = (rings_.count + position_grain - 1) / position_grain;
        std::vector<std::vector<OneRing>> found(blocks);
        const auto anything = [&](Index m) {
            return (store_.flags(m >> 2) & group_with_anything) != 0;
        };
        parallel_blocks(rings_.count, position_grain, threads,
                        [&](std::size_t begin, std::size_t end) {
                            rings_.for_each(begin, end, [&](OneRing ring) {
                                if (std::any_of(ring.begin(), ring.end(), anything))
                                    found[begin / position_grain].push_back(ring);
                            });
                        });
        starts_.push_back(0);
        for (const auto& list : found) {
            for (const OneRing ring : list) {
                firsts_.push_back(Index(ring.data() - rings_.members.data()));
                starts_.push_back(starts_.back() + ring.size());
            }
        }
    }

    OneRing members(std::size_t ring) const {
        return {rings_.members.data() + firsts_[ring], starts_[ring + 1] - starts_[ring]};
    }

    void find_neighbours(const EdgeOverrides& overrides, int threads) {
        leaving_.resize(starts_.back());
        entering_.resize(starts_.back());
        parallel_blocks(firsts_.size(), 1024, threads, [&](std::size_t begin, std::size_t end) {
            EdgePairs pairs;
            for (std::size_t s = begin; s < end; ++s) {
                const OneRing ring = members(s);
                pairs.find(rings_, ring, overrides);
                std::copy_n(pairs.leaving().begin(), ring.size(), &leaving_[starts_[s]]);
                std::copy_n(pairs.entering().begin(), ring.size(), &entering_[starts_[s]]);
            }
        });
    }

    void flood_all(std::size_t triangles) {
        struct Start {
            Index member, ring, place;
        };
        std::vector<Start> starts;
        for (std::size_t s = 0; s < firsts_.size(); ++s) {
            const OneRing ring = members(s);
            for (std::size_t i = 0; i < ring.size(); ++i)
                if (!(store_.flags(ring[i] >> 2) & group_with_anything))
                    starts.push_back({ring[i], Index(s), Index(i)});
        }
        std::sort(starts.begin(), starts.end(),
                  [](const Start& a, const Start& b) { return a.member < b.member; });
        orientation_.resize(triangles);
        for (std::size_t t = 0; t < triangles; ++t)
            orientation_[t] = (store_.flags(t) & orientation_preserving) ? 1 : 0;
        claimed_.assign(triangles, 0);
        groups_.assign(starts_.back(), no_index);
        std::vector<Index> group_count(firsts_.size(), 0);
        for (const Start& start : starts)
            if (groups_[starts_[start.ring] + start.place] == no_index)
                flood_from(start.ring, start.place, group_count[start.ring]++);
    }

    void flood_from(std::size_t index, Index first, Index group) {
        const OneRing ring = members(index);
        const std::size_t base = starts_[index];
        const std::uint8_t wanted = orientation_[ring[first] >> 2];
        const auto part = [&](std::vector<Index>& of) {
            return std::span(of).subspan(base, ring.size());
        };
        flood(part(leaving_), part(entering_), first, group, part(groups_), stack_, [&](Index i) {
            const Index t = ring[i] >> 2;
            if ((store_.flags(t) & group_with_anything) && !claimed_[t]) orientation_[t] = wanted;
            if (orientation_[t] != wanted) return false;
            claimed_[t] = 1;
            return true;
        });
    }

    const ContributionStore& store_;
    const OneRings& rings_;
    std::vector<Index> firsts_;        // per entangled ring: its place in OneRings::members
    std::vector<std::size_t> starts_;  // and where its entries start in the following
    std::vector<Index> leaving_, entering_, groups_;
    std::vector<std::uint8_t> orientation_, claimed_;
    std::vector<Index> stack_;
};

// Groups and evaluates ring after ring of one block.
class RingTangents {
  public:
    RingTangents(const GroupInput& input, const EntangledRings& entangled)
        : in_(input),
          entangled_(entangled),
          subgroups_(input.read, input.triangles, input.store, input.options.angular_threshold,
                     input.options.bounded_effort),
          sums_tell_(opposites_only(input.options.angular_threshold) && !input.triangles.any_quad) {
    }

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
        std::size_t next_entangled =
            entangled_.empty() ? 0 : entangled_.at(in_.rings.offsets[begin]);
        for (std::size_t i = begin; i < end; ++i) {
            const Index v = in_.rings.listed[i];
            first_free_ = true;
            first_value_ = in_.firsts.all_listed       ? i
                           : in_.firsts.places.empty() ? v
                                                       : in_.firsts.places[v];
            in_.rings.for_each(i, i + 1, [&](OneRing ring) {
                if (!entangled_.empty() && entangled_.is(next_entangled, ring)) {
                    const std::span<const Index> groups = entangled_.groups(next_entangled++);
                    groups_.assign(groups.begin(), groups.end());
                } else {
                    if (take_usual(ring)) return;
                    find_groups(ring);
                }
                evaluate_groups(ring);
            });
            if (first_free_) block.unused.push_back(Index(first_value_));
        }
        // They stay until all blocks are done.
        block.further.shrink_to_fit();
        block.further_corners.shrink_to_fit();
    }

  private:
    // Steps 5 to 8 of a ring of few members whose groups are their sums, without a list: a bit is a
    // member. False: the ring is another. Without it bench_tangents' hard_edges takes 1.8 times as
    // long.
    bool take_usual(OneRing ring) {
        const std::size_t n = ring.size();
        if (!sums_tell_ || n > most_usual || in_.overrides.touch(in_.rings, ring)) return false;
        std::array<Index, most_usual> next, previous;
        std::array<const Contribution*, most_usual> contributions;
        std::uint32_t preserving = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const Index triangle = ring[i] >> 2, k = ring[i] & 3;
            const Index* const names = in_.rings.names_of(triangle);
            next[i] = names[k == 2 ? 0 : k + 1];
            previous[i] = names[k == 0 ? 2 : k - 1];
            contributions[i] = &in_.store.at(triangle, k);
            const bool preserves = (contributions[i]->code & orientation_preserving) != 0;
            preserving |= std::uint32_t(preserves) << i;
        }
        const std::uint32_t all = (std::uint32_t(1) << n) - 1;
        std::array<std::uint32_t, most_usual> linked{};  // to those that it may share a group with
        for (std::uint32_t i = 0, unmet = all; i < n; ++i) {
            std::uint32_t mates = 0;
            for (std::uint32_t j = 0; j < n; ++j)
                mates |= std::uint32_t(previous[j] == next[i]) << j;
            mates &= unmet;
            if (mates == 0) continue;
            const int mate = std::countr_zero(mates);
            unmet &= ~(std::uint32_t(1) << mate);
            linked[i] |= std::uint32_t(1) << mate;
            linked[std::size_t(mate)] |= std::uint32_t(1) << i;
        }
        struct Group {
            std::uint32_t members;
            glm::vec4 value;
        };
        std::array<Group, most_usual> groups;
        std::size_t count = 0;
        for (std::uint32_t rest = all; rest != 0;) {
            std::uint32_t group = rest & (~rest + 1);
            const std::uint32_t alike = rest & (group & preserving ? preserving : ~preserving);
            for (std::uint32_t edge = group; edge != 0;) {
                const std::uint32_t reached =
                    linked[std::size_t(std::countr_zero(edge))] & alike & ~group;
                edge = (edge & (edge - 1)) | reached;
                group |= reached;
            }
            rest &= ~group;
            glm::vec3 sum(0.0f);
            std::uint32_t code = ~0u;
            for_each_bit(group, [&](std::size_t i) {
                sum += glm::vec3(contributions[i]->x, contributions[i]->y, contributions[i]->z);
                code &= contributions[i]->code;
            });
            if (!std::has_single_bit(group) && !share_half_space(code)) return false;
            groups[count++] = {group, {mikk::normalized_or_zero(sum), w_of(group & preserving)}};
        }
        for (std::size_t g = 0; g < count; ++g) {
            const Kept kept =
                keep(groups[g].value, ring[std::size_t(std::countr_zero(groups[g].members))]);
            for_each_bit(groups[g].members, [&](std::size_t i) { give(ring[i], kept); });
        }
        return true;
    }

    // Step 6 where no triangle groups with anything.
    void find_groups(OneRing ring) {
        pairs_.find(in_.rings, ring, in_.overrides);
        groups_.assign(ring.size(), no_index);
        Index count = 0;
        for (Index i = 0; i < ring.size(); ++i) {
            if (groups_[i] != no_index) continue;
            const std::uint32_t wanted = in_.store.flags(ring[i] >> 2) & orientation_preserving;
            flood(pairs_.leaving(), pairs_.entering(), i, count++, groups_, stack_, [&](Index m) {
                return (in_.store.flags(ring[m] >> 2) & orientation_preserving) == wanted;
            });
        }
        // A pole's lists would be beside those of its frames.
        if (ring.size() > most_kept) {
            pairs_ = {};
            release(stack_);
        }
    }

    // Steps 7 and 8: the values of all groups, and which one each member has.
    void evaluate_groups(OneRing ring) {
        sum_groups(ring);
        frames_.clear();
        ring_values_.clear();
        order_.clear();
        members_values_.resize(ring.size());
        for (Index g = 0; g < sums_.size(); ++g) {
            GroupSum& group = sums_[g];
            // Alone, or with S and T in one half-space, it is its sum. Frames of quads' halves are
            // compared in more than their S: those are evaluated in full.
            if (sums_tell_ && (group.size == 1 || share_half_space(group.code))) {
                group.value = Index(ring_values_.size());
                ring_values_.push_back({mikk::normalized_or_zero(group.sum), w_of(group.sign > 0)});
            } else {
                evaluate_in_full(ring, group);
            }
        }
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Index g = groups_[i];
            if (g == no_index)
                members_values_[i] = no_index;
            else if (sums_[g].value != no_index)
                members_values_[i] = sums_[g].value;
        }
        if (in_.triangles.any_quad && frames_.size() > 1) average_quads(ring);
        const bool large = ring.size() > most_kept;
        if (large) {
            for (std::vector<Index>* list : {&groups_, &order_, &members_, &results_})
                release(*list);
            release(frames_);
            release(sums_);
        }
        keep_values(ring);
        if (large) {
            release(ring_values_);
            release(kept_);
            release(members_values_);
        }
    }

    struct GroupSum {
        glm::vec3 sum{0.0f};       // of the members' contributions
        std::uint32_t code = ~0u;  // the bits that all of these have
        Index size = 0;
        Index first = 0;         // in order_
        Index value = no_index;  // in ring_values_, where all members have one
        std::int8_t sign = 0;    // of the orientation; 0: of none that has one
    };
    static bool share_half_space(std::uint32_t code) {
        return (code & s_directions) && (code & t_directions);
    }
    float w_of(bool preserving) const { return (preserving ? 1.0f : -1.0f) * in_.options.positive; }

    void sum_groups(OneRing ring) {
        sums_.clear();
        for (std::size_t i = 0; i < ring.size(); ++i) {
            if (groups_[i] == no_index && in_.options.review) block_->suspects.push_back(ring[i]);
            if (groups_[i] == no_index) continue;
            if (groups_[i] >= sums_.size()) sums_.resize(groups_[i] + 1);
            GroupSum& group = sums_[groups_[i]];
            ++group.size;
            const Index t = ring[i] >> 2;
            const std::uint32_t flags = in_.store.flags(t);
            // Triangles that group with anything have the orientation of those that do not.
            if (group.sign == 0 && !(flags & group_with_anything))
                group.sign = (flags & orientation_preserving) ? 1 : -1;
            if (!sums_tell_) continue;
            const Contribution& contribution = in_.store.at(t, ring[i] & 3);
            group.sum += glm::vec3(contribution.x, contribution.y, contribution.z);
            group.code &= contribution.code;
        }
    }

    // A group that the angular threshold may part.
    void evaluate_in_full(OneRing ring, GroupSum& group) {
        const std::size_t known = frames_.size(), base = ring_values_.size() - known;
        if (group.size == ring.size()) {
            subgroups_.evaluate(ring, frames_, members_values_);
            for (Index& value : members_values_) value += Index(base);
        } else {
            if (order_.empty()) order_by_group();
            const std::span<const Index> places(order_.data() + group.first, group.size);
            members_.clear();
            for (const Index place : places) members_.push_back(ring[place]);
            subgroups_.evaluate(members_, frames_, results_);
            for (std::size_t k = 0; k < places.size(); ++k)
                members_values_[places[k]] = Index(base) + results_[k];
        }
        if (group.size > most_kept) ring_values_.reserve(with_slack(base + frames_.size()));
        for (std::size_t f = known; f < frames_.size(); ++f)
            ring_values_.push_back({frames_[f].s, w_of(group.sign > 0)});
    }

    // A counting sort of the members that have a group.
    void order_by_group() {
        Index count = 0;
        for (GroupSum& group : sums_) group.first = count += group.size;
        order_.resize(count);
        for (Index i = Index(groups_.size()); i-- > 0;)
            if (groups_[i] != no_index) order_[--sums_[groups_[i]].first] = i;
    }

    // The ring's first value goes to its position's place, the others behind those of all.
    void keep_values(OneRing ring) {
        if (ring.size() > most_kept) {
            block_->further.reserve(with_slack(block_->further.size() + ring_values_.size()));
            block_->further_corners.reserve(block_->further_corners.size() + ring.size());
        }
        kept_.assign(ring_values_.size(), {});
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Index value = members_values_[i];
            if (value == no_index) continue;
            Kept& kept = kept_[value];
            if (kept.place == no_index) kept = keep(ring_values_[value], ring[i]);
            give(ring[i], kept);
        }
    }

    struct Kept {  // of a value
        Index place = no_index;
        bool further = false;  // the place is in Block::further, not the position's own
        bool suspect = false;
    };

    Kept keep(const glm::vec4& value, Index member) {
        Kept kept;
        // All members have one normal.
        kept.suspect = in_.options.review && !has_frame(member, value);
        kept.further = !std::exchange(first_free_, false);
        kept.place = kept.further ? Index(block_->further.size()) : Index(first_value_);
        if (kept.further)
            block_->further.push_back(value);
        else
            values_[first_value_] = value;
        return kept;
    }

    void give(Index member, const Kept& kept) {
        const Index corner = member - (member >> 2);
        in_.corner_values[corner] = kept.place;
        if (kept.further) block_->further_corners.push_back(corner);
        if (kept.suspect) block_->suspects.push_back(member);
    }

    // Step 8: a quad's corner that both halves meet.
    void average_quads(OneRing ring) {
        for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
            const Index a = ring[i], b = ring[i + 1];
            if (!(in_.store.flags(a >> 2) & quad_first) || (b >> 2) != (a >> 2) + 1) continue;
            if (in_.triangles.corner(a >> 2, a & 3) != in_.triangles.corner(b >> 2, b & 3))
                continue;
            const Index x = members_values_[i], y = members_values_[i + 1];
            if (x == no_index || y == no_index || x == y) continue;
            Index value = std::max(x, y);
            if (std::memcmp(&frames_[x], &frames_[y], sizeof(GroupFrame)) != 0) {
                const glm::vec3 sum = glm::vec3(ring_values_[x]) + glm::vec3(ring_values_[y]);
                // A half that groups with anything can have another orientation: the group that
                // came later has the last word.
                const float w = ring_values_[value].w;
                value = Index(ring_values_.size());
                ring_values_.push_back({mikk::normalized_or_zero(sum), w});
            }
            members_values_[i] = members_values_[i + 1] = value;
        }
    }

    bool has_frame(Index member, const glm::vec4& value) const {
        return is_frame(in_.read.normal(in_.triangles.corner(member >> 2, member & 3)),
                        glm::vec3(value));
    }

    const GroupInput in_;
    const EntangledRings& entangled_;
    SubgroupEvaluator subgroups_;
    bool sums_tell_;  // are frames of sums alone those of groups whose S and T share a half-space?
    Block* block_ = nullptr;
    std::span<glm::vec4> values_;
    bool first_free_ = false;      // no corner at the position has its place yet
    std::size_t first_value_ = 0;  // the place
    EdgePairs pairs_;
    std::vector<Index> groups_, stack_, order_, members_, results_, members_values_;
    std::vector<GroupSum> sums_;
    std::vector<GroupFrame> frames_;
    std::vector<glm::vec4> ring_values_;
    std::vector<Kept> kept_;
};

// Closes the gaps that first values leave which no corner has.
void remove_unused(const std::vector<RingTangents::Block>& blocks, std::vector<glm::vec4>& values,
                   std::span<Index> corner_values) {
    std::vector<Index> unused;
    for (const RingTangents::Block& block : blocks)
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

GroupTangents group_tangents(const GroupInput& input, std::vector<glm::vec4> values) {
    std::optional<EntangledRings> entangled;
    const int threads = input.options.threads;
    entangled.emplace(input.triangles, input.store, input.rings, input.overrides, threads);
    const std::size_t blocks = (input.rings.count + position_grain - 1) / position_grain;
    std::vector<RingTangents::Block> results(blocks);
    GroupTangents result;
    result.values = std::move(values);
    result.values.resize(input.firsts.count);
    const auto group_block = [&](std::size_t begin, std::size_t end) {
        RingTangents worker(input, *entangled);
        worker.run(begin, end, result.values, results[begin / position_grain]);
    };
    parallel_blocks(input.rings.count, position_grain, threads, group_block);
    entangled.reset();
    input.rings = {};
    for (auto& plane : input.store.planes) plane = {};

    std::vector<std::size_t> bases(blocks + 1, input.firsts.count);
    for (std::size_t b = 0; b < blocks; ++b) bases[b + 1] = bases[b] + results[b].further.size();
    result.values.reserve(bases[blocks] + 1);
    std::size_t unused = 0;
    for (RingTangents::Block& block : results) {
        result.values.insert(result.values.end(), block.further.begin(), block.further.end());
        release(block.further);
        result.suspects.insert(result.suspects.end(), block.suspects.begin(), block.suspects.end());
        unused += block.unused.size();
    }
    parallel_blocks(blocks, 1, threads, [&](std::size_t b, std::size_t) {
        for (const Index corner : results[b].further_corners)
            input.corner_values[corner] += Index(bases[b]);
    });
    if (unused > 0) remove_unused(results, result.values, input.corner_values);
    return result;
}

}  // namespace prep::detail
