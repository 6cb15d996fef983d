// How far outlines are apart: `judge/silhouettes.h`.
#include "judge/silhouettes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

// A half plane, a disc and a square whose outlines move by a known way, by many samples.
TEST(Outlines, ShiftsAreThoseOfTheShapes) {
    constexpr int size = 64, fine = 32;
    const auto drawn = [&](const auto& inside) {
        judge::CoverageMap map{size, size, {}};
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                int count = 0;
                for (int k = 0; k < fine * fine; ++k)
                    count += inside(x + (k % fine + 0.5) / fine, y + (k / fine + 0.5) / fine);
                map.covered.push_back(float(count) / (fine * fine));
            }
        return map;
    };
    for (const double s : {0.1, 0.3, 1.0, 2.5}) {
        for (const double degrees : {0.0, 10.0, 33.0, 45.0, 80.0}) {
            const double c = std::cos(degrees / 57.29577951), n = std::sin(degrees / 57.29577951);
            const auto plane = [&](double by) {
                return drawn([&](double x, double y) { return (x - 32) * c + (y - 32) * n < by; });
            };
            const auto shift = judge::outline_shift(plane(0.13), plane(0.13 + s));
            EXPECT_NEAR(shift.pixels, s, 0.06 * s + 0.02) << degrees;
        }
        const auto disc = [&](double r) {
            return drawn([&](double x, double y) { return std::hypot(x - 32, y - 32) < r; });
        };
        EXPECT_NEAR(judge::outline_shift(disc(20), disc(20 + s)).pixels, s, 0.12 * s + 0.02);
        const auto square = [&](double r) {
            return drawn([&](double x, double y) {
                return std::max(std::abs(x - 32.2), std::abs(y - 31.7)) < r;
            });
        };
        // Its corners move by √2 as much, and less of them is an outline than of a straight line.
        const double moved = judge::outline_shift(square(18), square(18 + s)).pixels;
        EXPECT_GT(moved, 0.94 * s - 0.02);
        EXPECT_LT(moved, 1.1 * std::sqrt(2.0) * s + 0.02);
    }
    const auto disc = drawn([](double x, double y) { return std::hypot(x - 32, y - 32) < 20; });
    EXPECT_EQ(judge::outline_shift(disc, disc).pixels, 0);
}

}  // namespace
