#include "tangent_groups.h"

#include <algorithm>
#include <cmath>

#include "parallel.h"
#include "tangent_math.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr std::size_t vertex_grain = 8192;
// Up to this many triangles at a vertex neighbours are searched one by one, above it by sorting.
constexpr std::size_t small_star = 24;

// Triangle corners (3·triangle + k) by welded vertex, ascending, good triangles only.
struct Stars {
    std::vector<Index> offsets, members;
    std::span<const Index> of(Index vertex) const {
        return {members.data() + offsets[vertex], offsets[vertex + 1] - offsets[vertex]};
    }
};

Stars build_stars(const TangentMesh& mesh) {
    Stars stars;
    stars.offsets.assign(std::size_t(mesh.welded_count) + 1, 0);
    for (std::size_t k = 0; k < 3 * mesh.good; ++k)
        ++stars.offsets[mesh.welded[mesh.corners[k]] + 1];
    for (std::size_t v = 0; v < mesh.welded_count; ++v) stars.offsets[v + 1] += stars.offsets[v];
    stars.members.resize(3 * mesh.good);
    std::vector<Index> cursor(stars.offsets.begin(), stars.offsets.end() - 1);
    for (Index k = 0; k < 3 * mesh.good; ++k)
        stars.members[cursor[mesh.welded[mesh.corners[k]]]++] = k;
    return stars;
}

inline Index next_of(Index k) {
    return k % 3 == 2 ? k - 2 : k + 1;
}
inline Index previous_of(Index k) {
    return k % 3 == 0 ? k + 2 : k - 1;
}

// Step 5 at one vertex: for each member its neighbours over the edge leaving and the edge entering
// the vertex, as positions in the star. Over one edge the n-th triangle that leaves meets the n-th
// that enters: lower triangle numbers pair first.
class Neighbours {
  public:
    void find(const TangentMesh& mesh, std::span<const Index> star) {
        const std::size_t n = star.size();
        leaving_.assign(n, no_index);
        entering_.assign(n, no_index);
        next_.resize(n);
        previous_.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            next_[i] = mesh.welded[mesh.corners[next_of(star[i])]];
            previous_[i] = mesh.welded[mesh.corners[previous_of(star[i])]];
        }
        if (n <= small_star)
            search();
        else
            sort();
    }
    Index leaving(std::size_t i) const { return leaving_[i]; }
    Index entering(std::size_t i) const { return entering_[i]; }

  private:
    void link(std::size_t leaves, std::size_t enters) {
        leaving_[leaves] = Index(enters);
        entering_[enters] = Index(leaves);
    }
    void search() {
        const std::size_t n = next_.size();
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j) {
                if (previous_[j] == next_[i] && entering_[j] == no_index) {
                    link(i, j);
                    break;
                }
            }
        }
    }
    void sort() {
        const std::size_t n = next_.size();
        const auto order_by = [n](const std::vector<Index>& key, std::vector<Index>& order) {
            order.resize(n);
            for (std::size_t i = 0; i < n; ++i) order[i] = Index(i);
            std::sort(order.begin(), order.end(),
                      [&](Index a, Index b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
        };
        order_by(next_, by_next_);
        order_by(previous_, by_previous_);
        for (std::size_t i = 0, j = 0; i < n && j < n;) {
            const Index a = next_[by_next_[i]], b = previous_[by_previous_[j]];
            if (a < b) {
                ++i;
            } else if (b < a) {
                ++j;
            } else {
                link(by_next_[i++], by_previous_[j++]);
            }
        }
    }

    std::vector<Index> leaving_, entering_, next_, previous_, by_next_, by_previous_;
};

// Step 6 at one vertex. Groups are numbered in the order in which their first triangle comes.
class Grouper {
  public:
    // group[i] stays as it is where a member is grouped already (no_index: not yet).
    // `start` decides which members may start a group; claims() says what orientations were taken
    // by triangles that group with anything.
    static void flood(const TangentMesh& mesh, std::span<const Index> star,
                      const Neighbours& neighbours, std::size_t first, Index group,
                      std::vector<std::uint8_t>& orientation, std::vector<std::uint8_t>& claimed,
                      Index* groups, std::vector<Index>& stack) {
        const std::uint8_t wanted = orientation[star[first] / 3];
        groups[first] = group;
        claimed[star[first] / 3] = 1;
        stack.clear();
        // Depth first, over the leaving edge before the entering one.
        const auto push = [&](std::size_t i) {
            if (neighbours.entering(i) != no_index) stack.push_back(neighbours.entering(i));
            if (neighbours.leaving(i) != no_index) stack.push_back(neighbours.leaving(i));
        };
        push(first);
        while (!stack.empty()) {
            const Index i = stack.back();
            stack.pop_back();
            if (groups[i] != no_index) continue;
            const Index t = star[i] / 3;
            if ((mesh.flags[t] & group_with_anything) && !claimed[t]) orientation[t] = wanted;
            if (orientation[t] != wanted) continue;
            groups[i] = group;
            claimed[t] = 1;
            push(i);
        }
    }
};

// Step 7: the tangents of one group.
class Evaluator {
  public:
    Evaluator(const TangentInput& input, const TangentMesh& mesh, const TangentOptions& options)
        : read_{input},
          mesh_(mesh),
          threshold_(float(std::cos(options.angular_threshold))),
          full_(mesh.any_quad) {}

    struct Block {
        std::vector<glm::vec4> values;
        std::vector<GroupFrame> frames;
    };

    // members: triangle corners of one group, ascending.
    void evaluate(std::span<const Index> members, bool preserving, Block& block,
                  Index* corner_values) {
        normal_ = read_.normal(mesh_.corners[members[0]]);
        const std::size_t n = members.size();
        s_.resize(n);
        t_.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            const TriangleFrame& frame = mesh_.frames[members[i] / 3];
            s_[i] = mikk::projected(normal_, frame.s);
            t_[i] = mikk::projected(normal_, frame.t);
        }
        const float sign = preserving ? 1.0f : -1.0f;
        if (all_together(members)) {
            all_.resize(n);
            for (std::size_t i = 0; i < n; ++i) all_[i] = Index(i);
            const Index value = sum(members, all_, sign, block);
            for (const Index k : members) corner_values[k] = value;
            return;
        }
        split_by_angle(members, sign, block, corner_values);
    }

  private:
    bool stay(std::span<const Index> members, std::size_t i, std::size_t j) const {
        const Index a = members[i] / 3, b = members[j] / 3;
        if ((mesh_.flags[a] | mesh_.flags[b]) & group_with_anything) return true;
        if (mesh_.faces[a] == mesh_.faces[b]) return true;
        return mikk::dot(s_[i], s_[j]) > threshold_ && mikk::dot(t_[i], t_[j]) > threshold_;
    }

    // Quick sufficient test: all within 89.4° of the first (dot > 0.01) are within 178.8° of each
    // other, far from the antipodal pairs that a threshold of −1 parts.
    bool all_together(std::span<const Index> members) const {
        if (threshold_ > -0.9999f) {
            return members.size() == 1;
        }
        for (std::size_t i = 1; i < members.size(); ++i) {
            if (!(mikk::dot(s_[0], s_[i]) > 0.01f && mikk::dot(t_[0], t_[i]) > 0.01f)) return false;
        }
        return true;
    }

    void split_by_angle(std::span<const Index> members, float sign, Block& block,
                        Index* corner_values) {
        const std::size_t n = members.size();
        lists_.clear();
        std::vector<Index> list_values;
        for (std::size_t i = 0; i < n; ++i) {
            list_.clear();
            for (std::size_t j = 0; j < n; ++j)
                if (stay(members, i, j)) list_.push_back(Index(j));
            const auto known = std::find(lists_.begin(), lists_.end(), list_);
            if (known == lists_.end()) {
                lists_.push_back(list_);
                list_values.push_back(sum(members, list_, sign, block));
                corner_values[members[i]] = list_values.back();
            } else {
                corner_values[members[i]] = list_values[std::size_t(known - lists_.begin())];
            }
        }
    }

    Index sum(std::span<const Index> members, const std::vector<Index>& list, float sign,
              Block& block) const {
        GroupFrame total{glm::vec3(0.0f), glm::vec3(0.0f), 0, 0};
        float angle_sum = 0;
        for (const Index i : list) {
            const Index k = members[i], triangle = k / 3;
            if (mesh_.flags[triangle] & group_with_anything) continue;
            const float angle = corner_angle(k);
            total.s += mikk::scaled(angle, s_[i]);
            if (!full_) continue;
            total.t += mikk::scaled(angle, t_[i]);
            total.s_length += angle * mesh_.frames[triangle].s_length;
            total.t_length += angle * mesh_.frames[triangle].t_length;
            angle_sum += angle;
        }
        if (mikk::not_zero(total.s)) total.s = mikk::normalized(total.s);
        block.values.push_back(glm::vec4(total.s, sign));
        if (full_) {
            if (mikk::not_zero(total.t)) total.t = mikk::normalized(total.t);
            if (angle_sum > 0) {
                total.s_length /= angle_sum;
                total.t_length /= angle_sum;
            }
            block.frames.push_back(total);
        }
        return Index(block.values.size() - 1);
    }

    float corner_angle(Index k) const {
        const glm::vec3 p = read_.position(mesh_.corners[k]);
        const glm::vec3 a =
            mikk::projected(normal_, read_.position(mesh_.corners[previous_of(k)]) - p);
        const glm::vec3 b = mikk::projected(normal_, read_.position(mesh_.corners[next_of(k)]) - p);
        float cosine = mikk::dot(a, b);
        cosine = cosine > 1.0f ? 1.0f : cosine < -1.0f ? -1.0f : cosine;
        return float(std::acos(double(cosine)));
    }

    CornerReader read_;
    const TangentMesh& mesh_;
    float threshold_;
    bool full_;
    glm::vec3 normal_{0.0f};
    std::vector<glm::vec3> s_, t_;
    std::vector<Index> all_, list_;
    std::vector<std::vector<Index>> lists_;
};

struct Scratch {
    Neighbours neighbours;
    std::vector<Index> groups, stack, members;
};

}  // namespace

GroupTangents group_tangents(const TangentInput& input, const TangentMesh& mesh,
                             const TangentOptions& options) {
    const Stars stars = build_stars(mesh);
    const std::size_t corners = 3 * mesh.good;
    std::vector<std::uint8_t> orientation(mesh.good), claimed(mesh.good, 0);
    for (std::size_t t = 0; t < mesh.good; ++t)
        orientation[t] = mesh.flags[t] & orientation_preserving;

    // Vertices with a triangle that groups with anything, in the mesh's triangle order.
    std::vector<std::uint8_t> entangled(mesh.welded_count, 0);
    bool any_entangled = false;
    for (std::size_t k = 0; k < corners; ++k)
        if (mesh.flags[k / 3] & group_with_anything) {
            entangled[mesh.welded[mesh.corners[k]]] = 1;
            any_entangled = true;
        }
    std::vector<Index> corner_groups(any_entangled ? corners : 0, no_index);
    if (any_entangled) {
        Scratch scratch;
        std::vector<Index> group_count(mesh.welded_count, 0);
        for (Index k = 0; k < corners; ++k) {
            const Index vertex = mesh.welded[mesh.corners[k]];
            if (!entangled[vertex] || corner_groups[k] != no_index ||
                (mesh.flags[k / 3] & group_with_anything))
                continue;
            const std::span<const Index> star = stars.of(vertex);
            scratch.neighbours.find(mesh, star);
            scratch.groups.resize(star.size());
            for (std::size_t i = 0; i < star.size(); ++i)
                scratch.groups[i] = corner_groups[star[i]];
            const std::size_t first =
                std::size_t(std::lower_bound(star.begin(), star.end(), k) - star.begin());
            Grouper::flood(mesh, star, scratch.neighbours, first, group_count[vertex]++,
                           orientation, claimed, scratch.groups.data(), scratch.stack);
            for (std::size_t i = 0; i < star.size(); ++i)
                corner_groups[star[i]] = scratch.groups[i];
        }
    }

    GroupTangents result;
    result.corner_values.assign(corners, no_index);
    std::vector<Evaluator::Block> blocks((mesh.welded_count + vertex_grain - 1) / vertex_grain);
    parallel_blocks(
        mesh.welded_count, vertex_grain, options.threads, [&](std::size_t begin, std::size_t end) {
            Evaluator evaluator(input, mesh, options);
            Evaluator::Block& block = blocks[begin / vertex_grain];
            Scratch scratch;
            for (std::size_t v = begin; v < end; ++v) {
                const std::span<const Index> star = stars.of(Index(v));
                std::vector<Index>& groups = scratch.groups;
                groups.assign(star.size(), no_index);
                Index group_count = 0;
                if (entangled[v]) {
                    for (std::size_t i = 0; i < star.size(); ++i) {
                        groups[i] = corner_groups[star[i]];
                        if (groups[i] != no_index)
                            group_count = std::max(group_count, groups[i] + 1);
                    }
                } else {
                    // Alone at this vertex: nobody claims anything, so `claimed` is not touched in
                    // a way that others read.
                    scratch.neighbours.find(mesh, star);
                    for (std::size_t i = 0; i < star.size(); ++i) {
                        if (groups[i] != no_index) continue;
                        groups[i] = group_count;
                        scratch.stack.assign(1, Index(i));
                        while (!scratch.stack.empty()) {
                            const Index m = scratch.stack.back();
                            scratch.stack.pop_back();
                            for (const Index other :
                                 {scratch.neighbours.leaving(m), scratch.neighbours.entering(m)}) {
                                if (other == no_index || groups[other] != no_index ||
                                    orientation[star[other] / 3] != orientation[star[i] / 3])
                                    continue;
                                groups[other] = group_count;
                                scratch.stack.push_back(other);
                            }
                        }
                        ++group_count;
                    }
                }
                if (group_count == 1 &&
                    std::find(groups.begin(), groups.end(), no_index) == groups.end()) {
                    evaluator.evaluate(star, orientation[star[0] / 3] != 0, block,
                                       result.corner_values.data());
                    continue;
                }
                // Members by group, in one stable pass over a sorted order.
                std::vector<Index>& order = scratch.stack;
                order.clear();
                for (std::size_t i = 0; i < star.size(); ++i)
                    if (groups[i] != no_index) order.push_back(Index(i));
                std::stable_sort(order.begin(), order.end(),
                                 [&](Index a, Index b) { return groups[a] < groups[b]; });
                for (std::size_t i = 0; i < order.size();) {
                    scratch.members.clear();
                    const Index group = groups[order[i]];
                    const bool preserving = orientation[star[order[i]] / 3] != 0;
                    for (; i < order.size() && groups[order[i]] == group; ++i)
                        scratch.members.push_back(star[order[i]]);
                    evaluator.evaluate(scratch.members, preserving, block,
                                       result.corner_values.data());
                }
            }
        });

    std::vector<Index> bases(blocks.size() + 1, 0);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        bases[b + 1] = bases[b] + Index(blocks[b].values.size());
    for (const Evaluator::Block& block : blocks) {
        result.values.insert(result.values.end(), block.values.begin(), block.values.end());
        result.frames.insert(result.frames.end(), block.frames.begin(), block.frames.end());
    }
    parallel_blocks(mesh.welded_count, vertex_grain, options.threads,
                    [&](std::size_t begin, std::size_t end) {
                        const Index base = bases[begin / vertex_grain];
                        for (Index i = stars.offsets[begin]; i < stars.offsets[end]; ++i) {
                            Index& value = result.corner_values[stars.members[i]];
                            if (value != no_index) value += base;
                        }
                    });
    return result;
}

}  // namespace prep::detail
