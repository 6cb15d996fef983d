// Every triangle's bound, not only the largest: no sampled point of a triangle is farther off than
// is proved of it, over cages of quads, triangles and n-gons, moved by noise, heights and vectors,
// for any goal.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "height_maps.h"
#include "limit_cages.h"
#include "tessellation/displaced_surface.h"
#include "tessellation/limit/limit_base.h"
#include "tessellation/polygon_surface.h"
#include "tessellation/refinement.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;
using test::over_triangle;

// Vectors of sines; derivatives of the second order are at most scale · k².
class VectorWaves final : public VectorFunction {
  public:
    VectorWaves(double scale, double k) : scale_(scale), k_(k) {}
    Sample at(const glm::dvec2& uv) const override {
        const double x = k_ * uv.x, y = k_ * uv.y;
        return {scale_ * glm::dvec3(std::sin(x), std::cos(y), std::sin(y)),
                scale_ * k_ * glm::dvec3(std::cos(x), 0, 0),
                scale_ * k_ * glm::dvec3(0, -std::sin(y), std::cos(y))};
    }
    double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<glm::dvec3, 3>&,
                     double) const override {
        double longest = 0;
        for (std::size_t k = 0; k < 3; ++k)
            longest = std::max(longest, glm::length(uv[k] - uv[(k + 1) % 3]));
        return std::sqrt(3.0) * scale_ * std::min(2.0, k_ * k_ * longest * longest / 6);
    }

  private:
    double scale_, k_;
};

struct Totals {
    std::size_t triangles = 0, closed = 0;
    std::vector<double> ratios;
};

void check_bounds(const Mesh& cage, const TessellateOptions& options, Totals& totals) {
    detail::Domain domain;
    std::unique_ptr<detail::BaseSurface> base;
    if (!options.scheme) {
        domain = detail::make_domain(cage, {}, true, 1);
        auto made = detail::PolygonSurface::make(cage, domain, {}, 1);
        ASSERT_TRUE(made) << to_string(made.error());
        base = std::make_unique<detail::PolygonSurface>(*std::move(made));
    } else {
        SubdivideOptions how;
        how.scheme = *options.scheme;
        auto made = detail::LimitBase::make(cage, how, true);
        ASSERT_TRUE(made) << to_string(made.error());
        auto limit = std::make_unique<detail::LimitBase>(*std::move(made));
        domain = detail::make_domain(cage, limit->left_out(), false, 1);
        limit->set_domain(domain);
        base = std::move(limit);
    }
    const auto heights = detail::RootHeights::make(cage, domain, *base, options);
    ASSERT_TRUE(heights) << to_string(heights.error());
    const detail::DisplacedSurface surface(*base, *heights);
    detail::Refinement refinement(cage, domain, surface, options);
    const auto run = refinement.run();
    ASSERT_TRUE(run) << to_string(run.error());
    const auto triangles = refinement.mesh().triangles();
    const std::size_t step = std::max<std::size_t>(1, triangles.size() / 500);
    const int grid = triangles.size() < 500 ? 24 : 12;
    for (std::size_t t = 0; t < triangles.size(); t += step) {
        const detail::TrianglePoints points = surface.points(triangles[t]);
        std::vector<detail::RootPoint> at;
        std::vector<glm::dvec3> facet;
        over_triangle(grid, [&](const glm::dvec3& w) {
            at.push_back(points.at(w));
            glm::dvec3 p(0.0);
            for (std::size_t k = 0; k < 3; ++k)
                p += w[glm::length_t(k)] *
                     glm::dvec3(refinement.samples()[triangles[t].vertices[k]].position);
            facet.push_back(p);
        });
        std::vector<glm::dvec3> truths(at.size());
        surface.truths(at, truths);
        double error = 0;
        for (std::size_t k = 0; k < at.size(); ++k)
            error = std::max(error, glm::length(truths[k] - facet[k]));
        const double bound = refinement.bounds()[t].sum();
        EXPECT_LE(error, bound) << (triangles[t].is_closed() ? "closed" : "open");
        ++totals.triangles;
        totals.closed += triangles[t].is_closed();
        if (error > 0) totals.ratios.push_back(bound / error);
    }
}

// A picture of two units at distance 1, from (0, 0, z) down or up.
ScreenMetric seen_from(double z, double along) {
    ScreenMetric metric;
    metric.x = {1, 0, 0, 0};
    metric.y = {0, 1, 0, 0};
    metric.w = {0, 0, along, -along * z};
    metric.near_distance = 1e-2;
    return metric;
}

Mesh random_cage(int round, std::optional<SubdivisionScheme> scheme, std::mt19937& random) {
    std::uniform_real_distribution<float> number(-0.2F, 0.2F);
    Mesh cage = round % 2 == 0 ? torus(5, 4) : prism(5);
    if (scheme == SubdivisionScheme::loop) cage = in_triangles(cage);
    for (glm::vec3& p : cage.positions)
        p += glm::vec3(number(random), number(random), number(random));
    add_charts(cage, random);
    return cage;
}

// Noise with a map, with vectors in space and along the surface, and each of them alone.
Displacement random_displacement(int round, std::mt19937& random) {
    std::uniform_real_distribution<double> part(0, 1);
    Displacement by{.height = nullptr};
    const int what = round % 6;
    if (what != 0) {
        NoiseOptions noise{.kind = round % 4 < 2 ? NoiseKind::perlin : NoiseKind::simplex,
                           .frequency = std::exp2(3 * part(random) - 1.5),
                           .octaves = 1 + round % 4,
                           .seed = std::uint32_t(round)};
        noise.scale = std::exp2(-1 - 4 * part(random));
        noise.midlevel = part(random) - 0.5;
        const auto function = noise_function(noise);
        EXPECT_TRUE(function);
        by.noise = *function;
    }
    if (what == 0 || what == 2 || what == 5)
        by.height = std::make_shared<Waves>(0.3 * part(random), 2 + 6 * part(random), 5, round);
    if (what >= 3)
        by.vector = std::make_shared<VectorWaves>(0.15 * part(random), 1 + 5 * part(random));
    by.tangent_space = what >= 4;
    return by;
}

enum class Goal : std::uint8_t { budget, chord, pixels, chord_and_pixels, chord_in_budget, edge };

// `most_median`: of bounds over the largest sampled error. Those of what no picture shows, and of
// what is nearer than an error that is there, are as loose as they are.
constexpr double any = std::numeric_limits<double>::infinity();
void check_goal(Goal goal, double most_median) {
    constexpr int rounds = 12;
    std::mt19937 random(11 + unsigned(goal));
    std::uniform_real_distribution<double> part(0, 1);
    Totals totals;
    for (int round = 0; round < rounds; ++round)
        for (const std::optional<SubdivisionScheme> scheme : {std::optional<SubdivisionScheme>(),
                                                              {SubdivisionScheme::catmark},
                                                              {SubdivisionScheme::loop}}) {
            SCOPED_TRACE(std::to_string(round) + (!scheme ? ", polygons"
                                                  : *scheme == SubdivisionScheme::loop
                                                      ? ", loop"
                                                      : ", catmark"));
            const Mesh cage = random_cage(round, scheme, random);
            TessellateOptions options;
            options.scheme = scheme;
            options.displacements = {random_displacement(round, random)};
            const bool has_pixels = goal == Goal::pixels || goal == Goal::chord_and_pixels;
            if (goal == Goal::budget || goal == Goal::chord_in_budget)
                options.max_triangles = 1 + random() % 600;
            if (goal == Goal::edge)
                options.edge_length = std::exp2(2 - 3 * part(random));
            else if (goal != Goal::budget && goal != Goal::pixels)
                options.chord_error = std::exp2((has_pixels ? 1 : -1) - 4 * part(random));
            if (has_pixels) {
                // Most of the cage is before or behind; another view sees what one does not.
                options.pixel_error = std::exp2(-4 * part(random));
                options.screens = {seen_from(2 * part(random), 1)};
                if (round % 3 == 0) options.screens.push_back(seen_from(-6, 1));
            }
            check_bounds(cage, options, totals);
        }
    std::sort(totals.ratios.begin(), totals.ratios.end());
    const double median = totals.ratios[totals.ratios.size() / 2];
    std::printf("%zu triangles, %zu closed; bound over sampled: median %.3f\n", totals.triangles,
                totals.closed, median);
    EXPECT_GT(totals.closed, std::size_t(rounds));
    EXPECT_LE(median, most_median);
}

TEST(TessellationTriangleBounds, HoldForABudget) {
    check_goal(Goal::budget, 2);
}
TEST(TessellationTriangleBounds, HoldForAChordError) {
    check_goal(Goal::chord, 2.5);
}
// Of triangles that no picture shows as well.
TEST(TessellationTriangleBounds, HoldForPixels) {
    check_goal(Goal::pixels, any);
}
TEST(TessellationTriangleBounds, HoldForAChordErrorAndPixels) {
    check_goal(Goal::chord_and_pixels, any);
}
TEST(TessellationTriangleBounds, HoldForAChordErrorInABudget) {
    check_goal(Goal::chord_in_budget, 2.5);
}
TEST(TessellationTriangleBounds, HoldForAnEdgeLength) {
    check_goal(Goal::edge, any);
}

// A map as rough in the fourth of a triangle as in all of it, far from what moves nothing, under
// noise: each is bounded on its own.
TEST(TessellationTriangleBounds, HoldForRoughMapsUnderNoise) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> part(0, 1);
    Totals totals;
    for (int round = 0; round < 8; ++round)
        for (const std::optional<SubdivisionScheme> scheme : {std::optional<SubdivisionScheme>(),
                                                              {SubdivisionScheme::catmark},
                                                              {SubdivisionScheme::loop}}) {
            SCOPED_TRACE(round);
            const Mesh cage = random_cage(round, scheme, random);
            NoiseOptions noise{.frequency = 2, .octaves = 2, .seed = std::uint32_t(round)};
            noise.scale = 0.1 * part(random);
            const auto function = noise_function(noise);
            ASSERT_TRUE(function);
            TessellateOptions options;
            options.scheme = scheme;
            options.displacements = {
                {.height = std::make_shared<Waves>(0.1 * part(random), 900, 700, round),
                 .midlevel = 2 * part(random) - 1,
                 .noise = *function}};
            options.max_triangles = 1 + random() % 300;
            if (round % 2 == 0) options.chord_error = std::exp2(-2 - 3 * part(random));
            check_bounds(cage, options, totals);
        }
    std::sort(totals.ratios.begin(), totals.ratios.end());
    const double median = totals.ratios[totals.ratios.size() / 2];
    std::printf("%zu triangles; bound over sampled: median %.3f\n", totals.triangles, median);
    EXPECT_LE(median, 4);  // Waves bounds itself no closer than twice
}

// Parts of a triangle have as much of a rough map each as all of it: searching them all again for
// the noise over it took 15 ms a triangle.
TEST(TessellationTriangleBounds, NoisePartsDoNotReadRoughMaps) {
    class Counted final : public HeightFunction {
      public:
        explicit Counted(double k) : waves_(0.1, k, k) {}
        Sample at(const glm::dvec2& uv) const override { return waves_.at(uv); }
        double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<double, 3>& values,
                         double enough) const override {
            ++count;
            return waves_.deviation(uv, values, enough);
        }
        mutable std::size_t count = 0;

      private:
        Waves waves_;
    };
    NoiseOptions noise{.frequency = 2, .octaves = 2, .seed = 3};
    noise.scale = 0.1;
    const auto function = noise_function(noise);
    ASSERT_TRUE(function);
    const auto calls = [&](double k) {
        const auto map = std::make_shared<Counted>(k);
        std::mt19937 random(1);
        Mesh cage = torus(5, 4);
        add_charts(cage, random);
        TessellateOptions options;
        options.threads = 1;
        options.max_triangles = 500;
        options.displacements = {{.height = map, .noise = *function}};
        const auto made = tessellate(cage, options);
        EXPECT_TRUE(made) << to_string(made.error());
        return double(map->count) / 500;
    };
    const double rough = calls(900), smooth = calls(3);
    std::printf("reads a triangle: of a rough map %.1f, of a smooth one %.1f\n", rough, smooth);
    EXPECT_LE(rough, 100);
    EXPECT_GT(smooth, 4 * rough);  // whose parts are nearer to it
}

// Maps that are constant, or linear in u, depart from what is linear by roundings alone.
TEST(TessellationTriangleBounds, NoiseOverSmoothMapsIsBoundedAsClosely) {
    class Ramp final : public HeightFunction {
      public:
        explicit Ramp(double slope) : slope_(slope) {}
        Sample at(const glm::dvec2& uv) const override { return {1 + slope_ * uv.x, {slope_, 0}}; }
        double deviation(const std::array<glm::dvec2, 3>&, const std::array<double, 3>&,
                         double) const override {
            return 1e-15;
        }

      private:
        double slope_;
    };
    NoiseOptions noise{.frequency = 2, .octaves = 3, .seed = 3};
    noise.scale = 0.05;
    const auto function = noise_function(noise);
    ASSERT_TRUE(function);
    std::mt19937 random(1);
    Mesh cage = torus(5, 4);
    add_charts(cage, random);
    const auto ratio = [&](std::shared_ptr<const HeightFunction> map) {
        TessellateOptions options;
        options.scheme = SubdivisionScheme::catmark;
        options.max_triangles = 1000;
        options.displacements = {
            {.height = std::move(map), .scale = 0.2, .midlevel = 0.5, .noise = *function}};
        const auto made = tessellate(cage, options);
        EXPECT_TRUE(made) << to_string(made.error());
        return made->certificate.proved / made->certificate.measured;
    };
    const double alone = ratio(nullptr);
    for (const double slope : {0.0, 0.2}) {
        const double over = ratio(std::make_shared<Ramp>(slope));
        std::printf("proved over measured: noise %.3f, over a slope of %g %.3f\n", alone, slope,
                    over);
        EXPECT_LE(over, 1.25 * alone) << slope;
    }
}

// No triangle's bound is looser than the largest error makes it.
TEST(TessellationTriangleBounds, OfAnEdgeLengthTheLargestIsClose) {
    NoiseOptions noise{.frequency = 4, .octaves = 4, .seed = 4};
    noise.scale = 0.1;
    const auto function = noise_function(noise);
    ASSERT_TRUE(function);
    TessellateOptions options;
    options.displacements = {{.height = nullptr, .noise = *function}};
    options.edge_length = 0.1;
    const auto made = tessellate(cube(), options);
    ASSERT_TRUE(made) << to_string(made.error());
    std::printf("proved %.4g, measured %.4g\n", made->certificate.proved,
                made->certificate.measured);
    EXPECT_GE(made->certificate.proved, made->certificate.measured);
    EXPECT_LE(made->certificate.proved, 1.5 * made->certificate.measured);
}

// Sides that disagree leave a gap in the largest triangle's bound: the share that may be loose is
// what is left beside it. A budget that is not reached takes each bound as tight as may be.
TEST(TessellationTriangleBounds, OfAnEdgeLengthGapsLoosenNothing) {
    Mesh cage = cube();
    TessellateOptions options;
    for (std::uint32_t f = 0; f < cage.face_count(); ++f) {
        NoiseOptions noise{.frequency = 4, .octaves = 4, .seed = 4};
        noise.scale = 0.1;
        noise.midlevel = f;  // of its own height
        const auto function = noise_function(noise);
        ASSERT_TRUE(function);
        options.displacements.push_back({.height = nullptr, .noise = *function});
        options.material_displacements.push_back(f);
        cage.face_materials.push_back(f);
    }
    options.edge_length = 0.2;
    const auto alone = tessellate(cage, options);
    ASSERT_TRUE(alone) << to_string(alone.error());
    options.max_triangles = 10 * alone->certificate.triangles;
    const auto within = tessellate(cage, options);
    ASSERT_TRUE(within) << to_string(within.error());
    std::printf("proved %.4g, with a budget %.4g, measured %.4g, gap %.4g\n",
                alone->certificate.proved, within->certificate.proved, alone->certificate.measured,
                alone->certificate.largest_shared_gap);
    EXPECT_EQ(alone->certificate.triangles, within->certificate.triangles);
    EXPECT_GT(alone->certificate.largest_shared_gap, 0.1);
    EXPECT_GE(alone->certificate.proved, alone->certificate.measured);
    EXPECT_LE(alone->certificate.proved, 1.01 * within->certificate.proved);
}

// A budget that is larger than what an error takes changes next to nothing.
TEST(TessellationTriangleBounds, AGoalTakesNoMoreTrianglesForABudget) {
    NoiseOptions noise{.frequency = 2, .octaves = 3, .seed = 4};
    noise.scale = 0.2;
    const auto function = noise_function(noise);
    ASSERT_TRUE(function);
    TessellateOptions options;
    options.scheme = SubdivisionScheme::catmark;
    options.displacements = {{.height = nullptr, .noise = *function}};
    options.chord_error = 0.02;
    const auto alone = tessellate(cube(), options);
    ASSERT_TRUE(alone) << to_string(alone.error());
    options.max_triangles = 4 * alone->certificate.triangles;
    const auto within = tessellate(cube(), options);
    ASSERT_TRUE(within) << to_string(within.error());
    std::printf("%zu triangles, %zu with a budget\n", std::size_t(alone->certificate.triangles),
                std::size_t(within->certificate.triangles));
    EXPECT_LE(double(within->certificate.triangles), 1.03 * double(alone->certificate.triangles));
    EXPECT_LE(within->certificate.proved, 0.02);
}

}  // namespace
}  // namespace prep
