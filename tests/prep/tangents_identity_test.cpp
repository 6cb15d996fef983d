// The same bytes whatever the threads, the instruction set and the way the input is indexed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "corner_soup.h"
#include "tangents/accumulate.h"
#include "tangents/one_rings.h"

namespace {

using prep::SimdLevel;
using prep::TangentMode;
using test::CornerSoup;

// A wavy grid with a UV seam, a mirrored half and a patch without UVs: everything that smooth
// meshes have, over several blocks of work.
CornerSoup wavy_grid(int n) {
    const auto vertex = [&](int i, int j, bool mirrored, CornerSoup& soup) {
        const float x = float(i) / float(n), y = float(j) / float(n);
        const float a = 9 * x, b = 7 * y;
        glm::vec3 normal(-0.9f * std::cos(a) * std::cos(b), 0.7f * std::sin(a) * std::sin(b), 1.0f);
        normal = normal / std::sqrt(normal.x * normal.x + normal.y * normal.y + 1.0f);
        glm::vec2 uv(mirrored ? 1 - x : x, y);
        if (i > n / 5 && i < n / 4 && j > n / 5 && j < n / 4) uv = glm::vec2(0.25f);
        soup.add({x, y, 0.1f * std::sin(a) * std::cos(b)}, normal, uv);
    };
    CornerSoup soup;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const bool mirrored = i >= n / 2;
            vertex(i, j, mirrored, soup);
            vertex(i + 1, j, mirrored, soup);
            vertex(i + 1, j + 1, mirrored, soup);
            soup.end_face();
            vertex(i, j, mirrored, soup);
            vertex(i + 1, j + 1, mirrored, soup);
            vertex(i, j + 1, mirrored, soup);
            soup.end_face();
        }
    }
    return soup;
}

void expect_same(const prep::CornerTangents& got, const prep::CornerTangents& want) {
    ASSERT_EQ(got.tangents.indices, want.tangents.indices);
    ASSERT_EQ(got.tangents.values.size(), want.tangents.values.size());
    EXPECT_EQ(std::memcmp(got.tangents.values.data(), want.tangents.values.data(),
                          sizeof(glm::vec4) * got.tangents.values.size()),
              0);
    ASSERT_EQ(got.fallbacks.size(), want.fallbacks.size());
    for (std::size_t i = 0; i < got.fallbacks.size(); ++i) {
        EXPECT_EQ(got.fallbacks[i].corner, want.fallbacks[i].corner);
        EXPECT_EQ(got.fallbacks[i].fault, want.fallbacks[i].fault);
        EXPECT_EQ(got.fallbacks[i].source, want.fallbacks[i].source);
    }
    EXPECT_EQ(got.mirrored_triangles, want.mirrored_triangles);
    EXPECT_EQ(got.degenerate_triangles, want.degenerate_triangles);
}

void expect_same_corners(const prep::CornerTangents& got, const prep::CornerTangents& want) {
    const auto a = test::flattened(got), b = test::flattened(want);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t c = 0; c < a.size(); ++c)
        ASSERT_EQ(std::memcmp(&a[c], &b[c], sizeof a[c]), 0) << "corner " << c;
}

prep::CornerTangents tangents(const prep::TangentInput& input, TangentMode mode, int threads,
                              SimdLevel simd) {
    prep::TangentOptions options;
    options.mode = mode;
    options.threads = threads;
    options.simd = simd;
    auto result = prep::corner_tangents(input, options);
    EXPECT_TRUE(result.has_value());
    return *std::move(result);
}

TEST(TangentsIdentity, SameForAnyThreadCountAndInstructionSet) {
    const CornerSoup soup = wavy_grid(110);
    const auto indexed = test::share_values(soup);
    for (const TangentMode mode :
         {TangentMode::mikktspace, TangentMode::definition, TangentMode::mikktspace_exact}) {
        const auto want = tangents(soup.input(), mode, 1, SimdLevel::scalar);
        const auto want_indexed = tangents(indexed.input(), mode, 1, SimdLevel::scalar);
        expect_same_corners(want_indexed, want);
        for (const SimdLevel simd : {SimdLevel::scalar, SimdLevel::sse4, SimdLevel::avx2,
                                     SimdLevel::avx512, SimdLevel::automatic}) {
            SCOPED_TRACE(to_string(simd));
            if (!prep::simd_available(simd)) continue;
            for (const int threads : {1, 2, 3, 8, 0}) {
                SCOPED_TRACE(threads);
                expect_same(tangents(soup.input(), mode, threads, simd), want);
                expect_same(tangents(indexed.input(), mode, threads, simd), want_indexed);
            }
        }
    }
}

// Two poles of 12 triangles and the equator between them. Every triangle has a UV of its own at its
// pole, so that over the edges to the poles no triangles are neighbours: the stars of the equator,
// rings as far as positions go, part into a left and a right half.
CornerSoup spindle() {
    constexpr int segments = 12;
    CornerSoup soup;
    const auto corner = [&](float turn, float height, float u) {
        const float a = turn * 6.2831853f / segments, r = 1 - std::abs(height);
        const glm::vec3 normal(r * std::cos(a), r * std::sin(a), height);
        soup.add({r * std::cos(a), r * std::sin(a), 0.7f * height}, normal, {u, height});
    };
    for (int j = 0; j < segments; ++j) {
        const float here = float(j), next = float((j + 1) % segments);
        corner(0, 1, here + 0.3f);
        corner(here, 0, here);
        corner(next, 0, here + 1);
        soup.end_face();
        corner(0, -1, here + 0.8f);
        corner(next, 0, here + 1);
        corner(here, 0, here);
        soup.end_face();
    }
    return soup;
}

// At 180° fans are summed while triangles are gone through; below, every vertex has a list of its
// triangles. Where no two directions at a vertex are near opposite both must give the same bits.
TEST(TangentsIdentity, SameWhetherVerticesAreListedOrNot) {
    for (const CornerSoup& soup : {spindle(), wavy_grid(40)}) {
        const auto indexed = test::share_values(soup);
        for (const prep::TangentInput& input : {soup.input(), indexed.input()}) {
            prep::TangentOptions options;
            options.mode = TangentMode::definition;
            const auto at_once = prep::corner_tangents(input, options);
            options.angular_threshold = 3.1f;
            const auto listed = prep::corner_tangents(input, options);
            ASSERT_TRUE(at_once.has_value() && listed.has_value());
            expect_same_corners(*at_once, *listed);
        }
    }
}

CornerSoup in_random_order(const CornerSoup& ordered, std::mt19937& random) {
    std::vector<std::uint32_t> order(ordered.corners() / 3);
    for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
    std::shuffle(order.begin(), order.end(), random);
    CornerSoup shuffled;
    for (const std::uint32_t t : order) {
        for (std::uint32_t c = 3 * t; c < 3 * t + 3; ++c)
            shuffled.add(ordered.positions[c], ordered.normals[c], ordered.uvs[c]);
        shuffled.end_face();
    }
    return shuffled;
}

// So many triangles that threads take ranges of them, in an order in which nearly every vertex is
// in several ranges: what ranges note for each other's vertices is added in the triangles' order.
TEST(TangentsIdentity, SameForManyThreadsOnShuffledTriangles) {
    constexpr int n = 260;  // so many triangles that each thread's share is cut
    const CornerSoup ordered = wavy_grid(n);
    std::mt19937 random(7);
    const CornerSoup shuffled = in_random_order(ordered, random);
    for (const CornerSoup* soup : {&ordered, &shuffled}) {
        const auto indexed = test::share_values(*soup);
        const auto want = tangents(indexed.input(), TangentMode::mikktspace, 1, SimdLevel::scalar);
        for (const int threads : {2, 3, 8})
            expect_same(
                tangents(indexed.input(), TangentMode::mikktspace, threads, SimdLevel::automatic),
                want);
    }
}

// What the streaming path finds, gone through the one way or the other.
struct Streamed {
    bool done = false;
    std::vector<glm::vec4> values;
    std::vector<std::uint8_t> states, flags;
    std::size_t ranges = 0;
};

Streamed streamed(const prep::TangentInput& input, bool scattered, int threads) {
    prep::TangentOptions options;
    options.threads = threads;
    const prep::detail::CornerReader read{input, {}, true};
    const auto triangles = prep::detail::tangent_triangles(input, true, threads);
    const auto rings = prep::detail::welded_vertices(input, triangles, {}, threads);
    const prep::detail::BlockContributions contributions(read, triangles, options);
    auto valences = prep::detail::count_valences(triangles, rings.vertices, rings.positions,
                                                 scattered, threads, nullptr);
    prep::detail::ContributionStore store;
    Streamed result;
    result.values.resize(rings.positions);
    result.done = prep::detail::accumulate(read, triangles, rings.vertices, contributions,
                                           {-1.0f, true}, options, valences, store, result.values);
    result.states.assign(valences.states.data(), valences.states.data() + valences.states.size());
    result.flags.assign(store.triangle_flags.data(),
                        store.triangle_flags.data() + store.triangle_flags.size());
    result.ranges = valences.ranges.size();
    return result;
}

// One range that fetches ahead, and as many as threads like: each way on meshes of either order.
TEST(TangentsIdentity, ScatteredAndPlainWaysGiveTheSame) {
    std::mt19937 random(19);
    int both = 0;
    for (int round = 0; round < 60; ++round) {
        SCOPED_TRACE("round " + std::to_string(round));
        const bool large = round % 10 == 0;
        CornerSoup soup = large ? wavy_grid(100 + round) : test::seamed_surface(random);
        if (round % 4 != 3) soup = in_random_order(soup, random);
        const auto indexed = test::share_values(soup);
        const Streamed want = streamed(indexed.input(), false, 1);
        for (const int threads : {1, 2, 8}) {
            for (const bool scattered : {false, true}) {
                const Streamed got = streamed(indexed.input(), scattered, threads);
                EXPECT_TRUE(!scattered || got.ranges == 1);
                EXPECT_TRUE(!large || got.done);
                if (!got.done || !want.done) continue;
                ++both;
                ASSERT_EQ(std::memcmp(got.values.data(), want.values.data(),
                                      sizeof(glm::vec4) * want.values.size()),
                          0);
                ASSERT_EQ(got.states, want.states);
                ASSERT_EQ(got.flags, want.flags);
            }
        }
    }
    EXPECT_GE(both, 36);
}

// The order alone tells; few triangles fit in a cache in any.
TEST(TangentsIdentity, ScatteredOrderIsToldFromTheVertices) {
    std::mt19937 random(5);
    const auto ordered = test::share_values(wavy_grid(60));
    EXPECT_FALSE(prep::detail::are_scattered(ordered.vertices, ordered.positions.size()));
    std::vector<std::uint32_t> shuffled(ordered.vertices);
    for (std::size_t t = shuffled.size() / 3; t-- > 1;) {
        const std::size_t other = random() % (t + 1);
        std::swap_ranges(&shuffled[3 * t], &shuffled[3 * t] + 3, &shuffled[3 * other]);
    }
    EXPECT_TRUE(prep::detail::are_scattered(shuffled, ordered.positions.size()));
    EXPECT_FALSE(
        prep::detail::are_scattered(std::span(shuffled).first(3 * 1023), ordered.positions.size()));
    EXPECT_FALSE(prep::detail::are_scattered({}, 0));
}

// Differences of positions times those of UVs pass the largest float: infinite and NaN gradients.
TEST(TangentsIdentity, SameWhereGradientsOverflow) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> any(1, 2);
    for (const auto& [size, span] : {std::pair(1e18f, 1e21f), {1e15f, 1e25f}, {1e10f, 1e35f}}) {
        for (const bool along_u : {false, true}) {
            CornerSoup soup;
            for (int t = 0; t < 61; ++t) {
                for (int c = 0; c < 3; ++c) {
                    const float x = any(random) * (c == 1 ? 3.0f : 1.0f) + 10.0f * float(t);
                    const float y = any(random) * (c == 2 ? 3.0f : 1.0f);
                    const glm::vec2 uv(0.5f * float(c), (c == 1 ? 1.0f : 0.6f * float(c)) * span);
                    soup.add({x * size, y * size, 0}, {0, 0, 1},
                             along_u ? glm::vec2(uv.y, uv.x) : uv);
                }
                soup.end_face();
            }
            for (const TangentMode mode : {TangentMode::mikktspace, TangentMode::definition,
                                           TangentMode::mikktspace_exact}) {
                const auto want = tangents(soup.input(), mode, 1, SimdLevel::scalar);
                for (const SimdLevel simd : {SimdLevel::sse4, SimdLevel::avx2, SimdLevel::avx512})
                    if (prep::simd_available(simd))
                        expect_same(tangents(soup.input(), mode, 1, simd), want);
            }
        }
    }
}

TEST(TangentsIdentity, SameOnHostileSoups) {
    for (std::uint32_t seed = 0; seed < 600; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        test::HostileOptions hostile;
        hostile.quads = seed & 1;
        hostile.minus_zeros = seed & 2;
        hostile.nans = seed & 4;
        hostile.odd_scales = seed & 8;
        const CornerSoup soup = test::hostile_soup(random, hostile);
        const auto indexed = test::share_values(soup);
        for (const TangentMode mode :
             {TangentMode::mikktspace, TangentMode::definition, TangentMode::mikktspace_exact}) {
            const auto want = tangents(soup.input(), mode, 1, SimdLevel::scalar);
            for (const SimdLevel simd : {SimdLevel::sse4, SimdLevel::avx2, SimdLevel::avx512}) {
                if (prep::simd_available(simd))
                    expect_same(tangents(soup.input(), mode, 2, simd), want);
            }
            if (!hostile.nans)
                expect_same_corners(tangents(indexed.input(), mode, 2, SimdLevel::automatic), want);
            if (testing::Test::HasFailure()) return;
        }
    }
}

}  // namespace
