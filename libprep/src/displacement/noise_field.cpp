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
#include <array>
#include <cmath>

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

// Of a lattice point, coordinate by coordinate: what points share is mixed once.
std::uint64_t hash_along(std::uint64_t before, std::int64_t coordinate) {
    constexpr std::uint64_t golden = 0x9e3779b97f4a7c15u;
    return mixed(before + golden * std::uint64_t(coordinate));
}
std::uint64_t hash_of(std::uint64_t seed) {
    return hash_along(seed, 1);
}

glm::dvec3 gradient_of(std::uint64_t hash) {
    static constexpr std::int8_t edges[12][3] = {{1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0},
                                                 {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
                                                 {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}};
    const auto& e = edges[((hash >> 32) * 12) >> 32];
    return {double(e[0]), double(e[1]), double(e[2])};
}

// Beyond this many cells there is too little left of a double for a cell's inside: no noise there.
constexpr double farthest_cell = 0x1p40;

NoiseSample perlin(const glm::dvec3& p, std::uint64_t seed) {
    const glm::dvec3 cell = glm::floor(p), f = p - cell;
    const glm::dvec3 fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    const glm::dvec3 slope = 30.0 * f * f * (f - 1.0) * (f - 1.0);
    const std::int64_t x = std::int64_t(cell.x), y = std::int64_t(cell.y), z = std::int64_t(cell.z);
    const std::uint64_t start = hash_of(seed);
    std::array<std::uint64_t, 4> columns;  // i + 2 j
    for (int i = 0; i < 2; ++i) {
        const std::uint64_t plane = hash_along(start, x + i);
        for (int j = 0; j < 2; ++j) columns[std::size_t(i + 2 * j)] = hash_along(plane, y + j);
    }
    NoiseSample sum;
    for (int corner = 0; corner < 8; ++corner) {
        const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
        const glm::dvec3 g = gradient_of(hash_along(columns[std::size_t(corner & 3)], z + k));
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
    const std::uint64_t start = hash_of(seed);
    NoiseSample sum;
    for (int corner = 0; corner < 4; ++corner) {
        if (corner > 0) steps[order[corner - 1]] = 1;
        const glm::dvec3 d = d0 - glm::dvec3(steps) + double(corner) / 6;
        const double t = 0.5 - glm::dot(d, d);
        if (t <= 0) continue;
        const std::uint64_t column = hash_along(hash_along(start, x + steps.x), y + steps.y);
        const glm::dvec3 g = gradient_of(hash_along(column, z + steps.z));
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

// Calls visit(octave's number, frequency, amplitude, the part of it that is carried).
template <class Visit>
void over_parts(const NoiseOptions& options, const Visit& visit) {
    double frequency = options.frequency, amplitude = options.scale;
    for (int i = 0; i < options.octaves; ++i) {
        visit(i, frequency, amplitude, carried(frequency, options.sample_spacing));
        frequency *= options.lacunarity;
        amplitude *= options.gain;
    }
}
// Calls visit(octave's seed, frequency, amplitude), but for those of which nothing is carried.
template <class Visit>
void over_octaves(const NoiseOptions& options, const Visit& visit) {
    over_parts(options, [&](int i, double frequency, double amplitude, double part) {
        if (part > 0) visit((std::uint64_t(i) << 32) + options.seed, frequency, part * amplitude);
    });
}

// The squared radius of the smallest circle around a triangle: nothing inside is further from what
// is linear between its corners than half the second derivatives times this (Waldron 1998).
double circle_around(const std::array<glm::dvec3, 3>& p) {
    const auto squared = [](const glm::dvec3& v) { return glm::dot(v, v); };
    double a = squared(p[1] - p[2]), b = squared(p[2] - p[0]), c = squared(p[0] - p[1]);
    if (a < b) std::swap(a, b);
    if (a < c) std::swap(a, c);
    if (a >= b + c) return 0.25 * a;
    const double area = squared(glm::cross(p[1] - p[0], p[2] - p[0]));
    return std::min(a / 3 * (1 + 0x1p-40), a * b * c / (4 * area));
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

double NoiseField::left_out() const {
    double sum = 0;
    over_parts(options_, [&](int, double, double amplitude, double part) {
        if (part < 1) sum += (1 - part) * std::abs(amplitude);
    });
    return bounds_of(options_.kind).value * sum * (1 + 0x1p-48);
}

double NoiseField::change(double distance) const {
    const KindBounds bounds = bounds_of(options_.kind);
    double sum = 0;
    over_octaves(options_, [&](std::uint64_t, double frequency, double amplitude) {
        // In this order a product that is no number is not the less.
        sum += std::min(2 * bounds.value * std::abs(amplitude),
                        bounds.gradient * std::abs(amplitude * frequency) * distance);
    });
    return sum * (1 + 0x1p-46);
}

double NoiseField::deviation(const std::array<glm::dvec3, 3>& p) const {
    const KindBounds bounds = bounds_of(options_.kind);
    const double half = 0.5 * circle_around(p);
    double farthest_out = 0;
    bool near = true;
    for (std::size_t k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis) {
            near &= std::isfinite(p[k][axis]);
            farthest_out = std::max(farthest_out, std::abs(p[k][axis]));
        }
    double sum = 0, anywhere = 0, places = 0;  // places: by what points are rounded
    double rounding = std::abs(options_.midlevel * options_.scale) * 0x1p-44;
    over_octaves(options_, [&](std::uint64_t, double frequency, double amplitude) {
        near &= std::abs(frequency) * farthest_out < farthest_cell;
        const double most = 2 * bounds.value * std::abs(amplitude);
        // In this order a product that is no number is not the less.
        sum += std::min(most, bounds.second * std::abs(amplitude) * frequency * frequency * half);
        anywhere += most;
        rounding += most * 0x1p-44;
        places += bounds.gradient * std::abs(amplitude * frequency) * farthest_out * 0x1p-48;
    });
    return near ? sum + rounding + places : anywhere + rounding;
}

}  // namespace prep::detail
