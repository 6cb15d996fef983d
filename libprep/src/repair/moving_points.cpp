// Which vertices at one position are one point of a mesh that moves.
#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

#include "model/origin.h"
#include "model/vertex_deltas.h"
#include "repair/repair_steps.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Up to here vertices move as one: of weights the sum of their differences (of eight with 8 bits
// each may be off by a step), of deltas a length over the size of the faces' points.
constexpr float weights_alike = 8.5f / 255;
constexpr double deltas_alike = 0x1p-20;

class Motion {
  public:
    explicit Motion(const Mesh& mesh) : mesh_(mesh) {
        PositionBounds bounds;  // what no face uses may lie anywhere
        for (const Index v : mesh.corner_vertices) bounds.add(glm::dvec3(mesh.positions[v]));
        delta_ = deltas_alike * bounds.diagonal();
    }

    bool is_weighted(Index vertex) const { return has_weights(mesh_, mesh_.file_vertex(vertex)); }

    bool is_alike(Index a, Index b) {
        return is_morphed_alike(mesh_.file_vertex(a), mesh_.file_vertex(b)) &&
               (!is_weighted(a) || !is_weighted(b) ||
                are_weights_alike(shares_of(mesh_.file_vertex(a)),
                                  shares_of(mesh_.file_vertex(b))));
    }

  private:
    // Of each joint in the sum of a vertex' weights, ascending by joint.
    using Shares = std::vector<std::pair<std::uint16_t, float>>;

    bool is_morphed_alike(Index a, Index b) const {
        for (const MorphTarget& target : mesh_.morph_targets) {
            const glm::vec3 *of_a = delta_of(target.positions, a),
                            *of_b = delta_of(target.positions, b);
            const glm::dvec3 between = glm::dvec3(of_a ? *of_a : glm::vec3(0.0f)) -
                                       glm::dvec3(of_b ? *of_b : glm::vec3(0.0f));
            if (glm::length(between) > delta_) return false;
        }
        return true;
    }

    const Shares& shares_of(Index file_vertex) {
        const auto [at, fresh] = shares_.try_emplace(file_vertex);
        Shares& shares = at->second;
        if (!fresh) return shares;
        float sum = 0;
        for (const SkinInfluences& set : mesh_.skin_influences)
            for (int k = 0; k < 4; ++k)
                if (const float weight = set.weights[file_vertex][k]; weight != 0) {
                    shares.emplace_back(set.joints[file_vertex][k], weight);
                    sum += weight;
                }
        std::sort(shares.begin(), shares.end());
        for (auto& [joint, weight] : shares) weight /= sum;
        return shares;
    }

    static bool are_weights_alike(const Shares& a, const Shares& b) {
        float apart = 0;
        for (std::size_t i = 0, k = 0; i < a.size() || k < b.size();) {
            const std::uint16_t joint = k == b.size() || (i < a.size() && a[i].first < b[k].first)
                                            ? a[i].first
                                            : b[k].first;
            float more = 0;  // a joint may have several weights
            for (; i < a.size() && a[i].first == joint; ++i) more += a[i].second;
            for (; k < b.size() && b[k].first == joint; ++k) more -= b[k].second;
            apart += std::abs(more);
        }
        return !(apart > weights_alike);
    }

    const Mesh& mesh_;
    double delta_;
    std::unordered_map<Index, Shares> shares_;  // by file vertex
};

}  // namespace

MovingPoints moving_points(const Mesh& mesh, int threads) {
    const std::vector<Index> equal = weld_exact(mesh.positions, threads);
    MovingPoints points{equal, 0};
    if (mesh.morph_targets.empty() && mesh.skin_influences.empty()) return points;
    std::vector<std::uint8_t> is_repeated(equal.size(), 0), has_face(equal.size(), 0);
    for (Index v = 0; v < equal.size(); ++v)
        if (equal[v] != v) is_repeated[equal[v]] = 1;
    for (const Index v : mesh.corner_vertices) has_face[v] = 1;

    Motion motion(mesh);
    constexpr std::size_t most = 16;  // of one position: others stay by themselves
    std::unordered_map<Index, std::vector<Index>> firsts;  // of each way to move, by position
    // Those without weights, of parts that no skin moves, go with the first that has some.
    for (const bool weighted : {true, false})
        for (Index v = 0; v < equal.size(); ++v) {
            if (!is_repeated[equal[v]] || motion.is_weighted(v) != weighted) continue;
            std::vector<Index>& ways = firsts[equal[v]];
            const auto own = std::find_if(ways.begin(), ways.end(),
                                          [&](Index u) { return motion.is_alike(u, v); });
            points.first[v] = own == ways.end() ? v : *own;
            if (own == ways.end() && ways.size() < most) ways.push_back(v);
        }
    std::vector<Index> used;  // by position, those that faces have
    for (Index v = 0; v < equal.size(); ++v)
        if (has_face[v] && is_repeated[equal[v]]) used.push_back(v);
    std::sort(used.begin(), used.end(), [&](Index a, Index b) {
        return std::pair(equal[a], points.first[a]) < std::pair(equal[b], points.first[b]);
    });
    for (std::size_t k = 1; k < used.size(); ++k)
        points.apart += equal[used[k]] == equal[used[k - 1]] &&
                        points.first[used[k]] != points.first[used[k - 1]];
    return points;
}

}  // namespace prep::detail
