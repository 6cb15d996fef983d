// Several UV sets in one pass, and the angular threshold.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "corner_soup.h"
#include "prep/tangents.h"

namespace {

TEST(TangentUvSets, AreWhatEachGivesAlone) {
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        std::mt19937 random(seed);
        test::HostileOptions hostile;
        hostile.quads = seed & 1;
        hostile.nans = seed & 2;
        const test::CornerSoup soup = test::hostile_soup(random, hostile);
        const auto shared = test::share_values(soup);
        const prep::TangentInput input = shared.input();
        // The second is the first turned by 90°, the third says nothing.
        std::vector<glm::vec2> turned, constant(shared.uvs.size(), glm::vec2(0.5f));
        for (const glm::vec2& uv : shared.uvs) turned.push_back({-uv.y, uv.x});
        const prep::CornerLayerView<glm::vec2> sets[] = {
            input.uv, {turned, shared.uv_indices}, {constant, shared.uv_indices}};
        const auto together = prep::corner_tangents(input, sets);
        ASSERT_TRUE(together.has_value());
        ASSERT_EQ(together->size(), 3u);
        for (std::size_t s = 0; s < 3; ++s) {
            prep::TangentInput one = input;
            one.uv = sets[s];
            const auto alone = prep::corner_tangents(one);
            ASSERT_TRUE(alone.has_value());
            const auto a = test::flattened((*together)[s]), b = test::flattened(*alone);
            ASSERT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0)
                << "seed " << seed << ", set " << s;
            EXPECT_EQ((*together)[s].fallbacks.size(), alone->fallbacks.size());
        }
    }
}

TEST(TangentUvSets, NoneGiveNoResultAndABadOneIsNamed) {
    std::mt19937 random(1);
    const test::CornerSoup soup = test::hostile_soup(random, {});
    EXPECT_TRUE(prep::corner_tangents(soup.input(), std::span<prep::CornerLayerView<glm::vec2>>())
                    ->empty());
    const prep::CornerLayerView<glm::vec2> sets[] = {soup.input().uv, {}};
    const auto result = prep::corner_tangents(soup.input(), sets);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().code, prep::ErrorCode::invalid);
    EXPECT_EQ(result.error().place, "UV set 1");
}

// Two triangles of a flat sheet that share an edge; the UVs of the second are turned by `degrees`
// about the shared corner, the UV of which both have.
test::CornerSoup hinge(double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    const auto turned = [&](double x, double y) {
        return glm::vec2(std::cos(a) * x - std::sin(a) * y, std::sin(a) * x + std::cos(a) * y);
    };
    test::CornerSoup soup;
    const glm::vec3 n(0, 0, 1);
    soup.add({0, 0, 0}, n, {0, 0});
    soup.add({1, 0, 0}, n, {1, 0});
    soup.add({1, 1, 0}, n, {1, 1});
    soup.end_face();
    // Stretched so that it shares the whole edge and yet has S turned: its third corner decides.
    soup.add({0, 0, 0}, n, {0, 0});
    soup.add({1, 1, 0}, n, {1, 1});
    soup.add({0, 1, 0}, n, turned(0, 1));
    soup.end_face();
    return soup;
}

double angle_between(const glm::vec4& a, const glm::vec4& b) {
    return std::acos(std::min(1.0, glm::dot(glm::dvec3(a), glm::dvec3(b)))) * 180 /
           std::numbers::pi;
}

TEST(TangentThreshold, KeepsApartWhatDiffersByMore) {
    const test::CornerSoup soup = hinge(25);
    prep::TangentOptions options;
    options.angular_threshold = 0;
    const auto apart = test::flattened(*prep::corner_tangents(soup.input(), options));
    const double between = angle_between(apart[0], apart[3]);
    ASSERT_GT(between, 5);
    ASSERT_LT(between, 85);
    // T differs too: the larger of both angles counts, it is below 90°.
    options.angular_threshold = std::numbers::pi / 2;
    const auto together = test::flattened(*prep::corner_tangents(soup.input(), options));
    EXPECT_EQ(std::memcmp(&together[0], &together[3], sizeof together[0]), 0);
    EXPECT_EQ(std::memcmp(&together[2], &together[4], sizeof together[0]), 0);
    options.angular_threshold = 0.9 * between * std::numbers::pi / 180;
    const auto below = test::flattened(*prep::corner_tangents(soup.input(), options));
    EXPECT_EQ(std::memcmp(&below[0], &apart[0], sizeof below[0]), 0);
    EXPECT_EQ(std::memcmp(&below[3], &apart[3], sizeof below[0]), 0);
}

TEST(TangentThreshold, OutOfRangeIsAnError) {
    for (const double bad : {-0.1, 3.2, std::nan("")}) {
        prep::TangentOptions options;
        options.angular_threshold = bad;
        const auto result = prep::corner_tangents(hinge(0).input(), options);
        ASSERT_FALSE(result.has_value()) << bad;
        EXPECT_EQ(result.error().code, prep::ErrorCode::invalid);
    }
}

// Nothing of such a mesh is there but its sizes, which are judged before anything is read.
TEST(TangentLimits, MoreTrianglesOrCornersThanThereAreNumbersForAreRefused) {
    const std::uint32_t index = 0;
    const glm::vec3 point(0);
    const glm::vec2 uv(0);
    const auto refused = [&](std::size_t corners, std::size_t positions) {
        const std::uint32_t offsets[2] = {0, std::uint32_t(corners)};  // one polygon
        prep::TangentInput in;
        in.positions = {&point, positions};
        in.face_offsets = offsets;
        in.corner_vertices = in.normals.indices = in.uv.indices = {&index, corners};
        in.normals.values = {&point, 1};
        in.uv.values = {&uv, 1};
        const auto result = prep::corner_tangents(in);
        return !result && result.error().code == prep::ErrorCode::limit;
    };
    const std::size_t most = std::size_t(1) << 30;
    EXPECT_TRUE(refused(most + 3, 1));                   // a polygon of 2^30 + 1 triangles
    EXPECT_TRUE(refused(3, std::size_t(4) * most - 4));  // with 3 corners, 2^32 − 1 names
    EXPECT_TRUE(refused(most, std::size_t(3) * most - 1));
}

}  // namespace
