// The live ones of a polygon's corners inside a triangle's reach, found without looking at all.
//
// A k-d tree (Bentley 1975) over fixed points, of which each is live or not. O(k log k) to build,
// O(log k) to change a point, about O(√k + found) to search.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace prep::detail {

class CornerTree {
  public:
    using Index = std::uint32_t;

    // `points` must outlive the tree; finite coordinates. No point is live at first.
    explicit CornerTree(const std::vector<glm::vec2>& points);

    void set_live(Index point, bool live);

    // Whether `blocks(point)` holds for a live point of those that may lie in the counter-clockwise
    // triangle a, b, c or on its rim; points that surely do not are left out. Adds what was looked
    // at to `work`.
    template <class Blocks>
    bool any_near(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c, std::size_t& work,
                  Blocks&& blocks) const;

  private:
    struct Node {
        glm::vec2 low, high;       // bounds of its points
        Index begin = 0, end = 0;  // in order_
        Index live = 0;
        Index first_child = 0;  // the other one follows it; 0: a leaf
        Index parent = 0;
    };
    // Whether the box lies beyond the line from a to b, rounding considered.
    static bool beyond(const Node& node, const glm::vec2& a, const glm::vec2& b);

    const std::vector<glm::vec2>& points_;
    std::vector<Index> order_, leaf_;  // leaf_ by point
    std::vector<char> live_;           // by point
    std::vector<Node> nodes_;
};

inline bool CornerTree::beyond(const Node& node, const glm::vec2& a, const glm::vec2& b) {
    // The corner of the box farthest to the left of the line decides.
    const glm::dvec2 d = glm::dvec2(b) - glm::dvec2(a);
    const glm::dvec2 p(d.y > 0 ? node.low.x : node.high.x, d.x > 0 ? node.high.y : node.low.y);
    const glm::dvec2 q = p - glm::dvec2(a);
    const double left = d.x * q.y, right = d.y * q.x;
    // The bound of orient2d.
    return left - right < -4 * 0x1p-52 * (glm::abs(left) + glm::abs(right));
}

template <class Blocks>
bool CornerTree::any_near(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c,
                          std::size_t& work, Blocks&& blocks) const {
    const glm::vec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
    Index waiting[64];  // one for each level of a tree of 2^32 points, at most
    std::size_t count = 0;
    waiting[count++] = 0;
    while (count > 0) {
        const Node& node = nodes_[waiting[--count]];
        ++work;
        if (node.live == 0 || node.high.x < low.x || node.low.x > high.x || node.high.y < low.y ||
            node.low.y > high.y)
            continue;
        if (node.first_child != 0) {
            if (beyond(node, a, b) || beyond(node, b, c) || beyond(node, c, a)) continue;
            waiting[count++] = node.first_child + 1;
            waiting[count++] = node.first_child;
            continue;
        }
        for (Index k = node.begin; k < node.end; ++k) {
            const Index point = order_[k];
            const glm::vec2& p = points_[point];
            ++work;
            if (live_[point] && p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y &&
                blocks(point))
                return true;
        }
    }
    return false;
}

}  // namespace prep::detail
