#include "surface/corner_tree.h"

#include <algorithm>
#include <numeric>

namespace prep::detail {

CornerTree::CornerTree(const std::vector<glm::vec2>& points) : points_(points) {
    constexpr Index leaf_size = 16;  // below it, looking at all is cheaper than descending
    const Index count = static_cast<Index>(points.size());
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), Index(0));
    leaf_.resize(count);
    live_.assign(count, 0);
    nodes_.push_back({});
    nodes_[0].end = count;
    for (Index n = 0; n < nodes_.size(); ++n) {
        Node node = nodes_[n];
        if (node.begin == node.end) continue;
        node.low = node.high = points[order_[node.begin]];
        for (Index k = node.begin; k < node.end; ++k) {
            node.low = glm::min(node.low, points[order_[k]]);
            node.high = glm::max(node.high, points[order_[k]]);
        }
        if (node.end - node.begin <= leaf_size) {
            for (Index k = node.begin; k < node.end; ++k) leaf_[order_[k]] = n;
        } else {
            const glm::dvec2 size = glm::dvec2(node.high) - glm::dvec2(node.low);
            const int axis = size.x >= size.y ? 0 : 1;
            const Index middle = node.begin + (node.end - node.begin) / 2;
            std::nth_element(order_.begin() + node.begin, order_.begin() + middle,
                             order_.begin() + node.end, [&](Index a, Index b) {
                                 return points[a][axis] != points[b][axis]
                                            ? points[a][axis] < points[b][axis]
                                            : a < b;
                             });
            node.first_child = static_cast<Index>(nodes_.size());
            Node child;
            child.parent = n;
            child.begin = node.begin;
            child.end = middle;
            nodes_.push_back(child);
            child.begin = middle;
            child.end = node.end;
            nodes_.push_back(child);
        }
        nodes_[n] = node;
    }
}

void CornerTree::set_live(Index point, bool live) {
    if (bool(live_[point]) == live) return;
    live_[point] = live;
    for (Index n = leaf_[point];; n = nodes_[n].parent) {
        nodes_[n].live += live ? 1 : Index(-1);
        if (n == 0) break;
    }
}

}  // namespace prep::detail
