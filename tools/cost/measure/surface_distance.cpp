#include "cost/measure/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

namespace cost {
namespace {

constexpr double far_away = std::numeric_limits<double>::infinity();

glm::dvec3 nearest_of_segment(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p) {
    const glm::dvec3 along = b - a;
    const double squared = glm::dot(along, along);
    if (!(squared > 0)) return a;
    return a + std::clamp(glm::dot(p - a, along) / squared, 0.0, 1.0) * along;
}

struct Box {
    glm::dvec3 low{far_away}, high{-far_away};
    void add(const glm::dvec3& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    double squared_distance(const glm::dvec3& p) const {
        const glm::dvec3 d = glm::max(glm::max(low - p, p - high), glm::dvec3(0.0));
        return glm::dot(d, d);
    }
};

// Boxes in boxes over triangles, halved at the middle of the longest side.
class TriangleTree {
  public:
    explicit TriangleTree(std::span<const Triangle> triangles) : triangles_(triangles) {
        order_.resize(triangles.size());
        std::iota(order_.begin(), order_.end(), 0u);
        middles_.reserve(triangles.size());
        for (const Triangle& t : triangles) middles_.push_back((t[0] + t[1] + t[2]) / 3.0);
        if (!order_.empty()) build(0, std::uint32_t(order_.size()));
    }

    struct Nearest {
        double distance = far_away;
        std::uint32_t triangle = 0;
        std::uint64_t looks = 0;
    };
    Nearest nearest(const glm::dvec3& p, std::uint32_t guess) const {
        Nearest best;
        if (nodes_.empty()) return best;
        double squared = far_away;
        const auto look = [&](std::uint32_t t) {
            ++best.looks;
            const glm::dvec3 d = nearest_point(triangles_[t], p) - p;
            const double s = glm::dot(d, d);
            if (s < squared || (s == squared && t < best.triangle)) {
                squared = s;
                best.triangle = t;
            }
        };
        look(guess);
        std::uint32_t stack[64];
        std::size_t height = 0;
        stack[height++] = 0;
        while (height > 0) {
            const Node& node = nodes_[stack[--height]];
            if (node.box.squared_distance(p) > squared) continue;
            if (node.count > 0) {
                for (std::uint32_t i = 0; i < node.count; ++i) look(order_[node.first + i]);
                continue;
            }
            const std::uint32_t left = node.first, right = node.second;
            const bool left_first =
                nodes_[left].box.squared_distance(p) <= nodes_[right].box.squared_distance(p);
            stack[height++] = left_first ? right : left;
            stack[height++] = left_first ? left : right;
        }
        best.distance = std::sqrt(squared);
        return best;
    }

  private:
    struct Node {
        Box box;
        std::uint32_t first = 0, second = 0, count = 0;  // children, or triangles where count > 0
    };

    // Halves by number: at most 32 levels, whatever the triangles.
    std::uint32_t build(std::uint32_t begin, std::uint32_t end) {
        const auto index = std::uint32_t(nodes_.size());
        nodes_.emplace_back();
        Box box, of_middles;
        for (std::uint32_t i = begin; i < end; ++i) {
            for (const glm::dvec3& p : triangles_[order_[i]]) box.add(p);
            of_middles.add(middles_[order_[i]]);
        }
        nodes_[index].box = box;
        if (end - begin <= 4) {
            nodes_[index].first = begin;
            nodes_[index].count = end - begin;
            return index;
        }
        const glm::dvec3 size = of_middles.high - of_middles.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::uint32_t middle = begin + (end - begin) / 2;
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                         [&](std::uint32_t a, std::uint32_t b) {
                             const double u = middles_[a][axis], v = middles_[b][axis];
                             return u != v ? u < v : a < b;
                         });
        const std::uint32_t left = build(begin, middle), right = build(middle, end);
        nodes_[index].first = left;
        nodes_[index].second = right;
        return index;
    }

    std::span<const Triangle> triangles_;
    std::vector<std::uint32_t> order_;
    std::vector<glm::dvec3> middles_;
    std::vector<Node> nodes_;
};

// A triangle of `from`, or a part of one.
struct Piece {
    double bound = 0;  // no point of it is farther away
    Triangle corners;
    std::uint32_t triangle = 0, nearest = 0;
    bool operator<(const Piece& other) const {
        return bound != other.bound ? bound < other.bound : triangle > other.triangle;
    }
};

// The largest distance of a corner bounds that of the whole, since the distance to a triangle,
// which is convex, is a convex function.
double bound_by(const Triangle& piece, const Triangle& other) {
    double largest = 0;
    for (const glm::dvec3& p : piece)
        largest = std::max(largest, glm::distance(p, nearest_point(other, p)));
    return largest;
}

class Search {
  public:
    Search(std::span<const Triangle> to, const DistanceOptions& options)
        : to_(to), tree_(to), options_(options) {}

    // The triangle that is nearest to a corner, near which the next piece may lie.
    std::uint32_t add(const Triangle& corners, std::uint32_t triangle, std::uint32_t guess,
                      double parent) {
        ++found_.pieces;
        Piece piece{far_away, corners, triangle, guess};
        if (looks_ >= options_.most_looks) {  // no nearest one is sought any more
            piece.bound = std::min(bound_by(corners, to_[guess]), parent);
            if (piece.bound > found_.low) open_.push(piece);
            return guess;
        }
        const glm::dvec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        double reach = 0;
        for (const glm::dvec3& p : corners) reach = std::max(reach, glm::distance(p, middle));
        const auto ask = [&](const glm::dvec3& p) {
            const TriangleTree::Nearest nearest = tree_.nearest(p, piece.nearest);
            looks_ += nearest.looks;
            piece.nearest = nearest.triangle;
            piece.bound = std::min(piece.bound, bound_by(corners, to_[nearest.triangle]));
            if (nearest.distance > found_.low) {
                found_.low = nearest.distance;
                found_.at = p;
                found_.triangle = triangle;
            }
            return nearest.distance;
        };
        // No point is farther away than its way to the middle and the middle's own.
        const double of_middle = ask(middle);
        for (const glm::dvec3& p : corners) ask(p);
        piece.bound = std::min({piece.bound, of_middle + reach, parent});
        if (piece.bound > found_.low) open_.push(piece);
        return piece.nearest;
    }

    SurfaceDistance finish() {
        while (!open_.empty()) {
            const Piece piece = open_.top();
            found_.high = std::max(found_.low, piece.bound);
            const bool near = found_.high - found_.low <= options_.tolerance;
            if (found_.high <= options_.enough ||
                (near && (found_.low > options_.enough || options_.enough <= 0)))
                return found_;
            if (found_.pieces >= options_.most_pieces || looks_ >= options_.most_looks) {
                found_.complete = false;
                return found_;
            }
            open_.pop();
            // Halved at the middle of the longest side.
            std::size_t longest = 0;
            double length = -1;
            for (std::size_t i = 0; i < 3; ++i) {
                const double l = glm::distance(piece.corners[i], piece.corners[(i + 1) % 3]);
                if (l > length) {
                    length = l;
                    longest = i;
                }
            }
            const std::size_t i = longest, j = (i + 1) % 3;
            const glm::dvec3 half = (piece.corners[i] + piece.corners[j]) * 0.5;
            // Halves that are no smaller any more: doubles end here.
            if (half == piece.corners[i] || half == piece.corners[j]) {
                stuck_ = std::max(stuck_, piece.bound);
                continue;
            }
            Triangle first = piece.corners, second = piece.corners;
            first[j] = half;
            second[i] = half;
            add(first, piece.triangle, piece.nearest, piece.bound);
            add(second, piece.triangle, piece.nearest, piece.bound);
        }
        found_.high = std::max(found_.low, stuck_);
        return found_;
    }

  private:
    std::span<const Triangle> to_;
    TriangleTree tree_;
    DistanceOptions options_;
    SurfaceDistance found_;
    double stuck_ = 0;
    std::uint64_t looks_ = 0;
    std::priority_queue<Piece> open_;
};

}  // namespace

glm::dvec3 nearest_point(const Triangle& triangle, const glm::dvec3& p) {
    const glm::dvec3 u = triangle[1] - triangle[0], v = triangle[2] - triangle[0];
    const glm::dvec3 normal = glm::cross(u, v);
    const double area = glm::dot(normal, normal);
    // Thinner ones are their edges, but for 1e-12 of their length: the normal has no digits left.
    if (area > 1e-24 * glm::dot(u, u) * glm::dot(v, v)) {
        // Where p falls on the plane, as shares of the corners.
        const glm::dvec3 w = p - triangle[0];
        const double b = glm::dot(glm::cross(w, v), normal) / area;
        const double c = glm::dot(glm::cross(u, w), normal) / area;
        if (b >= 0 && c >= 0 && b + c <= 1) return triangle[0] + b * u + c * v;
    }
    glm::dvec3 best = triangle[0];
    double squared = far_away;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 q = nearest_of_segment(triangle[i], triangle[(i + 1) % 3], p);
        const double s = glm::dot(q - p, q - p);
        if (s < squared) {
            squared = s;
            best = q;
        }
    }
    return best;
}

SurfaceDistance one_sided_distance(std::span<const Triangle> from, std::span<const Triangle> to,
                                   const DistanceOptions& options) {
    if (from.empty()) return {};
    if (to.empty()) {
        SurfaceDistance none;
        none.low = none.high = far_away;
        none.at = from[0][0];
        return none;
    }
    Search search(to, options);
    std::uint32_t guess = 0;
    for (std::uint32_t t = 0; t < from.size(); ++t) guess = search.add(from[t], t, guess, far_away);
    return search.finish();
}

}  // namespace cost
