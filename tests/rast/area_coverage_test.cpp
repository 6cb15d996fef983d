// Exact areas within one pixel against closed forms.
#include "coverage/area_coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using rast::detail::DepthPlane;
using rast::detail::PixelCoverage;
using Polygon = PixelCoverage::Polygon;

double area_of(const PixelCoverage& pixel, std::uint32_t owner) {
    for (const PixelCoverage::Share& s : pixel.shares())
        if (s.owner == owner) return s.area;
    return 0;
}

double total(const PixelCoverage& pixel) {
    double sum = pixel.empty_area();
    for (const PixelCoverage::Share& s : pixel.shares()) sum += s.area;
    return sum;
}

TEST(AreaCoverage, NothingCoversNothing) {
    PixelCoverage pixel;
    pixel.clear();
    EXPECT_TRUE(pixel.shares().empty());
    EXPECT_EQ(pixel.empty_area(), 1.0);
    pixel.add({}, {}, 0);
    pixel.add({{0, 0}, {1, 1}}, {1, 0, 0}, 0);
    pixel.add({{0, 0}, {1, 1}, {0.5, 0.5}}, {1, 0, 0}, 0);  // no area
    pixel.add({{2, 0}, {3, 0}, {2, 1}}, {1, 0, 0}, 0);      // elsewhere
    EXPECT_TRUE(pixel.shares().empty());
    EXPECT_EQ(pixel.empty_area(), 1.0);
    const double nan = std::nan("");
    pixel.add({{0, 0}, {nan, 0}, {0, 1}}, {1, 0, 0}, 0);
    EXPECT_NEAR(total(pixel), 1, 1e-15);
}

TEST(AreaCoverage, AnUprightEdgeCoversItsPlaceInThePixel) {
    for (int k = 0; k <= 256; ++k) {
        PixelCoverage pixel;
        pixel.clear();
        const double x = k / 256.0;
        pixel.add({{-1000, -1000}, {x, -1000}, {x, 1000}, {-1000, 1000}}, {0.5, 0, 0}, 7);
        EXPECT_EQ(area_of(pixel, 7), x);
        EXPECT_EQ(pixel.empty_area(), 1 - x);
    }
}

// The area of x·cos + y·sin < d in the unit square, as the sum over its corners: d₊² of each,
// signed, over 2·cos·sin.
double half_plane_area(double c, double s, double d) {
    const auto square = [](double v) { return v > 0 ? v * v : 0; };
    return (square(d) - square(d - c) - square(d - s) + square(d - c - s)) / (2 * c * s);
}

TEST(AreaCoverage, ASlantedEdgeCoversTheClosedFormsArea) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int n = 0; n < 2000; ++n) {
        const double angle = 0.05 + unit(random) * 1.47, c = std::cos(angle), s = std::sin(angle);
        const double d = unit(random) * (c + s);
        // The half plane as a large rectangle with the edge as one side.
        const glm::dvec2 on(c * d, s * d), along(-s, c), away(-c, -s);
        PixelCoverage pixel;
        pixel.clear();
        pixel.add({on - along * 100.0, on + along * 100.0, on + along * 100.0 + away * 100.0,
                   on - along * 100.0 + away * 100.0},
                  {0.5, 0, 0}, 1);
        EXPECT_NEAR(area_of(pixel, 1), half_plane_area(c, s, d), 2e-13) << angle << " " << d;
    }
}

TEST(AreaCoverage, TriangulationsFillThePixel) {
    std::mt19937_64 random(6);
    for (int n = 0; n < 300; ++n) {
        // A fan about a point on the grid of 1/256 pixels, out to a circle far away.
        const glm::dvec2 centre(double(random() % 257) / 256, double(random() % 257) / 256);
        const int parts = 3 + int(random() % 30);
        PixelCoverage pixel;
        pixel.clear();
        std::vector<glm::dvec2> rim;
        for (int k = 0; k < parts; ++k) {
            const double a = 2 * 3.14159265358979 * k / parts;
            rim.push_back(
                {std::round(std::cos(a) * 5120) / 256, std::round(std::sin(a) * 5120) / 256});
        }
        for (int k = 0; k < parts; ++k)
            pixel.add({centre, rim[std::size_t(k)], rim[std::size_t(k + 1) % rim.size()]},
                      {0.5, 0, 0}, std::uint32_t(k));
        double sum = 0;
        for (const PixelCoverage::Share& s : pixel.shares()) sum += s.area;
        EXPECT_NEAR(sum, 1, 1e-13);
        EXPECT_LT(pixel.empty_area(), 1e-13);
        EXPECT_LE(pixel.piece_count(), std::size_t(parts) + 3);  // neighbours cut nothing
    }
}

TEST(AreaCoverage, TheNearerSurfaceIsSeenInAnyOrder) {
    const Polygon left = {{-1, -1}, {0.75, -1}, {0.75, 2}, {-1, 2}};
    const Polygon right = {{0.25, -1}, {2, -1}, {2, 2}, {0.25, 2}};
    for (const bool turned : {false, true}) {
        PixelCoverage pixel;
        pixel.clear();
        if (turned) pixel.add(right, {0.4, 0, 0}, 2);
        pixel.add(left, {0.6, 0, 0}, 1);
        if (!turned) pixel.add(right, {0.4, 0, 0}, 2);
        EXPECT_DOUBLE_EQ(area_of(pixel, 1), 0.75);
        EXPECT_DOUBLE_EQ(area_of(pixel, 2), 0.25);
    }
}

TEST(AreaCoverage, SurfacesThatPassThroughEachOtherMeetInALine) {
    const Polygon all = {{-1, -1}, {2, -1}, {2, 2}, {-1, 2}};
    for (const double at : {0.1, 0.5, 0.9}) {
        PixelCoverage pixel;
        pixel.clear();
        pixel.add(all, {0.5, 0, 0}, 1);
        pixel.add(all, {0.5 - 0.1 * at, 0.1, 0}, 2);  // nearer where x > at
        EXPECT_NEAR(area_of(pixel, 1), at, 1e-12);
        EXPECT_NEAR(area_of(pixel, 2), 1 - at, 1e-12);
    }
}

TEST(AreaCoverage, OfEqualDepthsTheFirstIsSeen) {
    const Polygon all = {{-1, -1}, {2, -1}, {2, 2}, {-1, 2}};
    for (const bool turned : {false, true}) {
        PixelCoverage pixel;
        pixel.clear();
        pixel.add(all, {0.5 * (1 + 1e-8), 0, 0}, turned ? 1u : 2u);
        pixel.add(all, {0.5, 0, 0}, turned ? 2u : 1u);
        EXPECT_EQ(area_of(pixel, 1), 1);
        EXPECT_EQ(area_of(pixel, 2), 0);
    }
}

TEST(AreaCoverage, TheFarPlaneCuts) {
    PixelCoverage pixel;
    pixel.clear();
    pixel.add({{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}, {0.25, -1, 0}, 1);
    EXPECT_NEAR(area_of(pixel, 1), 0.25, 1e-7);  // the tolerance of depth, 2^-22
    pixel.clear();
    pixel.add({{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}, {-0.1, 0, 0}, 1);
    EXPECT_EQ(pixel.empty_area(), 1);
    EXPECT_TRUE(pixel.add_to_union({{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}, {-0.1, 0, 0}));
    EXPECT_EQ(pixel.empty_area(), 1);
    EXPECT_TRUE(pixel.add_to_union({{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}, {0.25, -1, 0}));
    EXPECT_NEAR(pixel.empty_area(), 0.75, 1e-7);
    EXPECT_FALSE(pixel.add_to_union({{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}, {0.5, 0, 0}));
    EXPECT_EQ(pixel.empty_area(), 0);
}

TEST(AreaCoverage, BeyondTheFarPlaneWhatIsBehindIsSeen) {
    const Polygon all = {{-1, -1}, {2, -1}, {2, 2}, {-1, 2}};
    for (const bool turned : {false, true}) {
        PixelCoverage pixel;
        pixel.clear();
        if (turned) pixel.add(all, {0.5, -1, 0}, 2);
        pixel.add(all, {0.1, 0, 0}, 1);
        if (!turned) pixel.add(all, {0.5, -1, 0}, 2);  // nearer up to 0.4, beyond from 0.5 on
        EXPECT_NEAR(area_of(pixel, 2), 0.4, 1e-6);
        EXPECT_NEAR(area_of(pixel, 1), 0.6, 1e-6);
        EXPECT_NEAR(pixel.empty_area(), 0, 1e-12);
    }
}

TEST(AreaCoverage, CentroidsAreThoseOfThePartsThatAreSeen) {
    // A triangle's is a third of the sum of its corners; the rest of the square follows.
    const Polygon triangle = {{0, 0}, {0.75, 0}, {0, 0.375}};
    PixelCoverage pixel;
    pixel.clear();
    pixel.add({{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}, {0.25, 0, 0}, 7);
    pixel.add(triangle, {0.5, 0, 0}, 3);
    const auto shares = pixel.shares();
    ASSERT_EQ(shares.size(), 2u);
    const double area = 0.75 * 0.375 / 2;
    EXPECT_EQ(shares[0].owner, 3u);
    EXPECT_NEAR(shares[0].area, area, 1e-12);
    EXPECT_NEAR(shares[0].centroid.x, 0.25, 1e-12);
    EXPECT_NEAR(shares[0].centroid.y, 0.125, 1e-12);
    EXPECT_NEAR(shares[1].centroid.x, (0.5 - area * 0.25) / (1 - area), 1e-12);
    EXPECT_NEAR(shares[1].centroid.y, (0.5 - area * 0.125) / (1 - area), 1e-12);
    // What of a polygon lies inside the pixel, whatever is in front of it.
    Polygon inside;
    glm::dvec2 centroid(0);
    ASSERT_TRUE(
        PixelCoverage::clip_to_pixel({{-2, -1}, {0.5, -1}, {0.5, 3}, {-2, 3}}, inside, centroid));
    EXPECT_NEAR(centroid.x, 0.25, 1e-12);
    EXPECT_NEAR(centroid.y, 0.5, 1e-12);
    ASSERT_TRUE(PixelCoverage::clip_to_pixel(triangle, inside, centroid));
    EXPECT_NEAR(centroid.x, 0.25, 1e-12);
    EXPECT_NEAR(centroid.y, 0.125, 1e-12);
    EXPECT_FALSE(PixelCoverage::clip_to_pixel({{2, 0}, {3, 0}, {3, 1}}, inside, centroid));
}

// Random triangles at random slants against counting which is nearest at many points: nothing is
// lost, and every surface gets its share within what the points can tell.
TEST(AreaCoverage, RandomScenesAgreeWithCounting) {
    std::mt19937_64 random(9);
    const auto grid = [&] { return double(random() % 1024) / 256 - 1.5; };
    for (int n = 0; n < 60; ++n) {
        struct Surface {
            Polygon polygon;
            DepthPlane depth;
        };
        std::vector<Surface> surfaces;
        for (int k = 0; k < 12; ++k)
            surfaces.push_back({{{grid(), grid()}, {grid(), grid()}, {grid(), grid()}},
                                {0.5 + grid() * 0.1, grid() * 0.05, grid() * 0.05}});
        PixelCoverage pixel;
        pixel.clear();
        for (std::size_t k = 0; k < surfaces.size(); ++k)
            pixel.add(surfaces[k].polygon, surfaces[k].depth, std::uint32_t(k));
        EXPECT_NEAR(total(pixel), 1, 1e-12);
        PixelCoverage united;
        united.clear();
        bool any_left = true;
        for (const Surface& s : surfaces) any_left = united.add_to_union(s.polygon, s.depth);
        EXPECT_NEAR(united.empty_area(), pixel.empty_area(), 1e-12);
        EXPECT_EQ(any_left, united.piece_count() > 0);
        EXPECT_LE(united.piece_count(), pixel.piece_count());
        constexpr int side = 128;
        std::vector<int> hits(surfaces.size(), 0);
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) {
                const glm::dvec2 p((i + 0.5) / side, (j + 0.5) / side);
                double best = 0;
                int seen = -1;
                for (std::size_t k = 0; k < surfaces.size(); ++k) {
                    const Polygon& t = surfaces[k].polygon;
                    const auto cross = [&](int a, int b) {
                        const glm::dvec2 u = t[std::size_t(b)] - t[std::size_t(a)],
                                         v = p - t[std::size_t(a)];
                        return u.x * v.y - u.y * v.x;
                    };
                    const double e[3] = {cross(0, 1), cross(1, 2), cross(2, 0)};
                    const bool inside =
                        (e[0] > 0 && e[1] > 0 && e[2] > 0) || (e[0] < 0 && e[1] < 0 && e[2] < 0);
                    const double z = surfaces[k].depth(p);
                    if (inside && z > best) {
                        best = z;
                        seen = int(k);
                    }
                }
                if (seen >= 0) ++hits[std::size_t(seen)];
            }
        // A region bounded by lines that together are at most a few pixels long: the count errs by
        // about the length of its border times the points' distance, 1/128.
        for (std::size_t k = 0; k < surfaces.size(); ++k)
            EXPECT_NEAR(area_of(pixel, std::uint32_t(k)), double(hits[k]) / (side * side), 0.02)
                << n << " " << k;
    }
}

}  // namespace
