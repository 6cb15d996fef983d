// Gradient noise on the integer lattice (Perlin 2002: "Improving noise") and on the simplex lattice
// (Perlin 2001; Gustavson 2005: "Simplex noise demystified"), and sums of octaves.
//
// Deviations: gradients are picked by a 64-bit hash of lattice point and seed, from the twelve
// edges of a cube with equal chances, so that nothing repeats and any seed is another noise. The
// simplex kernel is (½ − r²)⁴: Gustavson's 0.6 reaches over the faces of simplices, where the sum
// of four corners then jumps.
//
// Bounds. With w a corner's weight, g its gradient and d the way from it, a corner adds w g·d to
// the value, g·d ∇w + w g to the gradient and g·d ∇∇w + ∇w gᵀ + g ∇wᵀ to the second derivatives.
// Corners are independent, so the sum over corners of the largest length (Frobenius norm) that any
// of the twelve gradients makes is a bound at a point, and its supremum over a cell, or a simplex
// (all others are turned over by swaps of axes, under which the twelve are the same), one
// everywhere. The suprema are 1.0364, 5.49 and 25.8, and for simplex noise 0.01304, 0.0915 and
// 1.133 before its factor; the constants below leave room for a proof by interval arithmetic over
// the whole cell that takes a second (the test `NoiseBounds.HoldOverTheWholeCell`).
#include "displacement/noise_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace prep::detail {
namespace {

struct KindBounds {
    double value, gradient, second;
};
constexpr double simplex_factor = 72;

KindBounds bounds_of(NoiseKind kind) {
    if (kind == NoiseKind::perlin) return {1.1, 6.0, 29.0};
    return {1.0, 7.5, 95.0};
}

// Splitmix64's last steps (Steele, Lea and Flood 2014).
std::uint64_t mixed(std::uint64_t h) {
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

std::uint64_t hash(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t seed) {
    constexpr std::uint64_t golden = 0x9e3779b97f4a7c15u;
    std::uint64_t h = mixed(seed + golden);
    h = mixed(h + golden * std::uint64_t(x));
    h = mixed(h + golden * std::uint64_t(y));
    return mixed(h + golden * std::uint64_t(z));
}

glm::dvec3 gradient_at(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t seed) {
    static constexpr std::int8_t edges[12][3] = {{1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0},
                                                 {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
                                                 {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}};
    const auto& e = edges[((hash(x, y, z, seed) >> 32) * 12) >> 32];
    return {double(e[0]), double(e[1]), double(e[2])};
}

// Beyond this many cells there is too little left of a double for a cell's inside: no noise there.
constexpr double farthest_cell = 0x1p40;

NoiseSample perlin(const glm::dvec3& p, std::uint64_t seed) {
    const glm::dvec3 cell = glm::floor(p), f = p - cell;
    const glm::dvec3 fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    const glm::dvec3 slope = 30.0 * f * f * (f - 1.0) * (f - 1.0);
    const std::int64_t x = std::int64_t(cell.x), y = std::int64_t(cell.y), z = std::int64_t(cell.z);
    NoiseSample sum;
    for (int corner = 0; corner < 8; ++corner) {
        const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
        const glm::dvec3 g = gradient_at(x + i, y + j, z + k, seed);
        const double dot = glm::dot(g, f - glm::dvec3(i, j, k));
        const glm::dvec3 w(i ? fade.x : 1 - fade.x, j ? fade.y : 1 - fade.y,
                           k ? fade.z : 1 - fade.z);
        const glm::dvec3 s(i ? slope.x : -slope.x, j ? slope.y : -slope.y, k ? slope.z : -slope.z);
        const double weight = w.x * w.y * w.z;
        sum.value += weight * dot;
        sum.gradient +=
            weight * g + dot * glm::dvec3(s.x * w.y * w.z, w.x * s.y * w.z, w.x * w.y * s.z);
    }
    return sum;
}

NoiseSample simplex(const glm::dvec3& p, std::uint64_t seed) {
    const double skew = (p.x + p.y + p.z) / 3;
    const glm::dvec3 cell = glm::floor(p + skew);
    const glm::dvec3 origin = cell - (cell.x + cell.y + cell.z) / 6;
    const glm::dvec3 d0 = p - origin;
    // The corners on the way from the cell's first to its last, along the longest way first.
    glm::ivec3 order(0, 1, 2);
    if (d0[order[0]] < d0[order[1]]) std::swap(order[0], order[1]);
    if (d0[order[1]] < d0[order[2]]) std::swap(order[1], order[2]);
    if (d0[order[0]] < d0[order[1]]) std::swap(order[0], order[1]);
    const std::int64_t x = std::int64_t(cell.x), y = std::int64_t(cell.y), z = std::int64_t(cell.z);
    glm::ivec3 steps(0);
    NoiseSample sum;
    for (int corner = 0; corner < 4; ++corner) {
        if (corner > 0) steps[order[corner - 1]] = 1;
        const glm::dvec3 d = d0 - glm::dvec3(steps) + double(corner) / 6;
        const double t = 0.5 - glm::dot(d, d);
        if (t <= 0) continue;
        const glm::dvec3 g = gradient_at(x + steps.x, y + steps.y, z + steps.z, seed);
        const double dot = glm::dot(g, d), t3 = t * t * t;
        sum.value += simplex_factor * t * t3 * dot;
        sum.gradient += simplex_factor * t3 * (t * g - 8.0 * dot * d);
    }
    return sum;
}

NoiseSample noise(NoiseKind kind, const glm::dvec3& p, std::uint64_t seed) {
    // NaN included.
    if (!(std::abs(p.x) < farthest_cell) || !(std::abs(p.y) < farthest_cell) ||
        !(std::abs(p.z) < farthest_cell))
        return {};
    return kind == NoiseKind::perlin ? perlin(p, seed) : simplex(p, seed);
}

// Of an octave what samples so far apart carry: from 1/(4 spacing) to 1/(2 spacing) it fades out.
double carried(double frequency, double spacing) {
    if (!(spacing > 0)) return 1;
    const double beyond = std::clamp(4 * spacing * std::abs(frequency) - 1, 0.0, 1.0);
    return 1 - beyond * beyond * (3 - 2 * beyond);
}

// Calls visit(octave's seed, frequency, amplitude), but for those of which nothing is carried.
template <class Visit>
void over_octaves(const NoiseOptions& options, const Visit& visit) {
    double frequency = options.frequency, amplitude = options.scale;
    for (int i = 0; i < options.octaves; ++i) {
        const double part = carried(frequency, options.sample_spacing);
        if (part > 0) visit((std::uint64_t(i) << 32) + options.seed, frequency, part * amplitude);
        frequency *= options.lacunarity;
        amplitude *= options.gain;
    }
}

// Of the smallest circle around a triangle, squared: nothing linear inside is further from what is
// linear in its corners than half the second derivatives times this (Waldron 1998).
double circle_around(const std::array<glm::dvec3, 3>& p) {
    const auto squared = [](const glm::dvec3& v) { return glm::dot(v, v); };
    double a = squared(p[1] - p[2]), b = squared(p[2] - p[0]), c = squared(p[0] - p[1]);
    if (a < b) std::swap(a, b);
    if (a < c) std::swap(a, c);
    if (a >= b + c) return 0.25 * a;
    const double area = squared(glm::cross(p[1] - p[0], p[2] - p[0]));
    return std::min(a / 3 * (1 + 0x1p-40), a * b * c / (4 * area));
}

struct TriangleNode {
    double upper = 0;
    std::array<glm::dvec3, 3> p;
    std::array<double, 3> linear, off;  // off: the noise minus what is linear
};

bool smaller(const TriangleNode& a, const TriangleNode& b) {
    return a.upper < b.upper;
}

}  // namespace

Result<NoiseField> NoiseField::make(const NoiseOptions& options) {
    for (const double number : {options.frequency, options.lacunarity, options.gain, options.scale,
                                options.midlevel, options.sample_spacing})
        if (!std::isfinite(number))
            return Error{ErrorCode::invalid, "the numbers of a noise must be finite", ""};
    if (options.sample_spacing < 0)
        return Error{ErrorCode::invalid, "a noise's spacing of samples must not be negative", ""};
    constexpr int most_octaves = 32;
    if (options.octaves < 1 || options.octaves > most_octaves)
        return Error{ErrorCode::invalid,
                     fmt::format("{} octaves of noise are asked for; 1 to {} can be had",
                                 options.octaves, most_octaves),
                     ""};
    // What a sum of squares of second derivatives still holds.
    constexpr double largest = 1e60;
    double most = std::abs(options.midlevel * options.scale);
    over_octaves(options, [&](std::uint64_t, double frequency, double amplitude) {
        most = std::max({most, std::abs(amplitude), std::abs(frequency),
                         std::abs(amplitude) * frequency * frequency});
    });
    if (!(most <= largest))
        return Error{
            ErrorCode::invalid,
            fmt::format("{} octaves of this noise reach numbers beyond {:g}; take fewer, or "
                        "a smaller lacunarity or gain",
                        options.octaves, largest),
            ""};
    return NoiseField(options);
}

NoiseSample NoiseField::sample(const glm::dvec3& p) const {
    NoiseSample sum;
    sum.value = -options_.midlevel * options_.scale;
    over_octaves(options_, [&](std::uint64_t seed, double frequency, double amplitude) {
        const NoiseSample octave = noise(options_.kind, p * frequency, seed);
        sum.value += amplitude * octave.value;
        sum.gradient += amplitude * frequency * octave.gradient;
    });
    return sum;
}

Interval NoiseField::range() const {
    const double bound = bounds_of(options_.kind).value,
                 middle = options_.midlevel * options_.scale;
    double sum = 0;
    over_octaves(options_, [&](std::uint64_t, double, double amplitude) {
        sum += bound * std::abs(amplitude);
    });
    const double slack = (sum + std::abs(middle)) * 0x1p-48;
    return {-sum - middle - slack, sum - middle + slack};
}

double NoiseField::steepest() const {
    double sum = 0;
    over_octaves(options_, [&](std::uint64_t, double frequency, double amplitude) {
        sum += std::abs(amplitude * frequency);
    });
    return bounds_of(options_.kind).gradient * sum * (1 + 0x1p-48);
}

double NoiseField::curvature() const {
    double sum = 0;
    over_octaves(options_, [&](std::uint64_t, double frequency, double amplitude) {
        sum += std::abs(amplitude) * frequency * frequency;
    });
    return bounds_of(options_.kind).second * sum * (1 + 0x1p-48);
}

Deviation NoiseField::deviation(const std::array<glm::dvec3, 3>& p,
                                const std::array<double, 3>& values, double enough,
                                std::uint32_t effort) const {
    const KindBounds bounds = bounds_of(options_.kind);
    const Interval all = range();
    double farthest_out = 0, largest = std::max(std::abs(all.low), std::abs(all.high));
    bool plain = true, near = true;
    for (std::size_t k = 0; k < 3; ++k) {
        plain &= std::isfinite(values[k]);
        largest = std::max(largest, std::abs(values[k]));
        for (int axis = 0; axis < 3; ++axis) {
            near &= std::isfinite(p[k][axis]);
            farthest_out = std::max(farthest_out, std::abs(p[k][axis]));
        }
    }
    if (!plain) return {std::numeric_limits<double>::infinity(), 0};
    double rounding = largest * 0x1p-44;
    over_octaves(options_, [&](std::uint64_t, double frequency, double amplitude) {
        near &= std::abs(frequency) * farthest_out < farthest_cell;
        rounding += bounds.gradient * std::abs(amplitude * frequency) * farthest_out * 0x1p-48;
    });

    const auto [least, most] = std::minmax({values[0], values[1], values[2]});
    const double anywhere = std::max(all.high - least, most - all.low);
    if (!near) return {anywhere, 0};

    // How far all octaves together may leave their own linear interpolants inside a triangle.
    const auto inside = [&](const std::array<glm::dvec3, 3>& corners) {
        const double half = 0.5 * circle_around(corners);
        double sum = 0;
        over_octaves(options_, [&](std::uint64_t, double frequency, double amplitude) {
            sum += std::abs(amplitude) *
                   std::min(bounds.second * frequency * frequency * half, 2 * bounds.value);
        });
        return sum;
    };
    double lower = 0, settled = 0;
    std::uint32_t nodes = 0;
    std::vector<TriangleNode> heap;
    const auto threshold = [&] { return std::max(enough, 1.1 * lower); };
    const auto add = [&](TriangleNode& node) {
        ++nodes;
        double corner = 0;
        for (const double off : node.off) corner = std::max(corner, std::abs(off));
        const auto [low, high] = std::minmax({node.linear[0], node.linear[1], node.linear[2]});
        node.upper = std::min(corner + inside(node.p), std::max(all.high - low, high - all.low));
        lower = std::max(lower, corner);
        if (node.upper <= threshold()) {
            settled = std::max(settled, node.upper);
            return;
        }
        heap.push_back(node);
        std::push_heap(heap.begin(), heap.end(), smaller);
    };
    TriangleNode root{0, p, values, {}};
    for (std::size_t k = 0; k < 3; ++k) root.off[k] = value(p[k]) - values[k];
    add(root);
    while (!heap.empty() && heap.front().upper > threshold() && nodes < effort) {
        std::pop_heap(heap.begin(), heap.end(), smaller);
        const TriangleNode node = heap.back();
        heap.pop_back();
        // Across the longest side: triangles of any shape get rounder.
        std::size_t side = 0;
        double longest = -1;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 along = node.p[(k + 1) % 3] - node.p[k];
            const double length = glm::dot(along, along);
            if (length > longest) {
                longest = length;
                side = k;
            }
        }
        const std::size_t a = side, b = (side + 1) % 3;
        const glm::dvec3 middle = 0.5 * (node.p[a] + node.p[b]);
        const double linear = 0.5 * (node.linear[a] + node.linear[b]);
        const double off = value(middle) - linear;
        for (const std::size_t moved : {a, b}) {
            TriangleNode half = node;
            half.p[moved] = middle;
            half.linear[moved] = linear;
            half.off[moved] = off;
            add(half);
        }
    }
    const double found = heap.empty() ? 0.0 : heap.front().upper;
    const double upper = std::max(found, settled) + rounding;
    return {upper, std::min(lower, upper)};
}

}  // namespace prep::detail
