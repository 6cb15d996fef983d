// Bounds by parts (displaced_surface.h), and by noise apart from the map under it.
#include <algorithm>
#include <cmath>
#include <vector>

#include "tessellation/displaced_triangle.h"

namespace prep::detail {
namespace {

// A map's deviation over a fourth of a triangle is a fourth of that over all of it where the map
// bends evenly, and as large where it is rough. With half instead, smooth maps took up to 17 % more
// triangles, with 0.9 rough ones half as much time again (NoisePartsDoNotReadRoughMaps, and
// NoiseOverSmoothMapsIsBoundedAsClosely).
constexpr double rough_share = 0.75;

}  // namespace

double DisplacedSurface::bound_by_parts(std::span<const Whole> wholes, const Asked& asked) const {
    const bool noise = wholes[0].corners->displacement && wholes[0].corners->displacement->noise;
    // Where nothing is enough triangles are to be put in an order, no more.
    const double close = asked.enough > 0 ? 1.0625 : 1.125;
    // Noise is bounded by the parts' size alone; bounds of what else there is are mostly close.
    const std::size_t most_parts = noise ? 256 : 32;
    struct Node {
        glm::dvec3 weights, linear;
        VertexSample sample;
        double off = 0;
    };
    struct Part {
        std::uint32_t root = 0;
        int depth = 0;
        std::array<std::uint32_t, 3> nodes{};
        double upper = 0;
        BaseDeviation of_parts;  // what bounds the base over each part of it
        bool operator<(const Part& other) const { return upper < other.upper; }
    };
    thread_local std::vector<Node> nodes;
    thread_local std::vector<Part> parts;
    nodes.clear();
    parts.clear();
    nodes.reserve(3 * wholes.size() + most_parts);
    parts.reserve(wholes.size() + most_parts);
    double lower = 0, size = 0;
    const auto goal = [&] {
        // No less than what every bound has for roundings.
        return std::max({asked.enough, close * lower, 16 * absolute_slack * size});
    };
    // Whatever is this far at most from what is linear over a triangle is at most twice as far from
    // what is linear over any part of it.
    const auto doubled = [](const BaseDeviation& base) {
        return BaseDeviation{2 * base.position, 2 * base.direction};
    };
    for (const Whole& whole : wholes) {
        const Corners& c = *whole.corners;
        Part part{c.root, whole.depth, {}, 0, doubled(whole.base)};
        for (std::size_t k = 0; k < 3; ++k) {
            part.nodes[k] = std::uint32_t(nodes.size());
            nodes.push_back({c.weights[k],
                             whole.linear[k],
                             {c.points[k], c.raw[k], c.heights[k], glm::vec3(0.0F), false},
                             bound_of(glm::length(c.moved[k] - whole.linear[k]))});
            part.upper = std::max(part.upper, nodes.back().off);
        }
        lower = std::max(lower, part.upper);
        size = std::max(size, c.size);
        part.upper += whole.bound;
        parts.push_back(part);
    }
    std::make_heap(parts.begin(), parts.end());
    const auto add = [&](const Part& of, const std::array<std::uint32_t, 3>& corner_nodes) {
        Part part{of.root, of.depth + 1, corner_nodes, 0, of.of_parts};
        std::array<glm::dvec3, 3> weights;
        std::array<const VertexSample*, 3> samples;
        for (std::size_t k = 0; k < 3; ++k) {
            const Node& node = nodes[part.nodes[k]];
            weights[k] = node.weights;
            samples[k] = &node.sample;
            part.upper = std::max(part.upper, node.off);
        }
        const double left = std::max(0.0, goal() - part.upper);
        BaseDeviation base = of.of_parts;
        part.upper += refinable(corners(part.root, weights, samples, 0), {left, left}, base);
        part.of_parts.position = std::min(part.of_parts.position, 2 * base.position);
        part.of_parts.direction = std::min(part.of_parts.direction, 2 * base.direction);
        parts.push_back(part);
        std::push_heap(parts.begin(), parts.end());
    };
    const auto is_decided = [&] { return parts.front().upper <= goal() || lower > asked.too_much; };
    while (!is_decided() && parts.size() < most_parts && parts.front().depth < deepest_bisection) {
        std::pop_heap(parts.begin(), parts.end());
        const Part worst = parts.back();
        parts.pop_back();
        const Node &a = nodes[worst.nodes[0]], &b = nodes[worst.nodes[1]];
        Node node;
        node.weights = 0.5 * (a.weights + b.weights);
        node.linear = 0.5 * (a.linear + b.linear);
        const RootPoint at{worst.root, node.weights};
        BasePoint& point = node.sample.point;
        base_.evaluate({&at, 1}, {&point, 1});
        node.sample.raw = heights_.raw(at);
        node.sample.height = heights_.height(at, node.sample.raw, point.position);
        node.off = bound_of(glm::length(point.position + node.sample.height * point.direction +
                                        heights_.vector(at, point.direction) - node.linear));
        lower = std::max(lower, node.off);
        const auto middle = std::uint32_t(nodes.size());
        nodes.push_back(node);
        add(worst, {worst.nodes[2], worst.nodes[0], middle});
        add(worst, {worst.nodes[1], worst.nodes[2], middle});
    }
    return parts.front().upper;
}

std::optional<double> DisplacedSurface::bound_of_rough_map(const Whole& whole) const {
    const Corners& c = *whole.corners;
    const Displacement& displacement = *c.displacement;
    const auto deviation = [&](const std::array<glm::dvec3, 3>& weights) {
        std::array<glm::dvec2, 3> uv;
        std::array<double, 3> raw;
        for (std::size_t k = 0; k < 3; ++k) {
            const RootPoint at{c.root, weights[k]};
            uv[k] = heights_.uv(at);
            raw[k] = heights_.raw(at);
        }
        return std::abs(displacement.scale) * displacement.height->deviation(uv, raw, 0);
    };
    std::array<double, 3> heights;
    for (std::size_t k = 0; k < 3; ++k)
        heights[k] = displacement.scale * (c.raw[k] - displacement.midlevel);
    const HeightSpread spread = spread_of(heights, c.points);
    // What the map is moved along, which parts do have less of.
    double beside = spread.cross / 3;
    if (spread.highest > 0) beside += spread.highest * whole.base.direction;
    const auto& w = c.weights;
    const double of_all = deviation(w);
    if (!(of_all >= beside && of_all > small_part * whole.bound)) return std::nullopt;
    const std::array<glm::dvec3, 3> m{0.5 * (w[0] + w[1]), 0.5 * (w[1] + w[2]),
                                      0.5 * (w[2] + w[0])};
    const double smooth = rough_share * of_all;
    const bool is_rough =
        deviation({w[0], m[0], m[2]}) > smooth || deviation({m[0], w[1], m[1]}) > smooth ||
        deviation({m[2], m[1], w[2]}) > smooth || deviation({m[0], m[1], m[2]}) > smooth;
    return is_rough ? std::optional(of_all + beside) : std::nullopt;
}

double DisplacedSurface::bound_noise_apart(const Whole& whole, double of_map,
                                           const Asked& asked) const {
    const Corners& c = *whole.corners;
    const Asked left{std::max(0.0, asked.enough - of_map), asked.too_much, asked.hopeless};
    std::array<VertexSample, 3> samples;
    for (VertexSample& sample : samples) sample.shared = true;  // made anew
    const Corners own =
        noise_surface_->corners(c.root, c.weights, {&samples[0], &samples[1], &samples[2]}, 0);
    Whole noise{&own, own.moved, whole.depth};
    noise.base = whole.base;
    noise.bound = noise_surface_->refinable(own, left, noise.base);
    double of_noise = noise.bound;
    if (of_noise > left.enough)
        of_noise = std::min(of_noise, noise_surface_->bound_by_parts({&noise, 1}, left));
    return bound_of(of_map + of_noise);
}

}  // namespace prep::detail
