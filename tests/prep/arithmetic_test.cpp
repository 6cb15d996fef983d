// What the geometry stands on, held against arithmetic of other kinds: long doubles, rationals,
// brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <tuple>

#include "base/disjoint_sets.h"
#include "base/srgb.h"
#include "exact.h"
#include "exact/arc_tangent.h"
#include "exact/difference_of_products.h"
#include "exact/orient2d.h"
#include "exact/reproducible_sum.h"
#include "prep/simd.h"
#include "simd_levels.h"
#include "surface/corner_tree.h"
#include "surface/position_filter.h"
#include "surface/vertex_corners.h"
#include "surface/weld.h"
#include "tangents/contributions.h"

namespace {

using exact::Rational;
using prep::detail::angle_of;
using Index = std::uint32_t;

// The arc tangent's relative error, against the C library in long double.
long double angle_error(double sine, double cosine) {
    const long double truth = std::atan2(static_cast<long double>(sine), cosine);
    return std::abs(angle_of(sine, cosine) - truth) / truth;
}

TEST(ArcTangent, StaysWithinItsBound) {
    if (std::numeric_limits<long double>::digits < 64)
        GTEST_SKIP() << "long double is no better than double here";
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> exponent(-60, 0), fraction(0.5, 1);
    long double largest = 0;
    const auto measure = [&](double sine, double cosine) {
        for (const auto& [s, c] : {std::pair{sine, cosine}, std::pair{cosine, sine}})
            for (const double sign : {1.0, -1.0})
                largest = std::max(largest, angle_error(s, sign * c));
    };
    for (int i = 0; i < 40000; ++i) {
        measure(fraction(random), std::exp2(-exponent(random)));
        measure(fraction(random), fraction(random));
    }
    // Beside the places where another entry of the table begins, the series has farthest to go.
    for (int k = 0; k <= 16; ++k)
        for (int step = -3; step <= 3; ++step)
            measure(std::max(1e-9, k / 16.0 + step * 0x1p-52), 1.0);
    EXPECT_LE(largest, 0x1p-51L);
    // The bound is not there for comfort: the error comes near it.
    EXPECT_GT(largest, 0x1p-53L);
}

TEST(ArcTangent, IsExactAtTheEighthTurns) {
    const double pi = prep::detail::pi;
    EXPECT_EQ(pi, std::acos(-1.0));
    EXPECT_EQ(angle_of(0, 2), 0.0);
    EXPECT_EQ(angle_of(3, 3), pi / 4);
    EXPECT_EQ(angle_of(5, 0), pi / 2);
    EXPECT_EQ(angle_of(1, -1), pi - pi / 4);
    EXPECT_EQ(angle_of(0, -1), pi);
}

Rational rational(double x) {
    return Rational(x);
}

// Two numbers of full precision whose product nearly is c · d.
TEST(DifferenceOfProducts, HasOneRoundingAndIsZeroWhereTheTruthIs) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> value(1, 2);
    for (int i = 0; i < 2000; ++i) {
        const double a = value(random), b = value(random), c = value(random);
        const prep::detail::TwoDoubles p = prep::detail::two_product(a, b);
        ASSERT_EQ(rational(p.high) + rational(p.low), rational(a) * rational(b)) << a << ' ' << b;
        const double d = a * b / c;
        const double got = prep::detail::difference_of_products(a, b, c, d);
        const Rational truth = rational(a) * rational(b) - rational(c) * rational(d);
        const Rational error = abs(rational(got) - truth);
        // 2⁻⁵³ of the result, 2⁻¹⁰³ of the products.
        const Rational bound = abs(truth) * rational(0x1p-53) + rational(0x1p-101);
        ASSERT_LE(error, bound) << a << ' ' << b << ' ' << c << ' ' << d;
    }
    // a · b and b · a are the same to the last bit.
    EXPECT_EQ(prep::detail::difference_of_products(1.1, 1.3, 1.3, 1.1), 0.0);
    // (1 + ε)(1 − ε) − 1 · 1 = −ε², below the last place of 1.
    EXPECT_EQ(prep::detail::difference_of_products(1 + 0x1p-30, 1 - 0x1p-30, 1, 1), -0x1p-60);
}

glm::dvec4 sum_term(double x, double y, double z) {
    return {x, y, z, std::abs(x) + std::abs(y) + std::abs(z)};
}

TEST(OrderFreeSum, HasTheSameBitsInEveryOrderAndStaysWithinItsBound) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> value(-1, 1), exponent(-20, 20);
    for (int i = 0; i < 200; ++i) {
        std::vector<glm::dvec4> terms;
        const std::size_t count = 1 + random() % 40;
        Rational x = 0, y = 0, z = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const double scale = std::exp2(exponent(random));
            terms.push_back(sum_term(scale * value(random), scale * value(random), value(random)));
        }
        if (i % 2 == 1)  // most of it cancels
            for (std::size_t k = 0; k < count; ++k)
                terms.push_back(
                    sum_term(-terms[k].x * (1 + 1e-13 * value(random)), -terms[k].y, -terms[k].z));
        for (const glm::dvec4& t : terms) {
            x += rational(t.x);
            y += rational(t.y);
            z += rational(t.z);
        }
        const prep::detail::OrderFreeSum sum = prep::detail::order_free_sum(terms);
        const Rational dx = rational(sum.value.x) - x, dy = rational(sum.value.y) - y,
                       dz = rational(sum.value.z) - z;
        ASSERT_LE(dx * dx + dy * dy + dz * dz, rational(sum.error) * rational(sum.error)) << i;
        for (int order = 0; order < 5; ++order) {
            std::shuffle(terms.begin(), terms.end(), random);
            ASSERT_EQ(prep::detail::order_free_sum(terms).value, sum.value) << i;
        }
    }
}

TEST(OrderFreeSum, KeepsWhatCancellingLeaves) {
    const std::vector<glm::dvec4> terms{sum_term(0x1p60, 1, 0), sum_term(1, 0x1p40, 3),
                                        sum_term(-0x1p60, -0x1p40, 0)};
    EXPECT_EQ(prep::detail::order_free_sum(terms).value, glm::dvec3(1, 1, 3));
    EXPECT_EQ(prep::detail::order_free_sum({}).value, glm::dvec3(0));
}

int sign_of(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
    const Rational ax(a.x), ay(a.y);
    const Rational d =
        (Rational(b.x) - ax) * (Rational(c.y) - ay) - (Rational(b.y) - ay) * (Rational(c.x) - ax);
    return d > 0 ? 1 : d < 0 ? -1 : 0;
}

TEST(Orient2d, IsExactOnNearlyStraightLines) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<float> coordinate(-1, 1);
    int flat = 0;
    for (int i = 0; i < 3000; ++i) {
        const glm::vec2 a(coordinate(random), coordinate(random));
        const glm::vec2 b(coordinate(random), coordinate(random));
        const float t = i % 3 == 0 ? 0.5f : coordinate(random);
        glm::vec2 c = a + t * (b - a);
        if (i % 5 == 0) c = i % 2 ? a : b;
        const int truth = sign_of(a, b, c);
        flat += truth == 0;
        ASSERT_EQ(prep::detail::orient2d(a, b, c), truth) << i;
        ASSERT_EQ(prep::detail::orient2d(b, a, c), -truth) << i;
    }
    EXPECT_GT(flat, 300);
    EXPECT_EQ(prep::detail::orient2d({0, 0}, {3, 3}, {7, 7}), 0);
    // One step of a float apart, 16 million away from zero.
    const float far = 16777216.0f;
    EXPECT_EQ(prep::detail::orient2d({far, far}, {far + 2, far + 2}, {far + 4, far + 2}), -1);
    EXPECT_EQ(prep::detail::orient2d({far, far}, {far + 2, far + 2}, {far + 2, far + 4}), 1);
}

TEST(DisjointSets, AreNamedByTheirLowestMemberInAnyOrderOfUnions) {
    std::mt19937_64 random(5);
    constexpr Index count = 60;
    for (int i = 0; i < 50; ++i) {
        std::vector<std::pair<Index, Index>> unions;
        for (int k = 0; k < 40; ++k)
            unions.emplace_back(Index(random() % count), Index(random() % count));
        // By definition: names spread until nothing changes.
        std::vector<Index> names(count);
        for (Index k = 0; k < count; ++k) names[k] = k;
        for (bool changed = true; changed;) {
            changed = false;
            for (const auto& [a, b] : unions) {
                const Index low = std::min(names[a], names[b]);
                changed |= names[a] != low || names[b] != low;
                names[a] = names[b] = low;
            }
        }
        prep::detail::DisjointSets sets(count);
        for (const auto& [a, b] : unions) sets.unite(a, b);
        for (Index k = 0; k < count; ++k) ASSERT_EQ(sets.find(k), names[k]) << i << ' ' << k;
    }
}

// Points on a coarse grid, so that many lie on rims of triangles and boxes; some come and go.
TEST(CornerTree, OffersEveryLivePointInATriangleOrOnItsRim) {
    std::mt19937_64 random(6);
    // Small whole numbers: exact.
    const auto side = [](const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    std::vector<glm::vec2> points;
    for (int i = 0; i < 300; ++i) points.emplace_back(float(random() % 12), float(random() % 12));
    prep::detail::CornerTree tree(points);
    std::vector<bool> live(points.size(), false);
    std::size_t met = 0;
    for (int round = 0; round < 400; ++round) {
        for (int k = 0; k < 5; ++k) {
            const Index p = Index(random() % points.size());
            live[p] = random() % 3 == 0;
            tree.set_live(p, live[p]);
        }
        const glm::vec2 a = points[random() % points.size()], b = points[random() % points.size()],
                        c = points[random() % points.size()];
        if (side(a, b, c) <= 0) continue;
        std::vector<bool> offered(points.size(), false);
        std::size_t work = 0;
        tree.any_near(a, b, c, work, [&](Index p) {
            offered[p] = true;
            return false;
        });
        for (Index p = 0; p < points.size(); ++p) {
            const bool inside = side(a, b, points[p]) >= 0 && side(b, c, points[p]) >= 0 &&
                                side(c, a, points[p]) >= 0;
            if (inside && live[p]) {
                ASSERT_TRUE(offered[p]) << "round " << round << ", point " << p;
                ++met;
            }
            ASSERT_TRUE(live[p] || !offered[p]) << "round " << round << ", point " << p;
        }
        ASSERT_GT(work, 0u);
    }
    EXPECT_GT(met, 300u);
}

// IEC 61966-2-1: below 0.04045 a twelfth or so, above ((s + 0.055) / 1.055)^2.4. The values were
// computed with 40 digits.
TEST(Srgb, HasTheStandardsValuesBothWays) {
    const std::pair<double, double> known[] = {{0, 0},
                                               {0.02, 0.0015479876160990712},
                                               {0.04, 0.0030959752321981424},
                                               {0.05, 0.003935939504088965},
                                               {0.2, 0.033104766570885055},
                                               {0.5, 0.21404114048223255},
                                               {0.8, 0.6038273388553378},
                                               {1, 1}};
    for (const auto& [encoded, linear] : known) {
        EXPECT_NEAR(prep::detail::srgb_to_linear(encoded), linear, 1e-15);
        EXPECT_NEAR(prep::detail::linear_to_srgb(linear), encoded, 1e-15);
    }
    // The two pieces meet to within what the standard's rounded constants leave.
    EXPECT_NEAR(prep::detail::srgb_to_linear(0.04045), 0.0031308, 1e-7);
    EXPECT_NEAR(prep::detail::linear_to_srgb(0.0031308), 0.04045, 1e-6);
}

void expect_corners_by_vertex(const std::vector<Index>& corner_vertices, std::size_t vertices) {
    std::vector<std::vector<Index>> expected(vertices);
    for (Index c = 0; c < corner_vertices.size(); ++c) expected[corner_vertices[c]].push_back(c);
    for (const int threads : {1, 2, 5}) {
        const auto found = prep::detail::corners_by_vertex(corner_vertices, vertices, threads);
        ASSERT_EQ(found.offsets.size(), vertices + 1);
        ASSERT_EQ(found.offsets.front(), 0u);
        for (std::size_t v = 0; v < vertices; ++v)
            ASSERT_TRUE(std::equal(expected[v].begin(), expected[v].end(),
                                   found.corners.begin() + found.offsets[v],
                                   found.corners.begin() + found.offsets[v + 1]))
                << v << " with " << threads << " threads";
    }
}

// Without order, so that neighbours are far apart: the way that sorts by bucket.
TEST(CornersByVertex, AreEveryVertexsCornersAscendingForAnyThreadCount) {
    std::mt19937_64 random(7);
    constexpr std::size_t vertices = 70001, corners = 300000;  // more than a block of work
    std::vector<Index> corner_vertices(corners);
    for (Index& v : corner_vertices) v = Index(random() % vertices);
    expect_corners_by_vertex(corner_vertices, vertices);
}

// In order as files have it, over several blocks of work, in a ring that ends at its beginning.
TEST(CornersByVertex, OfNeighboursAreTheSame) {
    std::mt19937_64 random(11);
    constexpr std::size_t vertices = 150007, corners = 900000;
    std::vector<Index> corner_vertices(corners);
    for (std::size_t c = 0; c < corners; ++c)
        corner_vertices[c] = Index((c / 6 + random() % 700) % vertices);
    expect_corners_by_vertex(corner_vertices, vertices);
    // Each block of corners over all vertices: neighbours still, but no ranges of their own.
    for (std::size_t c = 0; c < corners; ++c)
        corner_vertices[c] = Index((c + random() % 100) % vertices);
    expect_corners_by_vertex(corner_vertices, vertices);
}

std::vector<Index> lowest_equal(const std::vector<glm::vec3>& positions) {
    std::map<std::tuple<float, float, float>, Index> first;
    std::vector<Index> lowest;
    for (Index v = 0; v < positions.size(); ++v) {
        const glm::vec3& p = positions[v];
        const bool number = !(std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z));
        // Adding 0 makes −0 a 0.
        lowest.push_back(
            number ? first.try_emplace({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}, v).first->second : v);
    }
    return lowest;
}

// A few equal ones among many, and many; in all places of a vector, and behind the last whole one.
TEST(EqualPositions, AreFoundByEveryInstructionSetForAnyThreadCount) {
    std::mt19937_64 random(8);
    std::uniform_real_distribution<float> coordinate(-1, 1);
    for (const std::size_t count : {3u, 61u, 1500u, 70013u}) {
        for (const int share : {2, 40}) {
            std::vector<glm::vec3> positions;
            for (std::size_t v = 0; v < count; ++v) {
                glm::vec3 p(coordinate(random), coordinate(random), coordinate(random));
                if (random() % 5 == 0) p[int(random() % 3)] = random() % 2 ? 0.0f : -0.0f;
                if (v > 0 && random() % unsigned(share) == 0) {
                    p = positions[random() % v];
                    for (int k = 0; k < 3; ++k)
                        if (p[k] == 0) p[k] = -p[k];
                }
                if (random() % 50 == 0) p.y = NAN;
                positions.push_back(p);
            }
            positions.back() = -0.0f * positions.front();
            positions.front() = glm::vec3(0.0f);
            for (int k = 0; k < 3; ++k) positions.back()[k] = -0.0f;
            const std::vector<Index> expected = lowest_equal(positions);
            for (const prep::SimdLevel level : test::every_level()) {
                for (const int threads : {1, 2, 3})
                    ASSERT_EQ(prep::detail::equal_positions(positions, threads, level), expected)
                        << count << " positions, " << prep::to_string(level) << ", " << threads
                        << " threads";
            }
        }
    }
    EXPECT_TRUE(prep::detail::equal_positions(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}}, 1,
                                              prep::SimdLevel::automatic)
                    .empty());
}

constexpr prep::SimdLevel vector_levels[] = {prep::SimdLevel::sse4, prep::SimdLevel::avx2,
                                             prep::SimdLevel::avx512};

// The vectors' arc cosine is a polynomial, and where that is near the middle between two floats the
// library's: in hundreds of thousands of angles some are.
TEST(TermKernels, GiveTheScalarBitsForAllAngles) {
    using prep::detail::Contribution;
    using prep::detail::TriangleBlock;
    std::mt19937_64 random(9);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto block = std::make_unique<TriangleBlock>();
    struct Planes {
        alignas(64) Contribution of[3][TriangleBlock::size];
    };
    const auto expected = std::make_unique<Planes>(), found = std::make_unique<Planes>();
    for (int round = 0; round < 1500; ++round) {
        for (std::size_t i = 0; i < TriangleBlock::size; ++i) {
            for (int k = 0; k < 3; ++k) {
                for (int d = 0; d < 3; ++d)
                    block->p[k][d][i] = d == 2 ? 0.1f * unit(random) : unit(random);
                const glm::vec3 n =
                    glm::normalize(glm::vec3(0.2f * unit(random), 0.2f * unit(random), 1.0f));
                for (int d = 0; d < 3; ++d) block->n[k][d][i] = n[d];
                for (int d = 0; d < 2; ++d) block->uv[k][d][i] = unit(random);
            }
        }
        Contribution* const to[3] = {expected->of[0], expected->of[1], expected->of[2]};
        const auto wanted = prep::detail::contribution_kernel(prep::SimdLevel::scalar)(
            *block, TriangleBlock::size, true, to);
        for (const prep::SimdLevel level : vector_levels) {
            if (!prep::simd_available(level)) continue;
            Contribution* const into[3] = {found->of[0], found->of[1], found->of[2]};
            const auto got =
                prep::detail::contribution_kernel(level)(*block, TriangleBlock::size, true, into);
            ASSERT_EQ(got.counts.mirrored, wanted.counts.mirrored);
            for (int k = 0; k < 3; ++k)
                for (std::size_t i = 0; i < TriangleBlock::size; ++i)
                    ASSERT_EQ(std::memcmp(&found->of[k][i], &expected->of[k][i], 12), 0)
                        << prep::to_string(level) << ", round " << round << ", " << i << ' ' << k;
        }
    }
}

// As equal_positions uses it: 16 bits a position, two of them its own; up to twice that where the
// number of words is rounded up.
TEST(PositionFilter, LetsLessThanOneInFiftyThroughThatEqualNone) {
    std::mt19937_64 random(10);
    std::uniform_real_distribution<float> coordinate(-1, 1);
    for (const std::size_t count : {1022u, 20000u, 65534u, 65536u}) {
        std::vector<glm::vec3> scattered, grid;
        for (std::size_t v = 0; v < count; ++v) {
            scattered.emplace_back(coordinate(random), coordinate(random), coordinate(random));
            grid.emplace_back(float(v % 32), float(v / 32 % 32), float(v / 1024));
        }
        for (const auto* positions : {&scattered, &grid}) {
            const std::size_t words = std::bit_ceil(count * 16 / 32 + 1);
            std::vector<Index> taken(words, 0), shared(words, 0);
            for (const glm::vec3& p : *positions) {
                const auto [word, bits] = prep::detail::filter_bits(p, Index(words - 1));
                if ((taken[word] & bits) == bits) shared[word] |= bits;
                taken[word] |= bits;
            }
            std::size_t through = 0;
            for (const glm::vec3& p : *positions) {
                const auto [word, bits] = prep::detail::filter_bits(p, Index(words - 1));
                through += (shared[word] & bits) == bits;
            }
            EXPECT_LT(50 * through, count) << (positions == &grid ? "grid of " : "") << count;
        }
    }
}

}  // namespace
