// Noise in space: its analytic properties, its constants by interval arithmetic, its deviations
// against dense samples.
#include "displacement/noise_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <queue>
#include <random>

#include "height_maps.h"
#include "pipeline/displacement_maps.h"

namespace prep {
namespace {

using detail::NoiseField;
using detail::NoiseSample;
using test::over_triangle;

constexpr NoiseKind kinds[] = {NoiseKind::perlin, NoiseKind::simplex};

NoiseField field(NoiseKind kind, int octaves = 1, std::uint32_t seed = 1, double frequency = 1,
                 double scale = 1) {
    NoiseOptions options;
    options.kind = kind;
    options.octaves = octaves;
    options.seed = seed;
    options.frequency = frequency;
    options.scale = scale;
    const auto made = NoiseField::make(options);
    EXPECT_TRUE(made);
    return *made;
}

double part(std::mt19937& random) {
    return double(random()) / 4294967296.0;
}
glm::dvec3 point(std::mt19937& random, double size) {
    return size * (2.0 * glm::dvec3(part(random), part(random), part(random)) - 1.0);
}

TEST(NoiseField, IsZeroAtItsLattice) {
    std::mt19937 random(1);
    for (int k = 0; k < 500; ++k) {
        const glm::dvec3 cell = glm::floor(point(random, 1000));
        EXPECT_EQ(field(NoiseKind::perlin).value(cell), 0.0);
        // Of simplices: (i, j, k) − (i + j + k)/6.
        const glm::dvec3 corner = cell - (cell.x + cell.y + cell.z) / 6;
        EXPECT_NEAR(field(NoiseKind::simplex).value(corner), 0.0, 1e-11);
    }
}

// Across faces of cells and simplices, too: steps are taken through random points and through
// points on x = whole and x = y, where the cells of either lattice meet.
TEST(NoiseField, GradientsAreThoseOfTheValuesAndContinuous) {
    std::mt19937 random(2);
    for (const NoiseKind kind : kinds)
        for (const int octaves : {1, 4}) {
            const NoiseField noise = field(kind, octaves, 3, 0.7, 2.5);
            for (int k = 0; k < 4000; ++k) {
                glm::dvec3 p = point(random, 20);
                if (k % 4 == 1) p.x = std::floor(p.x) / 0.7;
                if (k % 4 == 2) p.y = p.x;
                if (k % 4 == 3) p.z = std::floor(p.z) / 0.7 + p.x - std::floor(p.x);
                const glm::dvec3 gradient = noise.gradient(p);
                constexpr double h = 1e-5;
                for (int axis = 0; axis < 3; ++axis) {
                    glm::dvec3 before = p, after = p;
                    before[axis] -= h;
                    after[axis] += h;
                    EXPECT_NEAR((noise.value(after) - noise.value(before)) / (2 * h),
                                gradient[axis], 2e-5 * noise.steepest());
                    EXPECT_LE(glm::length(noise.gradient(after) - gradient),
                              h * noise.curvature() * (1 + 1e-6));
                }
            }
        }
}

TEST(NoiseField, StaysWithinItsBoundsAndUsesThem) {
    std::mt19937 random(3);
    for (const NoiseKind kind : kinds) {
        const NoiseField noise = field(kind);
        double most = 0, least = 0, steepest = 0, sum = 0, squares = 0;
        constexpr int samples = 200000;
        for (int k = 0; k < samples; ++k) {
            const NoiseSample s = noise.sample(point(random, 1e4));
            most = std::max(most, s.value);
            least = std::min(least, s.value);
            steepest = std::max(steepest, glm::length(s.gradient));
            sum += s.value;
            squares += s.value * s.value;
        }
        EXPECT_LE(most, noise.range().high);
        EXPECT_GE(least, noise.range().low);
        EXPECT_LE(steepest, noise.steepest());
        // No bound is idle, and no direction preferred.
        EXPECT_GE(most, 0.65 * noise.range().high);
        EXPECT_LE(least, 0.65 * noise.range().low);
        EXPECT_GE(steepest, 0.4 * noise.steepest());
        const double deviation = std::sqrt(squares / samples);
        EXPECT_LE(std::abs(sum / samples), 6 * deviation / std::sqrt(samples));
        EXPECT_GE(deviation, 0.2);
    }
}

// By the slope near a point, by what values span far from it.
TEST(NoiseField, ChangesNoMoreThanItSays) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> exponent(-4, 3);
    for (const NoiseKind kind : kinds)
        for (const int octaves : {1, 5}) {
            const NoiseField noise = field(kind, octaves, 3, 0.7, 2.5);
            double used = 0;
            for (int k = 0; k < 100000; ++k) {
                const double far = std::pow(10, exponent(random));
                const glm::dvec3 p = point(random, 20);
                const glm::dvec3 q = p + far * glm::normalize(point(random, 1));
                const double most = noise.change(glm::length(q - p));
                const double change = std::abs(noise.value(q) - noise.value(p));
                EXPECT_LE(change, most);
                EXPECT_LE(most, noise.steepest() * glm::length(q - p) * (1 + 1e-12));
                used = std::max(used, change / most);
            }
            const prep::detail::Interval range = noise.range();
            EXPECT_NEAR(noise.change(1e9), range.high - range.low, 1e-9);
            EXPECT_EQ(noise.change(std::numeric_limits<double>::infinity()), noise.change(1e9));
            EXPECT_GE(used, octaves == 1 ? 0.5 : 0.2);
        }
}

// Recorded: pictures and meshes made with a seed stay what they are, on any machine.
TEST(NoiseField, IsTheSameEverywhere) {
    const glm::dvec3 p(0.375, -1.625, 2.75);
    EXPECT_EQ(field(NoiseKind::perlin, 1, 7).value(p), -0x1.56f434f52p-3);
    EXPECT_EQ(field(NoiseKind::simplex, 3, 7).value(p), -0x1.664dbfffffffbp-2);
    EXPECT_NE(field(NoiseKind::perlin, 1, 8).value(p), -0x1.56f434f52p-3);
}

TEST(NoiseField, OctavesAreASum) {
    std::mt19937 random(4);
    for (const NoiseKind kind : kinds) {
        NoiseOptions options;
        options.kind = kind;
        options.octaves = 3;
        options.frequency = 0.5;
        options.lacunarity = 2.5;
        options.gain = 0.25;
        options.scale = 3;
        options.midlevel = 0.125;
        const NoiseField sum = *NoiseField::make(options);
        options.octaves = 2;
        const NoiseField shorter = *NoiseField::make(options);
        const glm::dvec3 p = point(random, 5);
        // The third octave alone: its amplitude bounds it, and it is there.
        const double third = sum.value(p) - shorter.value(p);
        EXPECT_LE(std::abs(third), 3 * 0.25 * 0.25 * 1.1);
        EXPECT_NE(third, 0);
        options.octaves = 1;
        options.midlevel = 0;
        options.scale = 1;
        const NoiseField one = *NoiseField::make(options);
        options.scale = 3;
        options.midlevel = 0.125;
        EXPECT_NEAR(NoiseField::make(options)->value(p), 3 * one.value(p) - 0.375, 1e-14);
    }
}

TEST(NoiseField, OctavesTooFineForTheSpacingAreLeftOut) {
    const NoiseField five = field(NoiseKind::perlin, 5), two = field(NoiseKind::perlin, 2);
    const auto limited = [](double spacing) {
        NoiseOptions options;
        options.octaves = 5;
        options.seed = 1;
        options.sample_spacing = spacing;
        return *NoiseField::make(options);
    };
    const glm::dvec3 p(0.3, 0.4, 0.55);
    EXPECT_EQ(limited(1.0 / 64).value(p), five.value(p));  // 16 cells at most
    EXPECT_EQ(limited(1.0 / 8).value(p), two.value(p));    // 4 and more are gone
    EXPECT_EQ(limited(1.0 / 8).steepest(), two.steepest());
    EXPECT_EQ(limited(10).value(p), 0.0);
    EXPECT_EQ(limited(10).gradient(p), glm::dvec3(0.0));
    // From a quarter to a half of a cycle an octave fades.
    const double faded = limited(1.0 / 48).value(p) - field(NoiseKind::perlin, 4).value(p);
    const double whole = five.value(p) - field(NoiseKind::perlin, 4).value(p);
    EXPECT_GT(faded / whole, 0.1);
    EXPECT_LT(faded / whole, 0.9);
    // What is left is bounded as it is.
    const NoiseField some = limited(1.0 / 48);
    const std::array<glm::dvec3, 3> corners{p, p + glm::dvec3(0.1, 0, 0),
                                            p + glm::dvec3(0, 0.1, 0)};
    std::array<double, 3> values{};
    for (std::size_t k = 0; k < 3; ++k) values[k] = some.value(corners[k]);
    double most = 0;
    for (int i = 0; i <= 40; ++i)
        for (int j = 0; i + j <= 40; ++j) {
            const glm::dvec3 w = glm::dvec3(40 - i - j, i, j) / 40.0;
            const glm::dvec3 at = w.x * corners[0] + w.y * corners[1] + w.z * corners[2];
            const double linear = w.x * values[0] + w.y * values[1] + w.z * values[2];
            most = std::max(most, std::abs(some.value(at) - linear));
        }
    EXPECT_LE(most, some.deviation(corners));
    EXPECT_LT(some.deviation(corners), five.deviation(corners));
    NoiseOptions negative;
    negative.sample_spacing = -1;
    EXPECT_FALSE(NoiseField::make(negative));
}

TEST(NoiseField, OddNumbersAreErrorsOrNothing) {
    NoiseOptions options;
    for (const int octaves : {0, -1, 33}) {
        options.octaves = octaves;
        EXPECT_FALSE(NoiseField::make(options));
    }
    options.octaves = 32;
    options.lacunarity = 1e10;
    options.gain = 1;
    EXPECT_FALSE(NoiseField::make(options));
    options = {};
    options.scale = std::nan("");
    EXPECT_FALSE(NoiseField::make(options));
    for (const NoiseKind kind : kinds)
        for (const double odd : {std::nan(""), HUGE_VAL, 1e200, -1e18}) {
            const NoiseField noise = field(kind, 4);
            EXPECT_EQ(noise.value({odd, 0.5, 0.5}), 0.0);
            EXPECT_GE(noise.deviation({{{odd, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), 1.0);
        }
}

TEST(NoiseField, DeviationsOfRandomTrianglesAreBounded) {
    std::mt19937 random(5);
    for (const NoiseKind kind : kinds)
        for (const int octaves : {1, 5}) {
            const NoiseField noise = field(kind, octaves, 9, 1.3, 0.5);
            double most_used = 0;
            for (int k = 0; k < 200; ++k) {
                const double size = std::exp2(-9 * part(random)) * 4;
                std::array<glm::dvec3, 3> p, half;
                std::array<double, 3> values;
                const glm::dvec3 at = point(random, 50), along = point(random, 1);
                for (std::size_t c = 0; c < 3; ++c) {
                    p[c] = at + point(random, size);
                    if (k % 5 == 3) p[c] = at + size * part(random) * along;
                    if (k % 5 == 4) p[c] = at;
                    values[c] = noise.value(p[c]);
                    half[c] = 0.5 * (p[0] + p[c]);
                }
                const double bound = noise.deviation(p);
                double sampled = 0;
                over_triangle(60, [&](const glm::dvec3& w) {
                    const glm::dvec3 q = w.x * p[0] + w.y * p[1] + w.z * p[2];
                    const double l = w.x * values[0] + w.y * values[1] + w.z * values[2];
                    sampled = std::max(sampled, std::abs(noise.value(q) - l));
                });
                EXPECT_GE(bound, sampled) << k;
                most_used = std::max(most_used, sampled / bound);
                // With the square of the size: four times where no octave is beyond its range yet.
                const double smaller = noise.deviation(half);
                EXPECT_LE(smaller, bound);
                if (size * 1.3 * std::exp2(octaves) < 0.1) {
                    EXPECT_NEAR(smaller, bound / 4, 1e-3 * bound + 1e-11) << k << " " << size;
                }
            }
            EXPECT_GE(most_used, 0.15) << octaves;
        }
}

// Intervals, rounded outwards by more than a double's error.
struct Range {
    double low = 0, high = 0;
    Range(double x = 0) : low(x), high(x) {}
    Range(double a, double b) : low(a), high(b) {}
};
Range outwards(double a, double b) {
    const double by = (std::abs(a) + std::abs(b)) * 0x1p-50 + 1e-300;
    return {a - by, b + by};
}
Range operator+(Range a, Range b) {
    return outwards(a.low + b.low, a.high + b.high);
}
Range operator-(Range a, Range b) {
    return outwards(a.low - b.high, a.high - b.low);
}
Range operator*(Range a, Range b) {
    const auto [low, high] =
        std::minmax({a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
    return outwards(low, high);
}
Range squared(Range a) {
    const double most = std::max(std::abs(a.low), std::abs(a.high));
    const double least =
        a.low <= 0 && a.high >= 0 ? 0 : std::min(std::abs(a.low), std::abs(a.high));
    return outwards(least * least, most * most);
}
using Range3 = std::array<Range, 3>;

// The largest length, over the twelve gradients, of what one corner adds: to the value, to the
// gradient, to the second derivatives.
struct Sums {
    double value = 0, gradient = 0, second = 0;
};
// Up to their sign, which changes no length.
constexpr int edges[6][3] = {{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};

Sums corner_bounds(Range w, const Range3& dw, const std::array<Range3, 3>& ddw, const Range3& d) {
    Sums most;
    for (const auto& g : edges) {
        Range dot;
        for (std::size_t k = 0; k < 3; ++k)
            if (g[k] != 0) dot = dot + Range(g[k]) * d[k];
        const Range value = w * dot;
        most.value = std::max({most.value, value.high, -value.low});
        Range gradient, second;
        for (std::size_t i = 0; i < 3; ++i) {
            gradient = gradient + squared(dw[i] * dot + w * Range(g[i]));
            for (std::size_t j = i; j < 3; ++j)
                second = second +
                         Range(i == j ? 1 : 2) *
                             squared(ddw[i][j] * dot + dw[i] * Range(g[j]) + dw[j] * Range(g[i]));
        }
        most.gradient = std::max(most.gradient, std::sqrt(gradient.high));
        most.second = std::max(most.second, std::sqrt(second.high));
    }
    return most;
}

void add(Sums& sum, const Sums& s) {
    sum.value += s.value;
    sum.gradient += s.gradient;
    sum.second += s.second;
}

// t ↦ 6t⁵ − 15t⁴ + 10t³ and its derivatives: monotone pieces have their extremes at the ends.
Range fade(Range t) {
    const auto f = [](double x) { return x * x * x * (x * (6 * x - 15) + 10); };
    return outwards(f(t.low), f(t.high));
}
Range fade1(Range t) {  // 30 t² (1 − t)², highest at ½
    const auto f = [](double x) { return 30 * x * x * (1 - x) * (1 - x); };
    const double a = f(t.low), b = f(t.high);
    return outwards(std::min(a, b), t.low <= 0.5 && t.high >= 0.5 ? 1.875 : std::max(a, b));
}
Range fade2(Range t) {  // 60 t (1 − t)(1 − 2t), extreme at (3 ± √3)/6
    const auto f = [](double x) { return 60 * x * (1 - x) * (1 - 2 * x); };
    double low = std::min(f(t.low), f(t.high)), high = std::max(f(t.low), f(t.high));
    const double peak = (3 - std::numbers::sqrt3) / 6, most = 10 / std::numbers::sqrt3;
    if (t.low <= peak && t.high >= peak) high = most;
    if (t.low <= 1 - peak && t.high >= 1 - peak) low = -most;
    return outwards(low - 1e-14, high + 1e-14);
}

Sums perlin_bounds(const Range3& f) {
    Sums sum;
    std::array<std::array<Range, 3>, 2> w, w1, w2;
    for (std::size_t k = 0; k < 3; ++k) {
        w[1][k] = fade(f[k]);
        w[0][k] = Range(1) - w[1][k];
        w1[1][k] = fade1(f[k]);
        w1[0][k] = Range(0) - w1[1][k];
        w2[1][k] = fade2(f[k]);
        w2[0][k] = Range(0) - w2[1][k];
    }
    for (std::size_t c = 0; c < 8; ++c) {
        const std::array<std::size_t, 3> at{c & 1, c >> 1 & 1, c >> 2};
        const auto of = [&](std::size_t x, std::size_t y, std::size_t z) {
            const auto one = [&](std::size_t order, std::size_t k) {
                return order == 0 ? w[at[k]][k] : order == 1 ? w1[at[k]][k] : w2[at[k]][k];
            };
            return one(x, 0) * one(y, 1) * one(z, 2);
        };
        Range3 d, dw;
        std::array<Range3, 3> ddw;
        for (std::size_t i = 0; i < 3; ++i) {
            d[i] = f[i] - Range(double(at[i]));
            dw[i] = of(i == 0, i == 1, i == 2);
            for (std::size_t j = 0; j < 3; ++j)
                ddw[i][j] = of((i == 0) + (j == 0), (i == 1) + (j == 1), (i == 2) + (j == 2));
        }
        add(sum, corner_bounds(of(0, 0, 0), dw, ddw, d));
    }
    return sum;
}

Sums simplex_bounds(const Range3& p) {
    constexpr double corners[4][3] = {
        {0, 0, 0}, {5.0 / 6, -1.0 / 6, -1.0 / 6}, {2.0 / 3, 2.0 / 3, -1.0 / 3}, {0.5, 0.5, 0.5}};
    Sums sum;
    for (const auto& corner : corners) {
        Range3 d;
        Range r2;
        for (std::size_t k = 0; k < 3; ++k) {
            d[k] = p[k] - Range(corner[k]);
            r2 = r2 + squared(d[k]);
        }
        Range t = Range(0.5) - r2;
        if (t.high <= 0) continue;
        t.low = std::max(t.low, 0.0);
        const Range t2 = squared(t), factor(72);
        const Range w = factor * squared(t2);
        const Range first = factor * Range(-8) * t2 * t;  // of d
        const Range second = factor * Range(48) * t2;     // of d dᵀ
        Range3 dw;
        std::array<Range3, 3> ddw;
        for (std::size_t i = 0; i < 3; ++i) {
            dw[i] = first * d[i];
            for (std::size_t j = 0; j < 3; ++j) {
                ddw[i][j] = second * (i == j ? squared(d[i]) : d[i] * d[j]);
                if (i == j) ddw[i][j] = ddw[i][j] + first;
            }
        }
        add(sum, corner_bounds(w, dw, ddw, d));
    }
    return sum;
}

// Splits boxes until each is within the bounds; returns how many it took, 0 where one was not.
template <class Bounds>
std::size_t proved(const Range3& all, double value, double gradient, double second,
                   const Bounds& bounds) {
    std::vector<Range3> boxes{all};
    std::size_t count = 0;
    while (!boxes.empty()) {
        const Range3 box = boxes.back();
        boxes.pop_back();
        if (++count > 3000000) return 0;
        const Sums s = bounds(box);
        if (s.value <= value && s.gradient <= gradient && s.second <= second) continue;
        std::size_t widest = 0;
        for (std::size_t k = 1; k < 3; ++k)
            if (box[k].high - box[k].low > box[widest].high - box[widest].low) widest = k;
        const double middle = 0.5 * (box[widest].low + box[widest].high);
        if (box[widest].high - box[widest].low < 1e-4) return 0;
        boxes.push_back(box);
        boxes.back()[widest].low = middle;
        boxes.push_back(box);
        boxes.back()[widest].high = middle;
    }
    return count;
}

TEST(NoiseBounds, HoldOverTheWholeCell) {
    const NoiseField perlin = field(NoiseKind::perlin), simplex = field(NoiseKind::simplex);
    // An eighth of the cell stands for the others: turning an axis over turns gradients over.
    const Range half(0, 0.5);
    const std::size_t boxes = proved({half, half, half}, perlin.range().high, perlin.steepest(),
                                     perlin.curvature(), perlin_bounds);
    EXPECT_GT(boxes, 0u);
    // Around the simplex x ≥ y ≥ z: its box holds it.
    const Range3 around{Range(0, 5.0 / 6), Range(-1.0 / 6, 2.0 / 3), Range(-1.0 / 3, 0.5)};
    const auto inside = [](const Range3& p) {
        // Outside of it other corners are nearer, and swaps of axes lead back in.
        if (p[0].high < p[1].low || p[1].high < p[2].low) return Sums{};
        // In skewed coordinates p + (x + y + z)/3 the cell is a cube.
        const Range skew = (p[0] + p[1] + p[2]) * Range(1.0 / 3);
        if ((p[0] + skew).low > 1 || (p[2] + skew).high < 0) return Sums{};
        return simplex_bounds(p);
    };
    const std::size_t more =
        proved(around, simplex.range().high, simplex.steepest(), simplex.curvature(), inside);
    EXPECT_GT(more, 0u);
    std::printf("proved with %zu and %zu boxes\n", boxes, more);
}

// Whoever limits a noise that is none without the limit is told how much that leaves out: here all
// octaves but the first, which together are as high as it; the last has 20^31 cells a unit.
TEST(NoiseField, BandLimitsTellOfOctavesThatNoDoubleHolds) {
    Scene scene;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.corner_vertices = {0, 1, 2};
    mesh.face_offsets = {0, 3};
    DisplaceOptions options;
    options.noise.emplace();
    options.noise->octaves = 32;
    options.noise->lacunarity = 20;
    options.band_limit = 0.1;
    ASSERT_FALSE(NoiseField::make(*options.noise));
    const auto made = detail::DisplacementMaps(options, 1).of(scene, mesh, nullptr);
    ASSERT_TRUE(made) << to_string(made.error());
    ASSERT_EQ(made->changes.size(), 1U);
    EXPECT_NEAR(made->changes[0], NoiseField::make()->range().high, 1e-6);
}

}  // namespace
}  // namespace prep
