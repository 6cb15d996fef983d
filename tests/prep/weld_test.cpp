#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "prep/topology.h"
#include "shapes.h"
#include "steps.h"

namespace {

using Indices = std::vector<std::uint32_t>;

TEST(Weld, FindsTheLowestEqualVertex) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<glm::vec3> positions{{1, 2, 3},   {0.0f, 0, 1}, {1, 2, 3}, {-0.0f, -0.0f, 1},
                                           {nan, 0, 0}, {nan, 0, 0},  {1, 2, 3}, {3, 2, 1}};
    EXPECT_EQ(prep::weld_exact(positions), (Indices{0, 1, 0, 1, 4, 5, 0, 7}));
    EXPECT_EQ(prep::weld_exact({}), Indices{});
}

TEST(Weld, IsExact) {
    const float x = 1.0f, y = std::nextafter(x, 2.0f);
    const std::vector<glm::vec3> positions{{x, 0, 0}, {y, 0, 0}, {1e-45f, 0, 0}, {0, 0, 0}};
    EXPECT_EQ(prep::weld_exact(positions), (Indices{0, 1, 2, 3}));
}

TEST(Weld, AgreesWithASortOnRandomPointsForAnyThreadCount) {
    std::mt19937_64 random(1);
    std::uniform_int_distribution<int> coordinate(-20, 20);
    std::vector<glm::vec3> positions(200'000);
    for (auto& p : positions) p = {coordinate(random), coordinate(random), coordinate(random)};
    std::map<std::array<float, 3>, std::uint32_t> first;
    Indices expected;
    for (std::uint32_t v = 0; v < positions.size(); ++v) {
        const glm::vec3& p = positions[v];
        expected.push_back(
            first.try_emplace({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}, v).first->second);
    }
    for (const int threads : {1, 2, 3, 8})
        EXPECT_EQ(prep::weld_exact(positions, threads), expected);
}

TEST(Weld, OrderOfVerticesDoesNotChangeTheClasses) {
    std::mt19937_64 random(2);
    std::uniform_int_distribution<int> coordinate(-3, 3);
    std::vector<glm::vec3> positions(500), moved(500);
    for (auto& p : positions) p = {coordinate(random), coordinate(random), coordinate(random)};
    const Indices numbers = shapes::random_order(positions.size(), random);
    for (std::uint32_t v = 0; v < positions.size(); ++v) moved[numbers[v]] = positions[v];
    const Indices a = prep::weld_exact(positions), b = prep::weld_exact(moved);
    for (std::uint32_t v = 0; v < positions.size(); ++v)
        for (std::uint32_t w = 0; w < v; ++w)
            EXPECT_EQ(a[v] == a[w], b[numbers[v]] == b[numbers[w]]);
}

TEST(Weld, InfinitiesAndDenormalsAreOrdinaryValues) {
    const float inf = std::numeric_limits<float>::infinity(), least = 1e-45f;
    const std::vector<glm::vec3> positions{{inf, 0, 0},   {-inf, 0, 0},   {inf, -0.0f, 0},
                                           {least, 0, 0}, {-least, 0, 0}, {least, 0, -0.0f}};
    EXPECT_EQ(prep::weld_exact(positions), (Indices{0, 1, 0, 3, 4, 3}));
}

// Steps: positions, and places in the table that another one has. Half of the places are free, so
// that a search that finds none meets 1.5 others (Knuth 1963, linear probing), if hashes spread.
TEST(Weld, OnePointAMillionTimesIsFoundAtTheFirstLook) {
    const std::vector<glm::vec3> positions(1'000'000, glm::vec3(1, 2, 3));
    Indices welded;
    EXPECT_EQ(test::steps_of([&] { welded = prep::weld_exact(positions); }), positions.size());
    EXPECT_EQ(welded, Indices(positions.size(), 0));
}

TEST(Weld, ManyNanVerticesAreNotHeldAgainstEachOther) {
    // Of equal bits, and so of equal hashes: 10¹⁰ comparisons if they were.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const glm::vec3& p : {glm::vec3(nan), glm::vec3(1, 2, nan), glm::vec3(nan, 1, 2)}) {
        const std::vector<glm::vec3> positions(50'000, p);
        Indices welded;
        EXPECT_EQ(test::steps_of([&] { welded = prep::weld_exact(positions); }), positions.size());
        for (std::uint32_t v = 0; v < welded.size(); ++v) ASSERT_EQ(welded[v], v);
    }
}

// Files have them that were split in the order in which faces use vertices, a row at a seam first.
TEST(Weld, SeamsAtTheBeginningAreNoReasonToLookAtAll) {
    constexpr std::uint32_t repeated = 2000;
    std::vector<glm::vec3> positions;
    Indices expected;
    for (std::uint32_t v = 0; v < 200'000; ++v) {
        expected.push_back(v < repeated ? v / 2 * 2 : v);
        positions.emplace_back(float(expected[v]), 0.5f, -float(expected[v]));
    }
    Indices welded;
    const auto steps = test::steps_of([&] { welded = prep::weld_exact(positions); });
    EXPECT_EQ(welded, expected);
    EXPECT_LE(steps, positions.size() / 16);
}

// Coordinates that differ in a few bits only, as those of a grid do.
TEST(Weld, GridsSpreadOverTheTable) {
    std::vector<glm::vec3> positions;
    for (int x = 0; x < 64; ++x)
        for (int y = 0; y < 64; ++y)
            for (int z = 0; z < 32; ++z)
                positions.emplace_back(float(x), 0.5f * float(y), 1024.0f * float(z));
    const double steps = double(test::steps_of([&] { prep::weld_exact(positions); }));
    EXPECT_LE(steps, (1 + 1.5) * double(positions.size()));
}

}  // namespace
