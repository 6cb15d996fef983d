// The same bytes whatever the threads, the instruction set and the way the input is indexed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "corner_soup.h"
#include "simd_levels.h"
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
        for (const SimdLevel simd : test::every_level()) {
            SCOPED_TRACE(to_string(simd));
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
    std::vector<std::uint32_t> places;
};

Streamed streamed(const prep::TangentInput& input, bool scattered, int threads) {
    prep::TangentOptions options;
    options.threads = threads;
    const prep::detail::CornerReader read{input, {}, true};
    const auto triangles = prep::detail::tangent_triangles(input, true, threads);
    const auto rings = prep::detail::welded_vertices(input, triangles, {}, threads);
    const prep::detail::BlockContributions contributions(read, triangles, options);
    auto valences = scattered
                        ? prep::detail::uncounted_valences(triangles, rings.positions, threads)
                        : prep::detail::count_valences(triangles, rings.vertices, rings.positions,
                                                       threads, nullptr);
    prep::detail::ContributionStore store;
    Streamed result;
    result.values.resize(rings.positions);
    result.done = (scattered ? prep::detail::accumulate_scattered : prep::detail::accumulate)(
        read, triangles, rings.vertices, contributions, {-1.0f, true}, options, valences, store,
        result.values);
    if (!result.done) return result;
    result.values.resize(valences.used);
    result.places.assign(valences.places.data(), valences.places.data() + valences.places.size());
    result.states.assign(valences.states.data(), valences.states.data() + valences.states.size());
    result.flags.assign(store.triangle_flags.data(),
                        store.triangle_flags.data() + store.triangle_flags.size());
    return result;
}

// Added as they come, and sorted by vertex first: each way on meshes of either order.
TEST(TangentsIdentity, ScatteredAndPlainWaysGiveTheSame) {
    std::mt19937 random(19);
    int both = 0;
    for (int round = 0; round < 60; ++round) {
        SCOPED_TRACE("round " + std::to_string(round));
        const bool large = round % 10 == 0;
        CornerSoup soup = large ? wavy_grid(100 + round) : test::seamed_surface(random);
        if (round % 4 != 3) soup = in_random_order(soup, random);
        auto indexed = test::share_values(soup);
        // Vertices that no triangle has, at either end.
        if (round % 3 == 1) indexed.positions.resize(indexed.positions.size() + 70);
        if (round % 3 == 2) {
            indexed.positions.insert(indexed.positions.begin(), 5, glm::vec3(7));
            for (std::uint32_t& v : indexed.vertices) v += 5;
        }
        const Streamed want = streamed(indexed.input(), false, 1);
        for (const int threads : {1, 2, 3, 8}) {
            for (const bool scattered : {false, true}) {
                const Streamed got = streamed(indexed.input(), scattered, threads);
                EXPECT_TRUE(!large || got.done);
                if (!got.done || !want.done) continue;
                ++both;
                ASSERT_EQ(std::memcmp(got.values.data(), want.values.data(),
                                      sizeof(glm::vec4) * want.values.size()),
                          0);
                ASSERT_EQ(got.values.size(), want.values.size());
                ASSERT_EQ(got.places, want.places);
                ASSERT_EQ(got.states, want.states);
                ASSERT_EQ(got.flags, want.flags);
            }
        }
    }
    EXPECT_GE(both, 48);
}

// MikkTSpace in plain loops, for vertices that are one fan each: InitTriInfo's and EvalTspace's
// operations, summed in the order of the triangles, or against it.
std::vector<glm::vec3> plain_tangents(const test::IndexedSoup& mesh, bool backwards) {
    const auto dot = [](const glm::vec3& a, const glm::vec3& b) {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    };
    const auto scaled = [](float s, const glm::vec3& v) {
        return glm::vec3(s * v.x, s * v.y, s * v.z);
    };
    const auto unit = [&](const glm::vec3& v) { return scaled(1.0f / std::sqrt(dot(v, v)), v); };
    std::vector<glm::vec3> sums(mesh.positions.size(), glm::vec3(0));
    const std::size_t triangles = mesh.vertices.size() / 3;
    for (std::size_t i = 0; i < triangles; ++i) {
        const std::size_t first = 3 * (backwards ? triangles - 1 - i : i);
        const auto p = [&](std::size_t k) { return mesh.positions[mesh.vertices[first + k % 3]]; };
        const auto uv = [&](std::size_t k) { return mesh.uvs[mesh.uv_indices[first + k]]; };
        const glm::vec2 a = uv(1) - uv(0), b = uv(2) - uv(0);
        const float area = a.x * b.y - a.y * b.x;
        glm::vec3 s = scaled(b.y, p(1) - p(0)) - scaled(a.y, p(2) - p(0));
        s = scaled((area > 0 ? 1.0f : -1.0f) / std::sqrt(dot(s, s)), s);
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3 n = mesh.normals[mesh.normal_indices[first + k]];
            const auto on_plane = [&](const glm::vec3& v) {
                return unit(v - scaled(dot(n, v), n));
            };
            const glm::vec3 one = on_plane(p(k + 2) - p(k)), two = on_plane(p(k + 1) - p(k));
            const float cosine = std::clamp(dot(one, two), -1.0f, 1.0f);
            const auto angle = float(std::acos(double(cosine)));
            glm::vec3& sum = sums[mesh.vertices[first + k]];
            sum = sum + scaled(angle, on_plane(s));
        }
    }
    for (glm::vec3& sum : sums) sum = unit(sum);
    return sums;
}

TEST(TangentsIdentity, ScatteredTrianglesAreSummedInTheirOrder) {
    constexpr std::uint32_t n = 140;
    test::IndexedSoup mesh;
    for (std::uint32_t i = 0; i <= n; ++i) {
        for (std::uint32_t j = 0; j <= n; ++j) {
            const float x = float(i) / n, y = float(j) / n, a = 9 * x, b = 7 * y;
            mesh.positions.emplace_back(x, y, 0.1f * std::sin(a) * std::cos(b));
            const glm::vec3 normal(-0.9f * std::cos(a) * std::cos(b),
                                   0.7f * std::sin(a) * std::sin(b), 1.0f);
            mesh.normals.push_back(glm::normalize(normal));
            mesh.uvs.emplace_back(x + 0.1f * y, y + 0.05f * std::sin(a));
        }
    }
    std::mt19937 random(23);
    std::vector<std::uint32_t> order(2 * n * n);
    for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
    std::shuffle(order.begin(), order.end(), random);
    for (const std::uint32_t t : order) {
        const std::uint32_t at = t / 2 / n * (n + 1) + t / 2 % n, across = at + n + 2;
        for (const std::uint32_t v :
             t % 2 == 0 ? std::array{at, at + n + 1, across} : std::array{at, across, at + 1})
            mesh.vertices.push_back(v);
        mesh.end_face();
    }
    mesh.normal_indices = mesh.uv_indices = mesh.vertices;
    ASSERT_TRUE(prep::detail::are_scattered(mesh.vertices, mesh.positions.size()));

    const auto want = plain_tangents(mesh, false), backwards = plain_tangents(mesh, true);
    std::size_t different = 0;
    for (std::size_t v = 0; v < want.size(); ++v) different += want[v] != backwards[v];
    EXPECT_GT(different, want.size() / 4);  // the order can be told from the result
    for (const SimdLevel simd : test::every_level()) {
        for (const int threads : {1, 2, 3, 4, 5, 6, 7, 8}) {
            SCOPED_TRACE(std::string(to_string(simd)) + ", threads " + std::to_string(threads));
            const auto got = tangents(mesh.input(), TangentMode::mikktspace, threads, simd);
            for (std::size_t c = 0; c < mesh.vertices.size(); ++c) {
                const glm::vec4 tangent = got.tangents.values[got.tangents.indices[c]];
                ASSERT_EQ(glm::vec3(tangent), want[mesh.vertices[c]]) << "corner " << c;
                ASSERT_EQ(tangent.w, -1.0f);
            }
        }
    }
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
    // Nor where there are more vertices than corners: values would not fit by number.
    for (const std::uint32_t apart : {5u, 6u}) {
        std::vector<std::uint32_t> spread(shuffled);
        for (std::uint32_t& v : spread) v *= apart;
        const std::size_t count = apart * ordered.positions.size();
        EXPECT_EQ(count <= spread.size(), apart == 5);
        EXPECT_EQ(prep::detail::are_scattered(spread, count), apart == 5);
    }
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
