#include "tessellation/displaced_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/outward.h"
#include "tessellation/displaced_triangle.h"
#include "tessellation/polygon_surface.h"

namespace prep::detail {
namespace {

template <class T>
T middle_of_extremes(const T& least, const T& greatest) {
    return 0.5 * least + 0.5 * greatest;
}

// The normalised sum of directions that differ, each once, in an order of their own. Those of one
// smooth surface differ by roundings only.
glm::dvec3 common_direction(std::vector<glm::dvec3>& sides) {
    constexpr double same = 1e-6;
    std::sort(sides.begin(), sides.end(), [](const glm::dvec3& a, const glm::dvec3& b) {
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    });
    std::vector<glm::dvec3> kept;
    for (const glm::dvec3& side : sides)
        if (std::none_of(kept.begin(), kept.end(), [&](const glm::dvec3& other) {
                return glm::dot(side - other, side - other) < same * same;
            }))
            kept.push_back(side);
    if (kept.size() == 1) return kept[0];
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& side : kept) sum += side;
    return unit_or(sum, kept.back());
}

// What may be left beside a gap, and complies.
Asked beside(double gap, Asked asked) {
    constexpr double part = 1 - 0x1p-20;  // more than rounding bounds to floats takes
    if (std::isfinite(asked.too_much))
        asked.enough = std::max(asked.enough, part * (asked.too_much - gap));
    return asked;
}

}  // namespace

DisplacedSurface::DisplacedSurface(const BaseSurface& base, const RootHeights& heights)
    : base_(base), heights_(heights) {
    if (!heights.has_noise_over_maps()) return;
    noise_heights_ = std::make_shared<const RootHeights>(heights.noise_alone());
    noise_surface_ = std::make_shared<const DisplacedSurface>(base, *noise_heights_);
}

glm::dvec3 DisplacedSurface::truth(const RootPoint& at) const {
    glm::dvec3 truth;
    truths({&at, 1}, {&truth, 1});
    return truth;
}

void DisplacedSurface::truths(std::span<const RootPoint> at, std::span<glm::dvec3> truths) const {
    constexpr std::size_t most = 64;
    std::array<BasePoint, most> points;
    for (std::size_t first = 0; first < at.size(); first += most) {
        const std::size_t count = std::min(most, at.size() - first);
        base_.evaluate(at.subspan(first, count), std::span(points).first(count));
        for (std::size_t k = 0; k < count; ++k) {
            const RootPoint& location = at[first + k];
            const BasePoint& base = points[k];
            const double height = heights_.height(location, heights_.raw(location), base.position);
            truths[first + k] =
                base.position + height * base.direction + heights_.vector(location, base.direction);
        }
    }
}

std::array<glm::dvec3, 3> DisplacedSurface::own_corners(const BisectedTriangle& triangle) const {
    const TrianglePoints points = this->points(triangle);
    std::array<RootPoint, 3> at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = points.corner(k);
    std::array<glm::dvec3, 3> own;
    truths(at, own);
    return own;
}

glm::dvec3 DisplacedSurface::normal(const BaseFrame& frame, const RootPoint& at) const {
    const Displacement* displacement = heights_.of(at.root);
    if (!displacement) return frame.normal;
    const glm::dvec2 uv = heights_.uv(at);
    const auto uv_steps = heights_.uv_steps(at.root);
    HeightFunction::Sample height;
    if (displacement->height) height = displacement->height->at(uv);
    const double h = heights_.height(at, height.value, frame.point.position);
    SpaceFunction::Sample noise;
    if (displacement->noise) noise = displacement->noise->at(frame.point.position);
    VectorFunction::Sample vector;
    if (displacement->vector) vector = displacement->vector->at(uv);
    std::array<glm::dvec3, 2> steps;
    bool moved = false;
    for (std::size_t k = 0; k < 2; ++k) {
        const glm::dvec3& dp = frame.position_steps[k];
        const double slope = displacement->scale * glm::dot(height.gradient, uv_steps[k]) +
                             glm::dot(noise.gradient, dp);
        glm::dvec3 change = slope * frame.point.direction + h * frame.direction_steps[k];
        if (displacement->vector) change += heights_.vector_step(frame, at, k, vector);
        moved = moved || change != glm::dvec3(0.0);
        steps[k] = dp - glm::dot(dp, frame.normal) * frame.normal + change;
    }
    if (!moved) return frame.normal;
    const glm::dvec3 normal = glm::cross(steps[0], steps[1]);
    const bool faces_back =
        glm::dot(glm::cross(frame.position_steps[0], frame.position_steps[1]), frame.normal) < 0;
    return unit_or(faces_back ? -normal : normal, frame.normal);
}

void DisplacedSurface::make_vertex(std::span<const RootPoint> at, std::span<const BasePoint> sides,
                                   std::uint32_t vertex, VertexSamples& samples) const {
    samples[vertex] = {};
    BasePoint point;
    double height = 0;
    glm::dvec3 vector(0.0);
    if (at.size() == 1) {
        point = sides[0];
        samples[vertex].raw = heights_.raw(at[0]);
        height = heights_.height(at[0], samples[vertex].raw, point.position);
        samples[vertex].height = height;
        vector = heights_.vector(at[0], point.direction);
    } else {
        std::vector<glm::dvec3> directions;
        glm::dvec3 low = sides[0].position, high = low;
        glm::dvec3 shortest = heights_.vector(at[0], sides[0].direction), longest = shortest;
        double least = std::numeric_limits<double>::infinity(), greatest = -least;
        for (std::size_t k = 0; k < at.size(); ++k) {
            low = glm::min(low, sides[k].position);
            high = glm::max(high, sides[k].position);
            directions.push_back(sides[k].direction);
            const double h = heights_.height(at[k], heights_.raw(at[k]), sides[k].position);
            least = std::min(least, h);
            greatest = std::max(greatest, h);
            const glm::dvec3 d = heights_.vector(at[k], sides[k].direction);
            shortest = glm::min(shortest, d);
            longest = glm::max(longest, d);
        }
        point.position = middle_of_extremes(low, high);
        point.direction = common_direction(directions);
        height = middle_of_extremes(least, greatest);
        vector = middle_of_extremes(shortest, longest);
    }
    samples[vertex].point = point;
    samples[vertex].shared = at.size() > 1;
    samples[vertex].position = glm::vec3(point.position + height * point.direction + vector);
}

DisplacedSurface::Corners DisplacedSurface::corners(const BisectedTriangle& triangle,
                                                    const std::array<glm::dvec3, 3>& weights,
                                                    const VertexSamples& samples) const {
    const auto& v = triangle.vertices;
    return corners(triangle.root, weights, {&samples[v[0]], &samples[v[1]], &samples[v[2]]});
}

DisplacedSurface::Corners DisplacedSurface::corners(
    std::uint32_t root, const std::array<glm::dvec3, 3>& weights,
    const std::array<const VertexSample*, 3>& samples, std::size_t count) const {
    Corners c;
    c.root = root;
    c.displacement = heights_.of(c.root);
    c.weights = weights;
    const bool has_vectors = c.displacement && c.displacement->vector;
    const TangentFrames* const frames = heights_.frames(c.root);
    // No less than the length, without its root.
    const auto length_above = [](const glm::dvec3& v) {
        return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
    };
    const auto squared = [](const glm::dvec3& v) { return glm::dot(v, v); };
    double gap = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const VertexSample& sample = *samples[k];
        const RootPoint at{c.root, c.weights[k]};
        c.points[k] = sample.point;
        c.raw[k] = sample.raw;
        c.heights[k] = sample.height;
        if (sample.shared) {
            base_.evaluate({&at, 1}, {&c.points[k], 1});
            c.raw[k] = heights_.raw(at);
            c.heights[k] = heights_.height(at, c.raw[k], c.points[k].position);
        }
        c.vectors[k] = has_vectors ? heights_.map_vector(at) : glm::dvec3(0.0);
        glm::dvec3 moved = c.vectors[k];
        if (frames) {
            c.frames[k] = heights_.frame(*frames, at, c.points[k].direction);
            moved = c.frames[k].axes * c.vectors[k];
            c.longest = std::max(c.longest, glm::length(moved));
        }
        const glm::dvec3 own = c.points[k].position + c.heights[k] * c.points[k].direction + moved;
        c.moved[k] = own;
        if (k < count) gap = std::max(gap, squared(glm::dvec3(sample.position) - own));
        c.size = std::max(c.size, length_above(c.points[k].position) + std::abs(c.heights[k]) +
                                      length_above(c.vectors[k]));
    }
    c.gap = std::sqrt(gap);
    double turned = 0;  // of the frames
    for (std::size_t k = 0; k < 3 && frames; ++k) {
        const std::size_t l = (k + 1) % 3;
        double squares = 0;
        for (glm::length_t axis = 0; axis < 3; ++axis)
            squares += squared(c.frames[k].axes[axis] - c.frames[l].axes[axis]);
        turned = std::max(turned, std::sqrt(squares) * glm::length(c.vectors[k] - c.vectors[l]));
    }
    if (c.displacement) {
        const HeightSpread spread = spread_of(c.heights, c.points);
        c.cross = spread.cross + turned;
        c.highest = spread.highest;
    }
    return c;
}

double DisplacedSurface::in_all(const Corners& c, const BaseDeviation& base,
                                const BesideBase& rest) {
    double sum = base.position + rest.sum;
    if (c.highest > 0) sum += c.highest * base.direction;
    if (c.longest > 0) sum += c.longest * frame_deviation(c.frames, base.direction);
    if (c.displacement && c.displacement->noise) {
        const SpaceFunction& noise = *c.displacement->noise;
        double off = rest.noise;
        if (base.position > 0) off += noise.change(base.position);
        // In this order a span that is no number is not the less.
        sum += std::min(off, noise.change(std::numeric_limits<double>::infinity()));
    }
    return sum;
}

DisplacedSurface::BesideBase DisplacedSurface::beside_base(const Corners& c, double base,
                                                           double enough) const {
    if (!c.displacement) return {};
    std::array<glm::dvec2, 3> uv;
    for (std::size_t k = 0; k < 3; ++k) uv[k] = heights_.uv({c.root, c.weights[k]});
    return beside_base(c, uv, base, enough);
}

DisplacedSurface::BesideBase DisplacedSurface::beside_base(const Corners& c,
                                                           const std::array<glm::dvec2, 3>& uv,
                                                           double base, double enough) const {
    const Displacement* const displacement = c.displacement;
    BesideBase rest;
    if (!displacement) return rest;
    const auto left = [&] { return std::max(0.0, enough - base - rest.sum); };
    rest.sum += c.cross / 3;
    const double scale = std::abs(displacement->scale);
    if (displacement->height && scale > 0)
        rest.sum += scale * displacement->height->deviation(uv, c.raw, left() / scale);
    if (displacement->vector) rest.sum += displacement->vector->deviation(uv, c.vectors, left());
    if (displacement->noise)
        rest.noise = displacement->noise->deviation(
            {c.points[0].position, c.points[1].position, c.points[2].position});
    return rest;
}

// What the height has in the middle of the edge that would be halved is no more than the bound has
// for all of the triangle, but for roundings, which the slack is more than.
std::optional<TriangleBound> DisplacedSurface::quick_bound(const BisectedTriangle& triangle,
                                                           const std::array<glm::dvec3, 3>& weights,
                                                           const VertexSamples& samples,
                                                           const Asked& asked) const {
    const Displacement* const displacement = heights_.of(triangle.root);
    if (displacement && displacement->vector) return std::nullopt;
    if (displacement && displacement->height && !displacement->noise) {
        const RootPoint middle{triangle.root, 0.5 * (weights[0] + weights[1])};
        const auto& v = triangle.vertices;
        const double off = heights_.raw(middle) - 0.5 * (samples[v[0]].raw + samples[v[1]].raw);
        if (std::abs(displacement->scale * off) * (1 - relative_slack) > asked.hopeless)
            return TriangleBound{std::numeric_limits<float>::infinity(), 0};
    }
    const auto coarse = base_.coarse_deviation(triangle.root, weights);
    if (!coarse) return std::nullopt;
    const Corners c = corners(triangle, weights, samples);
    const double base = in_all(c, *coarse, {});
    if (!(base <= asked.enough)) return std::nullopt;
    const BesideBase rest = beside_base(c, base, asked.enough);
    const double sum = in_all(c, *coarse, rest);
    // Of noise only what complies: its bound is by the triangle's size alone.
    const bool exceeds = rest.sum > asked.too_much && !(displacement && displacement->noise);
    if (sum <= asked.enough || exceeds) return c.bound(sum);
    return std::nullopt;
}

double DisplacedSurface::refinable(const Corners& c, const Asked& asked,
                                   BaseDeviation& known) const {
    // What a smaller allowance led to holds beside a smaller share of the base as well.
    double base = in_all(c, known, {});
    std::optional<BesideBase> rest;
    const auto is_hopeless = [&] { return rest->sum + rest->noise > asked.too_much; };
    if (std::isfinite(base)) {
        rest = beside_base(c, base, asked.enough);
        if (base <= small_part * asked.enough || is_hopeless())
            return bound_of(in_all(c, known, *rest));
    }
    const auto learn = [&](const BaseDeviation& found) {
        known.position = std::min(known.position, found.position);
        known.direction = std::min(known.direction, found.direction);
        base = in_all(c, known, {});
    };
    const auto tight = [&] { return base_.deviation(c.root, c.weights, c.points); };
    const auto coarse = base_.coarse_deviation(c.root, c.weights);
    learn(coarse ? *coarse : tight());
    if (!rest) rest = beside_base(c, base, asked.enough);
    if (coarse) {
        const double sum = in_all(c, known, *rest);
        const bool decides = sum <= asked.enough || is_hopeless();
        const bool is_small = asked.enough == 0 && base <= small_part * sum;
        if (!decides && !is_small) learn(tight());
    }
    return bound_of(in_all(c, known, *rest));
}

TriangleBound DisplacedSurface::bound(const BisectedTriangle& triangle,
                                      const VertexSamples& samples, const Asked& asked) const {
    if (triangle.is_closed()) return closed_bound(triangle, samples, asked);
    const Corners c = corners(triangle, path_weights(triangle.path), samples);
    const Asked left = beside(c.gap, asked);
    Whole whole{&c, c.moved, triangle.depth()};
    whole.bound = refinable(c, left, whole.base);
    double sum = whole.bound;
    if (sum > left.enough && c.displacement && c.displacement->noise) {
        std::optional<double> rough_map;
        if (c.displacement->height && !c.displacement->vector)
            rough_map = bound_of_rough_map(whole);
        if (rough_map) sum = std::min(sum, bound_noise_apart(whole, *rough_map, left));
        if (!rough_map || (sum > left.enough && sum <= near_enough * left.enough))
            sum = std::min(sum, bound_by_parts({&whole, 1}, left));
    }
    return c.bound(sum);
}

double DisplacedSurface::bound_as_one(const BisectedTriangle& closed, std::span<const Whole> roots,
                                      double enough) const {
    constexpr double none = std::numeric_limits<double>::infinity();
    const bool whole = closed.is_whole();
    const Corners &first = *roots[0].corners, &second = *roots[1].corners;
    Corners all = first;
    if (!all.displacement || heights_.frames(all.root)) return none;
    // Corners of the closed face: a whole triangle's roots each begin with one.
    const auto copy = [&](std::size_t to, const Corners& from, std::size_t k) {
        all.points[to] = from.points[k];
        all.raw[to] = from.raw[k];
        all.heights[to] = from.heights[k];
        all.vectors[to] = from.vectors[k];
    };
    copy(2, second, 1);  // a and b are those of the first
    const BasePoint& centre = first.points[2];
    std::array<glm::dvec2, 3> uv;
    uv[0] = heights_.uv({first.root, {1, 0, 0}});
    uv[1] = heights_.uv({first.root, {0, 1, 0}});
    uv[2] = heights_.uv({second.root, {0, 1, 0}});
    if (!whole) {
        const glm::dvec2 off =
            glm::abs(heights_.uv({first.root, {0, 0, 1}}) - 0.5 * (uv[0] + uv[2]));
        const glm::dvec2 size = glm::max(glm::abs(uv[0]), glm::abs(uv[2]));
        constexpr double roundings = 0x1p-50;
        if (off.x > roundings * size.x || off.y > roundings * size.y) return none;
    }
    const HeightSpread spread = spread_of(all.heights, all.points);
    all.cross = spread.cross;
    all.highest = spread.highest;
    const auto bent = [&](const glm::dvec3& at, const glm::dvec3& a, const glm::dvec3& b,
                          const glm::dvec3& c) {
        return glm::length(at - (whole ? (a + b + c) / 3.0 : 0.5 * (a + c)));
    };
    BaseDeviation base;
    for (const Whole& root : roots) {
        base.position = std::max(base.position, root.base.position);
        base.direction = std::max(base.direction, root.base.direction);
    }
    const auto& p = all.points;
    base.position += bent(centre.position, p[0].position, p[1].position, p[2].position);
    base.direction += bent(centre.direction, p[0].direction, p[1].direction, p[2].direction);
    return in_all(all, base, beside_base(all, uv, in_all(all, base, {}), enough));
}

TriangleBound DisplacedSurface::closed_bound(const BisectedTriangle& closed,
                                             const VertexSamples& samples,
                                             const Asked& asked) const {
    constexpr std::array<glm::dvec3, 3> corners_of_root{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const RootPoint at{closed.root, corners_of_root[2]};
    VertexSample centre;
    base_.evaluate({&at, 1}, {&centre.point, 1});
    centre.raw = heights_.raw(at);
    centre.height = heights_.height(at, centre.raw, centre.point.position);
    std::array<Corners, 3> parts;
    const std::size_t count = closed.is_whole() ? 3 : 2;
    // A pair's vertices are (c, a, b), and its roots begin with a.
    const std::size_t first = closed.is_whole() ? 0 : 1;
    const auto vertex = [&](std::size_t k) { return &samples[closed.vertices[k % 3]]; };
    std::uint32_t root = closed.root;
    glm::dvec3 flat(0.0);
    double gap = 0, size = 0;
    for (std::size_t k = 0; k < count; ++k) {
        parts[k] =
            corners(root, corners_of_root, {vertex(first + k), vertex(first + k + 1), &centre}, 2);
        root = heights_.domain().next_root(root);
        gap = std::max(gap, parts[k].gap);
        size = std::max(size, parts[k].size);
    }
    if (closed.is_whole())
        flat = (parts[0].moved[0] + parts[1].moved[0] + parts[2].moved[0]) / 3.0;
    else
        flat = 0.5 * (parts[0].moved[0] + parts[1].moved[1]);
    double bend = bound_of(glm::length(parts[0].moved[2] - flat));
    // Roundings of points, which every bound has room for.
    if (bend <= 0.25 * absolute_slack * size) bend = 0;
    // Single points, the centre and the edges' middles, may show that the face has to be opened.
    double farthest = bend;
    for (std::size_t k = 0; k < count && std::isfinite(asked.hopeless); ++k) {
        const glm::dvec3 middle = truth({parts[k].root, {0.5, 0.5, 0}});
        const glm::dvec3 linear = 0.5 * (parts[k].moved[0] + parts[k].moved[1]);
        farthest = std::max(farthest, glm::length(middle - linear));
    }
    if (farthest * (1 - relative_slack) > asked.hopeless)
        return TriangleBound{std::numeric_limits<float>::infinity(), 0};

    const Asked left = beside(gap, asked);
    const Asked of_roots{std::max(0.0, left.enough - bend), left.too_much - bend};
    std::array<Whole, 3> wholes;
    double sum = bend;
    for (std::size_t k = 0; k < count; ++k) {
        const Corners& part = parts[k];
        Whole& whole = wholes[k] = {&part, {part.moved[0], part.moved[1], flat}};
        whole.bound = refinable(part, of_roots, whole.base);
        sum = std::max(sum, bend + whole.bound);
    }
    const std::span<const Whole> roots = std::span(wholes).first(count);
    if (sum > left.enough)
        sum = std::min(sum, std::max(bend, bound_as_one(closed, roots, left.enough)));
    const bool noise = parts[0].displacement && parts[0].displacement->noise;
    if (sum > left.enough && (noise || sum <= near_enough * left.enough))
        sum = std::min(sum, bound_by_parts(roots, left));
    parts[0].gap = gap;
    parts[0].size = size;
    return parts[0].bound(sum);
}

}  // namespace prep::detail
