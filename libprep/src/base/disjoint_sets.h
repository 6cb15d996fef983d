// Union-find with path halving; a set's representative is its lowest member, so that results do not
// depend on the order of the unions.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace prep::detail {

class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : parents_(count) {
        for (std::size_t i = 0; i < count; ++i) parents_[i] = std::uint32_t(i);
    }
    std::uint32_t find(std::uint32_t x) {
        while (parents_[x] != x) x = parents_[x] = parents_[parents_[x]];
        return x;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        if (a > b) std::swap(a, b);
        parents_[b] = a;
    }

  private:
    std::vector<std::uint32_t> parents_;
};

}  // namespace prep::detail
