#include <algorithm>
#include <bit>

#include "tangents/one_rings.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr int cells = 2048;
constexpr std::uint32_t first_seed = 39871946;

struct Place {
    glm::vec3 position;
    Index corner;
};

struct Box {
    glm::vec3 low, high;
    explicit Box(std::span<const Place> places)
        : low(places[0].position), high(places[0].position) {
        for (const Place& place : places) {
            for (int k = 0; k < 3; ++k) {
                const float x = place.position[k];
                if (low[k] > x) low[k] = x;
                if (high[k] < x) high[k] = x;
            }
        }
    }
    int longest() const {
        const glm::vec3 d = high - low;
        if (d.y > d.x && d.y > d.z) return 1;
        return d.z > d.x ? 2 : 0;
    }
};

class CellMerger {
  public:
    CellMerger(const TangentInput& input, std::vector<Index>& welds)
        : read_{input}, welds_(welds) {}

    void merge(std::span<Place> all) {
        pending_.assign(1, all);
        while (!pending_.empty()) {
            const std::span<Place> range = pending_.back();
            pending_.pop_back();
            const Box box(range);
            const int axis = box.longest();
            const float middle = 0.5f * (box.high[axis] + box.low[axis]);
            if (!(middle < box.high[axis] && middle > box.low[axis])) {
                merge_equal(range);
                continue;
            }
            const std::size_t cut = partition(range, axis, middle);
            if (cut > 1) pending_.push_back(range.first(cut));
            if (range.size() - cut > 1) pending_.push_back(range.subspan(cut));
        }
    }

  private:
    // Swaps from both ends until everything below `middle` is in front; gives the first place
    // behind.
    static std::size_t partition(std::span<Place> range, int axis, float middle) {
        std::size_t left = 0, right = range.size() - 1;
        while (left < right) {
            while (left < right && range[left].position[axis] < middle) ++left;
            while (left < right && !(range[right].position[axis] < middle)) --right;
            if (left < right) {
                std::swap(range[left], range[right]);
                ++left;
                --right;
            }
        }
        if (left == right && range[right].position[axis] < middle) ++left;
        return left;
    }

    void merge_equal(std::span<const Place> range) {
        keys_.clear();
        for (const Place& place : range) keys_.push_back(corner_key(read_, place.corner));
        order_.resize(range.size());
        for (Index i = 0; i < order_.size(); ++i) order_[i] = i;
        std::sort(order_.begin(), order_.end(), [&](Index a, Index b) {
            if (keys_[a] < keys_[b]) return true;
            if (keys_[b] < keys_[a]) return false;
            return a < b;
        });
        for (std::size_t i = 1; i < order_.size(); ++i) {
            if (keys_[order_[i]] == keys_[order_[i - 1]])
                welds_[range[order_[i]].corner] = welds_[range[order_[i - 1]].corner];
        }
    }

    CornerReader read_;
    std::vector<Index>& welds_;
    std::vector<std::span<Place>> pending_;
    std::vector<CornerKey> keys_;
    std::vector<Index> order_;
};

struct HalfEdgeKey {
    Index lower, half_edge;
};

// Sorts by the lower end, as far as the places of the edges with the greatest one depend on it:
// parts without such an edge stay as they are.
void sort_around_greatest(std::vector<HalfEdgeKey>& edges, Index greatest) {
    struct Range {
        std::ptrdiff_t left, right;
        std::uint32_t seed;
    };
    std::vector<Range> pending{{0, std::ptrdiff_t(edges.size()) - 1, first_seed}};
    while (!pending.empty()) {
        auto [left, right, seed] = pending.back();
        pending.pop_back();
        if (left >= right) continue;
        const bool any = std::any_of(edges.begin() + left, edges.begin() + right + 1,
                                     [&](const HalfEdgeKey& e) { return e.lower == greatest; });
        if (!any) continue;
        if (right - left == 1) {
            if (edges[std::size_t(left)].lower > edges[std::size_t(right)].lower)
                std::swap(edges[std::size_t(left)], edges[std::size_t(right)]);
            continue;
        }
        seed += std::rotl(seed, int(seed & 31)) + 3;
        const std::uint32_t count = std::uint32_t(right - left + 1);
        const Index pivot = edges[std::size_t(left) + seed % count].lower;
        std::ptrdiff_t i = left, j = right;
        do {
            while (edges[std::size_t(i)].lower < pivot) ++i;
            while (edges[std::size_t(j)].lower > pivot) --j;
            if (i <= j) std::swap(edges[std::size_t(i++)], edges[std::size_t(j--)]);
        } while (i <= j);
        pending.push_back({left, j, seed});
        pending.push_back({i, right, seed});
    }
}

}  // namespace

std::vector<Index> c_reference_welds(const TangentInput& input, const TangentTriangles& triangles) {
    std::vector<Index> welds(input.corner_vertices.size());
    for (Index c = 0; c < welds.size(); ++c) welds[c] = c;
    const std::size_t corners = 3 * triangles.count;
    if (corners == 0) return welds;
    const CornerReader read{input};
    std::vector<Place> places;
    places.reserve(corners);
    for (std::size_t i = 0; i < corners; ++i) {
        const Index corner = triangles.corner(i / 3, i % 3);
        places.push_back({read.position(corner), corner});
    }
    const Box box(places);
    const int axis = box.longest();
    const float low = box.low[axis], high = box.high[axis];
    const auto cell_of = [&](const Place& place) {
        const float at = float(cells) * ((place.position[axis] - low) / (high - low));
        return !(at > 0) ? 0 : at >= float(cells - 1) ? cells - 1 : int(at);
    };
    std::vector<std::size_t> starts(cells + 1, 0);
    for (const Place& place : places) ++starts[std::size_t(cell_of(place)) + 1];
    for (std::size_t c = 0; c < cells; ++c) starts[c + 1] += starts[c];
    std::vector<Place> sorted(corners);
    std::vector<std::size_t> cursors(starts.begin(), starts.end() - 1);
    for (const Place& place : places) sorted[cursors[std::size_t(cell_of(place))]++] = place;
    CellMerger merger(input, welds);
    for (std::size_t c = 0; c < cells; ++c)
        if (starts[c + 1] - starts[c] > 1)
            merger.merge(std::span(sorted).subspan(starts[c], starts[c + 1] - starts[c]));
    return welds;
}

EdgeOverrides c_reference_pairs(const std::vector<Index>& welds, const TangentTriangles& triangles,
                                const ContributionStore& store) {
    const auto end_of = [&](Index half_edge) {
        return welds[triangles.corner(half_edge >> 2, half_edge & 3)];
    };
    const auto upper = [&](Index half_edge) {
        return std::max(end_of(half_edge), end_of(next_corner(half_edge)));
    };
    std::vector<HalfEdgeKey> edges;
    edges.reserve(3 * triangles.count);
    Index greatest = 0;
    for (Index t = 0; t < triangles.count; ++t) {
        if (store.flags(t) & degenerate_triangle) continue;
        for (Index k = 0; k < 3; ++k) {
            const Index half_edge = 4 * t + k;
            const Index lower = std::min(end_of(half_edge), end_of(next_corner(half_edge)));
            greatest = std::max(greatest, lower);
            edges.push_back({lower, half_edge});
        }
    }
    EdgeOverrides overrides;
    if (edges.empty()) return overrides;
    sort_around_greatest(edges, greatest);
    const auto first = std::find_if(edges.begin(), edges.end(),
                                    [&](const HalfEdgeKey& e) { return e.lower == greatest; });
    edges.erase(edges.begin(), first);

    for (std::size_t begin = 0; begin < edges.size();) {
        std::size_t end = begin + 1;
        while (end < edges.size() && upper(edges[end].half_edge) == upper(edges[begin].half_edge))
            ++end;
        if (end < edges.size())
            std::sort(edges.begin() + std::ptrdiff_t(begin), edges.begin() + std::ptrdiff_t(end),
                      [](const HalfEdgeKey& a, const HalfEdgeKey& b) {
                          return a.half_edge < b.half_edge;
                      });
        std::vector<Index> mates(end - begin, no_index);
        for (std::size_t i = begin; i < end; ++i) {
            for (std::size_t j = i + 1; j < end && mates[i - begin] == no_index; ++j) {
                const Index a = edges[i].half_edge, b = edges[j].half_edge;
                if (mates[j - begin] != no_index || end_of(a) == end_of(b)) continue;
                mates[i - begin] = b;
                mates[j - begin] = a;
            }
        }
        for (std::size_t i = begin; i < end; ++i) {
            const Index half_edge = edges[i].half_edge;
            overrides.entries.push_back({half_edge, mates[i - begin]});
        }
        begin = end;
    }
    std::sort(overrides.entries.begin(), overrides.entries.end(),
              [](const auto& a, const auto& b) { return a.half_edge < b.half_edge; });
    return overrides;
}

}  // namespace prep::detail
