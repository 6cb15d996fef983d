// Single cases of tangents with a closed form: which diagonal of a quad, what is counted, and what
// stands in where the definition gives nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "corner_soup.h"
#include "prep/tangents.h"
#include "simd_levels.h"

namespace {

using prep::TangentFault;
using prep::TangentSource;
using test::CornerSoup;

struct Corner {
    glm::vec3 position;
    glm::vec2 uv;
    glm::vec3 normal{0, 0, 1};
};

void add_face(CornerSoup& soup, std::initializer_list<Corner> corners) {
    for (const Corner& c : corners) soup.add(c.position, c.normal, c.uv);
    soup.end_face();
}

struct Made {
    std::vector<glm::vec4> tangents;
    prep::CornerTangents whole;
};

Made make(const CornerSoup& soup, prep::TangentMode mode = prep::TangentMode::mikktspace,
          prep::SimdLevel simd = prep::SimdLevel::automatic) {
    prep::TangentOptions options;
    options.mode = mode;
    options.simd = simd;
    options.uv_origin = prep::UvOrigin::bottom_left;
    auto result = prep::corner_tangents(soup.input(), options);
    EXPECT_TRUE(result.has_value());
    return {test::flattened(*result), *std::move(result)};
}

void expect_near(const glm::vec4& tangent, const glm::vec3& direction, float w) {
    const glm::vec3 unit = glm::normalize(direction);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(tangent[k], unit[k], 1e-6);
    EXPECT_EQ(tangent.w, w);
}

void expect_fallback(const Made& made, std::uint32_t corner, TangentFault fault,
                     TangentSource source) {
    for (const auto& f : made.whole.fallbacks) {
        if (f.corner != corner) continue;
        EXPECT_EQ(int(f.fault), int(fault)) << corner;
        EXPECT_EQ(int(f.source), int(source)) << corner;
        return;
    }
    ADD_FAILURE() << "no fallback at corner " << corner;
}

// Both diagonals are as long as each other in the texture and in space, though the quad is bent:
// the definition cuts from the first corner. Its second corner then sees the plane z = x alone, and
// dP/du = (1, 0, 1) on the plane of its normal.
TEST(TangentCases, AQuadWithEqualDiagonalsIsCutFromItsFirstCorner) {
    const glm::vec3 n(0, 0.6f, 0.8f);
    CornerSoup soup;
    add_face(soup, {{{0, 0, 0}, {0, 0}, n},
                    {{1, 0, 1}, {1, 0}, n},
                    {{1, 1, 0}, {1, 1}, n},
                    {{0, 1, 1}, {0, 1}, n}});
    for (const auto mode : {prep::TangentMode::mikktspace, prep::TangentMode::definition}) {
        const Made made = make(soup, mode);
        expect_near(made.tangents[1], {1, -0.48f, 0.36f}, 1);
        expect_near(made.tangents[3], {1, 0.48f, -0.36f}, 1);
    }
    // The shorter one in the texture goes first, though it is the longer one in space.
    soup = CornerSoup();
    add_face(soup, {{{0, 0, 0}, {0, 0}, n},
                    {{1, 0, 1}, {0.9f, 0.1f}, n},
                    {{1, 1, 0}, {1, 1}, n},
                    {{0, 1, 0.5f}, {0.1f, 0.9f}, n}});
    // 1–3: the first corner sees the triangle 0, 1, 3.
    const glm::dvec3 d1(1, 0, 1), d2(0, 1, 0.5);
    const glm::dvec3 s = 0.9 * d1 - 0.1 * d2,
                     on_plane = s - glm::dot(s, glm::dvec3(n)) * glm::dvec3(n);
    expect_near(make(soup).tangents[0], on_plane, 1);
}

TEST(TangentCases, MirroredTrianglesAreThoseThatTakePart) {
    CornerSoup soup;
    // A quad whose second half has no area but UVs that run backwards; a mirrored quad; a good one;
    // one whose UVs say nothing.
    add_face(
        soup,
        {{{0, 0, 0}, {0, 0}}, {{1, 0, 0}, {1, 0}}, {{1, 1, 0}, {1, 1}}, {{1, 1, 0}, {2, 0.5f}}});
    add_face(
        soup,
        {{{3, 0, 0}, {0, 0}}, {{4, 0, 0}, {-1, 0}}, {{4, 1, 0}, {-1, 1}}, {{3, 1, 0}, {0, 1}}});
    add_face(soup,
             {{{6, 0, 0}, {0, 0}}, {{7, 0, 0}, {1, 0}}, {{7, 1, 0}, {1, 1}}, {{6, 1, 0}, {0, 1}}});
    add_face(soup, {{{9, 0, 0}, {0, 0}}, {{9, 1, 0}, {0, 0}}, {{8, 1, 0}, {0, 0}}});
    const Made made = make(soup);
    EXPECT_EQ(made.whole.mirrored_triangles, 2u);
    EXPECT_EQ(made.whole.degenerate_triangles, 1u);
}

// dP/du runs along the normal; across dP/dv there is one direction left, and w tells which side.
TEST(TangentCases, WhereUGoesAlongTheNormalTheBitangentDecides) {
    for (const float u : {1.0f, -1.0f}) {
        CornerSoup soup;
        add_face(soup, {{{0, 0, 0}, {0, 0}}, {{0, 0, 1}, {u, 0}}, {{0, 1, 0}, {0, 1}}});
        const Made made = make(soup);
        for (std::uint32_t c = 0; c < 3; ++c) {
            // B = w · N × T is dP/dv = y.
            expect_near(made.tangents[c], {u, 0, 0}, u);
            const glm::vec3 b =
                made.tangents[c].w * glm::cross(glm::vec3(0, 0, 1), glm::vec3(made.tangents[c]));
            EXPECT_NEAR(b.y, 1, 1e-6);
        }
        ASSERT_EQ(made.whole.fallbacks.size(), 3u);
        for (const auto& f : made.whole.fallbacks)
            EXPECT_EQ(int(f.source), int(TangentSource::bitangent));
    }
}

// Faults are what the header says of the definition's own result. Where dP/du runs along a normal
// whose float length is not quite 1, rounding leaves some of it: along the normal again.
TEST(TangentCases, FaultsNameWhatTheDefinitionGives) {
    std::array<int, 7> met{};
    for (int i = 0; i < 600; ++i) {
        const glm::vec3 along(float(i % 7) - 3, float(i / 7 % 5) - 2, 1 + float(i / 35 % 9));
        const glm::vec3 n = glm::normalize(along);
        const glm::vec3 aside = 1e-7f * float(i % 4) * glm::vec3(1, -2, 0.5f);
        CornerSoup soup;
        add_face(
            soup,
            {{{0, 0, 0}, {0, 0}, n}, {2.0f * along + aside, {1, 0}, n}, {{3, 1, 0}, {0, 1}, n}});
        const auto defined = make(soup, prep::TangentMode::definition).tangents;
        const Made made = make(soup);
        for (std::uint32_t c = 0; c < 3; ++c) {
            const glm::dvec3 t{glm::vec3(defined[c])};
            const double length = glm::length(t);
            const double sine = std::abs(glm::dot(t, glm::normalize(glm::dvec3(n))));
            const auto expected = length == 0                   ? TangentFault::vanished
                                  : std::abs(length - 1) > 1e-6 ? TangentFault::not_unit
                                  : sine > 0.999                ? TangentFault::along_normal
                                                                : TangentFault::not_orthogonal;
            bool told = false;
            for (const auto& f : made.whole.fallbacks) {
                if (f.corner != c) continue;
                told = true;
                ++met[std::size_t(f.fault)];
                EXPECT_EQ(int(f.fault), int(expected)) << "case " << i << ", " << sine;
            }
            EXPECT_EQ(told, length == 0 || std::abs(length - 1) > 1e-6 || sine > 1e-6) << i;
        }
    }
    EXPECT_GT(met[std::size_t(TangentFault::vanished)], 20);
    EXPECT_GT(met[std::size_t(TangentFault::along_normal)], 20);
    EXPECT_GT(met[std::size_t(TangentFault::not_orthogonal)], 20);
}

// A corner without a normal takes what its face's UVs say, all of its triangles' together.
TEST(TangentCases, TheGradientIsThatOfTheWholeFace) {
    CornerSoup soup;
    // The first triangle, 0–1–2, has neither area nor UV area.
    add_face(soup, {{{0, 0, 0}, {0, 0}},
                    {{1, 0, 0}, {0, 1}, {0, 0, 0}},
                    {{2, 0, 0}, {0, 2}},
                    {{0, 1, 0}, {-1, 0}}});
    const Made made = make(soup);
    expect_fallback(made, 1, TangentFault::no_normal, TangentSource::gradient);
    // u falls along y.
    expect_near(made.tangents[1], {0, -1, 0}, 1);
}

// Three triangles that meet in one point alone: the middle one's UVs say nothing. The lower of the
// two good corners there gives it tangent and sign.
TEST(TangentCases, OfTwoSignsAtAPointTheLowerCornersIsTaken) {
    const auto good = [](CornerSoup& soup, float u, float at) {
        add_face(soup, {{{0, 0, 0}, {0, 0}},
                        {{at, 1, 0}, {at * u, 1}},
                        {{at - 0.5f, 1, 0}, {(at - 0.5f) * u, 1}}});
    };
    for (const float first : {1.0f, -1.0f}) {
        CornerSoup soup;
        good(soup, first, 2);
        add_face(soup, {{{0, 0, 0}, {0, 0}}, {{0.5f, 1, 0}, {0, 0}}, {{0, 1, 0}, {0, 0}}});
        good(soup, -first, -1);
        const Made made = make(soup);
        expect_near(made.tangents[0], {first, 0, 0}, first);
        expect_near(made.tangents[6], {-first, 0, 0}, -first);
        expect_fallback(made, 3, TangentFault::no_gradient, TangentSource::neighbour);
        expect_near(made.tangents[3], {first, 0, 0}, first);
    }
}

// Two fans of the same vertex: over the edges that three triangles share, the first that leaves
// meets the first that enters. Each triangle's dP/du is turned, so that what is averaged shows.
TEST(TangentCases, FansThatMeetInAVertexAreAveragedApart) {
    for (const auto simd : {prep::SimdLevel::scalar, prep::SimdLevel::automatic}) {
        CornerSoup soup;
        // Two triangles to the right and two to the left of a point, touching in it alone; the
        // texture is turned by 45° on the left.
        const auto triangle = [&](float angle, bool turned) {
            const auto corner = [&](float degrees) {
                const float a = degrees * 3.14159265f / 180;
                const glm::vec3 p(std::cos(a), std::sin(a), 0);
                return Corner{p, turned ? glm::vec2(p.x + p.y, p.y - p.x) : glm::vec2(p)};
            };
            add_face(soup, {{{0, 0, 0}, {0, 0}}, corner(angle), corner(angle + 30)});
        };
        triangle(-30, false);
        triangle(0, false);
        triangle(150, true);
        triangle(180, true);
        const Made made = make(soup, prep::TangentMode::definition, simd);
        for (const std::uint32_t c : {0u, 3u}) expect_near(made.tangents[c], {1, 0, 0}, 1);
        for (const std::uint32_t c : {6u, 9u}) expect_near(made.tangents[c], {1, 1, 0}, 1);
    }
}

// Two cones with a common tip, each closed around it; the lower one's texture is turned.
TEST(TangentCases, ConesThatMeetInTheirTipAreAveragedApart) {
    for (const prep::SimdLevel simd : test::every_level()) {
        for (const auto& [upper, lower] : {std::pair{3, 3}, {4, 4}, {3, 5}, {5, 3}}) {
            CornerSoup soup;
            const auto cone = [&](int sides, float down, bool turned) {
                const auto corner = [&](int i) {
                    const float a = 2 * 3.14159265f * float(i % sides) / float(sides);
                    const glm::vec3 p(std::cos(a), std::sin(a), -down);
                    return Corner{
                        p, turned ? glm::vec2(0.9f * p.x + 0.5f * p.y, 0.9f * p.y - 0.5f * p.x)
                                  : glm::vec2(p)};
                };
                for (int i = 0; i < sides; ++i)
                    add_face(soup, {{{0, 0, 0}, {0, 0}}, corner(i), corner(i + 1)});
            };
            cone(upper, 0.1f, false);
            cone(lower, 0.4f, true);
            const Made made = make(soup, prep::TangentMode::definition, simd);
            // Symmetric: what the sides' slopes add cancels around the tip.
            for (int f = 0; f < upper + lower; ++f)
                expect_near(made.tangents[std::size_t(3 * f)],
                            f < upper ? glm::vec3(1, 0, 0) : glm::vec3(0.9f, 0.5f, 0), 1);
        }
    }
}

// Normals that are 1 % off unit: they are made unit first, wherever they stand among good ones.
TEST(TangentCases, NormalsThatAreNotUnitAreMadeSoOnEveryInstructionSet) {
    for (const float length : {1.05f, 0.95f, 3.0f, 0.2f}) {
        CornerSoup soup, unit;
        for (int t = 0; t < 37; ++t) {
            const glm::vec3 n = glm::normalize(glm::vec3(0.3f, 0.1f * float(t % 5), 1.0f));
            const float x = float(t);
            for (CornerSoup* to : {&soup, &unit}) {
                const glm::vec3 own = to == &soup && t % 9 == 4 ? length * n : n;
                add_face(*to, {{{x, 0, 0}, {0, 0}, own},
                               {{x + 0.9f, 0.2f, 0}, {1, 0.1f}, own},
                               {{x, 0.7f, 0.3f}, {0.2f, 1}, own}});
            }
        }
        const auto expected = make(unit).tangents;
        for (const prep::SimdLevel simd : test::every_level()) {
            const Made made = make(soup, prep::TangentMode::mikktspace, simd);
            // Nothing had to stand in.
            EXPECT_TRUE(made.whole.fallbacks.empty()) << length << ' ' << prep::to_string(simd);
            const auto& found = made.tangents;
            for (std::size_t c = 0; c < found.size(); ++c)
                for (int k = 0; k < 4; ++k)
                    ASSERT_NEAR(found[c][k], expected[c][k], 1e-6)
                        << "corner " << c << ", length " << length << ", " << prep::to_string(simd);
        }
    }
}

// The second half of a quad that repeats its third position has no area: its last corner has the
// tangent of the one at the same place.
TEST(TangentCases, ARepeatedCornerOfAQuadHasItsTwinsTangent) {
    CornerSoup soup;
    add_face(
        soup,
        {{{0, 0, 0}, {0, 0}}, {{1, 0, 0}, {0, -1}}, {{1, 1, 0}, {1, -1}}, {{1, 1, 0}, {2, 0.5f}}});
    for (const auto mode : {prep::TangentMode::definition, prep::TangentMode::mikktspace}) {
        const Made made = make(soup, mode);
        for (const glm::vec4& t : made.tangents) expect_near(t, {0, 1, 0}, 1);
    }
}

// The halves of a quad run against each other in the texture: the larger one decides for both.
TEST(TangentCases, OfAQuadsHalvesTheLargerDecidesWhichWayItRuns) {
    for (const bool first_larger : {true, false}) {
        CornerSoup soup;
        const glm::vec2 big(4, -1), small(3, -0.5f);
        add_face(soup, {{{0, 0, 0}, {0, 0}},
                        {{1, 0, 0}, first_larger ? big : small},
                        {{1, 1, 0}, {1, 0}},
                        {{0, 1, 0}, first_larger ? small : big}});
        const Made made = make(soup, prep::TangentMode::definition);
        for (const glm::vec4& t : made.tangents) EXPECT_EQ(t.w, first_larger ? 1.0f : -1.0f);
        EXPECT_EQ(made.whole.mirrored_triangles, first_larger ? 0u : 2u);
    }
}

// A quad and a triangle around a corner, 45° each; dP/du at 0°, 20° and 40°, dP/dv at 90°. With a
// threshold of 30° the halves of the quad sum to 10° and to 20°, the triangle to 30°: the quad's
// corner has the mean of its halves.
TEST(TangentCases, AQuadsCornerHasTheMeanOfItsHalves) {
    const double degree = std::acos(-1.0) / 180;
    const auto v3 = float(1 / (1 - std::tan(20 * degree)));
    const auto v4 = float(v3 * (1 + std::tan(40 * degree)));
    CornerSoup soup;
    add_face(soup,
             {{{0, 0, 0}, {0, 0}}, {{1, 0, 0}, {1, 0}}, {{1, 1, 0}, {1, 1}}, {{0, 1, 0}, {0, v3}}});
    add_face(soup, {{{0, 0, 0}, {0, 0}}, {{0, 1, 0}, {0, v3}}, {{-1, 1, 0}, {-1, v4}}});
    prep::TangentOptions options;
    options.mode = prep::TangentMode::definition;
    options.uv_origin = prep::UvOrigin::bottom_left;
    options.angular_threshold = 30 * degree;
    const auto result = prep::corner_tangents(soup.input(), options);
    ASSERT_TRUE(result.has_value());
    const auto tangents = test::flattened(*result);
    const auto at = [&](double angle) {
        return glm::vec3(std::cos(angle * degree), std::sin(angle * degree), 0);
    };
    expect_near(tangents[0], at(15), 1);
    expect_near(tangents[4], at(30), 1);
}

// A plane of many triangles, cut into islands whose textures run along x or along the diagonal.
// Positions and normals are shared, some positions are nobody's: every corner's tangent is known,
// in order or in none, for any number of threads.
void expect_islands(bool shuffled) {
    constexpr std::uint32_t n = 180;
    std::mt19937 random(5);
    test::IndexedSoup soup;
    soup.normals = {{0, 0, 1}};
    std::vector<std::uint32_t> place(std::size_t(n + 1) * (n + 1));
    for (std::uint32_t v = 0; v < place.size(); ++v) {
        if (random() % 9 == 0) soup.positions.emplace_back(-5.0f);  // of no triangle
        place[v] = std::uint32_t(soup.positions.size());
        soup.positions.emplace_back(float(v % (n + 1)), float(v / (n + 1)), 0.0f);
    }
    const std::size_t vertices = soup.positions.size();
    for (const bool turned : {false, true})
        for (const glm::vec3& p : soup.positions)
            soup.uvs.push_back(turned ? glm::vec2(p.x + p.y, p.y - p.x) : glm::vec2(p.x, p.y));
    std::vector<std::uint32_t> order(2 * n * n);
    for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
    if (shuffled) std::shuffle(order.begin(), order.end(), random);
    std::vector<bool> diagonal;
    for (const std::uint32_t t : order) {
        const std::uint32_t x = t / 2 % n, y = t / 2 / n, a = y * (n + 1) + x;
        const bool turned = (x / 30 + y / 30) % 2 == 1;
        for (const std::uint32_t v :
             {a, t % 2 ? a + n + 2 : a + 1, t % 2 ? a + n + 1 : a + n + 2}) {
            soup.vertices.push_back(place[v]);
            soup.normal_indices.push_back(0);
            soup.uv_indices.push_back(place[v] + (turned ? std::uint32_t(vertices) : 0));
        }
        diagonal.push_back(turned);
        soup.end_face();
    }
    const glm::vec4 half(std::sqrt(0.5f), std::sqrt(0.5f), 0, 1);
    prep::TangentOptions options;
    options.uv_origin = prep::UvOrigin::bottom_left;
    for (const int threads : {1, 2, 4}) {
        options.threads = threads;
        const auto result = prep::corner_tangents(soup.input(), options);
        ASSERT_TRUE(result.has_value());
        EXPECT_TRUE(result->fallbacks.empty());
        const auto tangents = test::flattened(*result);
        for (std::size_t c = 0; c < tangents.size(); ++c) {
            const glm::vec4 expected = diagonal[c / 3] ? half : glm::vec4(1, 0, 0, 1);
            ASSERT_LT(glm::distance(tangents[c], expected), 1e-6f)
                << "corner " << c << " with " << threads << " threads";
        }
    }
}

TEST(TangentCases, IslandsStayApartForAnyThreadCount) {
    expect_islands(false);
}

TEST(TangentCases, IslandsInNoOrderStayApartForAnyThreadCount) {
    expect_islands(true);
}

}  // namespace
