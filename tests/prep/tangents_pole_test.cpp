// Vertices that thousands of triangles share: the same tangents, and no quadratic time.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>

#include "corner_soup.h"
#include "prep/tangents.h"
#include "steps.h"

namespace {

constexpr double pi = std::numbers::pi;

struct Pole {
    test::IndexedSoup mesh;
    std::vector<double> uv_angles;  // of the rim, ascending
};

// A disc around vertex 0, each triangle (0, i, i + 1), facing +z. The rim's UVs are on the unit
// circle about the pole's, at uv_angle(angle of the position).
Pole make_pole(std::uint32_t valence, const std::function<double(double)>& uv_angle) {
    Pole pole;
    test::IndexedSoup& m = pole.mesh;
    m.offsets = {0};
    m.positions = {{0, 0, 0}};
    m.uvs = {{0, 0}};
    m.normals = {{0, 0, 1}};
    // One more at the end of the turn: the UVs need not close.
    for (std::uint32_t i = 0; i <= valence; ++i) {
        const double a = 2 * pi * i / valence, u = uv_angle(a);
        if (i < valence) m.positions.push_back({std::cos(a), std::sin(a), 0});
        m.uvs.push_back({std::cos(u), std::sin(u)});
    }
    for (std::uint32_t i = 0; i < valence; ++i) {
        for (const std::uint32_t v : {0u, i + 1, (i + 1) % valence + 1}) m.vertices.push_back(v);
        for (const std::uint32_t t : {0u, i + 1, i + 2}) m.uv_indices.push_back(t);
        m.offsets.push_back(3 * (i + 1));
    }
    m.normal_indices.assign(m.vertices.size(), 0);
    return pole;
}

std::vector<glm::vec4> tangents(const Pole& pole, prep::TangentMode mode,
                                double threshold = std::numbers::pi) {
    prep::TangentOptions options;
    options.mode = mode;
    options.angular_threshold = threshold;
    options.uv_origin = prep::UvOrigin::bottom_left;
    const auto result = prep::corner_tangents(pole.mesh.input(), options);
    EXPECT_TRUE(result.has_value());
    return test::flattened(*result);
}

double same(double a) {
    return a;
}

TEST(TangentPole, ThatLeansOneWayHasTheDefinitionsBits) {
    for (const std::uint32_t valence : {20u, 100u, 3000u}) {
        const Pole pole = make_pole(valence, same);
        const auto made = tangents(pole, prep::TangentMode::mikktspace);
        const auto defined = tangents(pole, prep::TangentMode::definition);
        EXPECT_EQ(std::memcmp(made.data(), defined.data(), sizeof made[0] * made.size()), 0)
            << valence;
        EXPECT_NEAR(made[0].x, 1.0f, 1e-6);
    }
}

// UVs that run three times around the pole, unevenly: S points everywhere. What each triangle gets
// is the sum of those within the threshold of its own S.
TEST(TangentPole, OfAllDirectionsSumsWhatIsWithinTheThreshold) {
    constexpr std::uint32_t valence = 2500;
    const Pole pole = make_pole(valence, [](double a) { return 3 * a + 0.8 * std::sin(a); });
    std::vector<double> directions(valence);
    for (std::uint32_t t = 0; t < valence; ++t) {
        const auto at = [&](std::uint32_t k) {
            return glm::dvec2(pole.mesh.positions[pole.mesh.vertices[3 * t + k]]);
        };
        const auto uv = [&](std::uint32_t k) {
            return glm::dvec2(pole.mesh.uvs[pole.mesh.uv_indices[3 * t + k]]);
        };
        const glm::dvec2 s = uv(2).y * at(1) - uv(1).y * at(2);
        directions[t] = std::atan2(s.y, s.x);
    }
    for (const double degrees : {180.0, 60.0}) {
        const double threshold = degrees * pi / 180;
        const auto made = tangents(pole, prep::TangentMode::mikktspace, threshold);
        for (std::uint32_t i = 0; i < valence; i += 7) {
            glm::dvec2 sum(0.0);
            for (std::uint32_t j = 0; j < valence; ++j) {
                const double between =
                    std::abs(std::remainder(directions[i] - directions[j], 2 * pi));
                if (between < std::min(threshold, pi - 3.5e-4))
                    sum += glm::dvec2(std::cos(directions[j]), std::sin(directions[j]));
            }
            const double angle = std::abs(std::remainder(
                std::atan2(double(made[3 * i].y), double(made[3 * i].x)) - std::atan2(sum.y, sum.x),
                2 * pi));
            // One triangle more or less, of hundreds, at the ends of the arc.
            EXPECT_LT(angle, 0.01) << "triangle " << i << ", threshold " << degrees;
        }
    }
}

// Nothing is left of the sum: each triangle keeps its own direction, about the pole.
TEST(TangentPole, OfTangentsThatCancelKeepsThemApart) {
    const Pole pole = make_pole(3001, [](double a) { return 2 * a; });
    const auto made = tangents(pole, prep::TangentMode::mikktspace);
    double turned = 0;
    for (std::uint32_t t = 1; t < 3001; ++t)
        turned += std::remainder(std::atan2(made[3 * t].y, made[3 * t].x) -
                                     std::atan2(made[3 * t - 3].y, made[3 * t - 3].x),
                                 2 * pi);
    EXPECT_NEAR(std::abs(turned), 2 * pi, 0.01);
}

// Some looks at each triangle, in place of all pairs: 10¹⁰, which took minutes and 40 GB.
TEST(TangentPole, OfAHundredThousandTrianglesLooksAtEachAFewTimes) {
    for (const double times : {1.0, 2.0}) {
        const Pole pole = make_pole(100'000, [&](double a) { return times * a; });
        std::vector<glm::vec4> made;
        const std::uint64_t looks =
            test::steps_of([&] { made = tangents(pole, prep::TangentMode::mikktspace); });
        for (const glm::vec4& t : made) {
            ASSERT_NEAR(glm::length(glm::dvec3(t)), 1.0, 1e-6);
            ASSERT_EQ(t.z, 0.0f);
        }
        // Each end of an arc goes around three times at most; where all tangents point one way,
        // nobody looks.
        EXPECT_LE(looks, 7u * 100'000u);
        if (times == 2) {
            EXPECT_GE(looks, 100'000u);
        }
    }
}

}  // namespace
