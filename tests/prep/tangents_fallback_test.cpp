// Mode mikktspace makes a frame at every corner, says where the definition made none, and leaves
// everything else to the definition.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "corner_soup.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "shapes.h"
#include "shared_data.h"
#include "steps.h"

namespace {

using prep::TangentFault;
using prep::TangentSource;
using test::CornerSoup;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
// A float vector scaled to unit length is unit to 1.2e-7 and on the plane of its normal to 2e-7.
constexpr double frame_tolerance = 1e-6;

struct Corner {
    glm::vec3 position;
    glm::vec2 uv;
    glm::vec3 normal{0, 0, 1};
};

void add_face(CornerSoup& soup, std::initializer_list<Corner> corners) {
    for (const Corner& c : corners) soup.add(c.position, c.normal, c.uv);
    soup.end_face();
}

// (0, 0, 1) where there is none, as TangentFault::no_normal says.
glm::dvec3 unit_normal(const glm::vec3& normal) {
    const glm::dvec3 n(normal);
    const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    if (!std::isfinite(n.x + n.y + n.z) || largest == 0) return {0, 0, 1};
    return glm::normalize(n / largest);
}

void expect_frame(const glm::vec4& tangent, const glm::vec3& normal, std::size_t corner) {
    const glm::dvec3 t{glm::vec3(tangent)};
    EXPECT_NEAR(glm::length(t), 1.0, frame_tolerance) << "corner " << corner;
    EXPECT_NEAR(glm::dot(t, unit_normal(normal)), 0.0, frame_tolerance) << "corner " << corner;
    EXPECT_EQ(std::abs(tangent.w), 1.0f) << "corner " << corner;
}

struct Outcome {
    std::vector<glm::vec4> tangents;
    prep::CornerTangents whole;

    const prep::CornerTangents::Fallback* fallback(std::uint32_t corner) const {
        for (const auto& f : whole.fallbacks)
            if (f.corner == corner) return &f;
        return nullptr;
    }
};

std::vector<glm::vec4> definition(const CornerSoup& soup, prep::UvOrigin origin) {
    prep::TangentOptions options;
    options.mode = prep::TangentMode::definition;
    options.uv_origin = origin;
    const auto result = prep::corner_tangents(soup.input(), options);
    EXPECT_TRUE(result.has_value());
    return test::flattened(*result);
}

// Computes, and expects a frame at every corner and the definition's bits wherever no fallback is
// reported.
Outcome make(const CornerSoup& soup) {
    prep::TangentOptions options;
    options.uv_origin = prep::UvOrigin::bottom_left;
    auto result = prep::corner_tangents(soup.input(), options);
    EXPECT_TRUE(result.has_value());
    Outcome outcome{test::flattened(*result), *std::move(result)};
    const auto defined = definition(soup, options.uv_origin);
    for (std::uint32_t c = 0; c < soup.corners(); ++c) {
        expect_frame(outcome.tangents[c], soup.normals[c], c);
        if (!outcome.fallback(c)) {
            EXPECT_EQ(std::memcmp(&outcome.tangents[c], &defined[c], sizeof defined[c]), 0)
                << "corner " << c << " differs from the definition's without a word";
        }
    }
    return outcome;
}

void expect_fallback(const Outcome& outcome, std::uint32_t corner, TangentFault fault,
                     TangentSource source) {
    const auto* f = outcome.fallback(corner);
    ASSERT_NE(f, nullptr) << "corner " << corner;
    EXPECT_EQ(int(f->fault), int(fault)) << "corner " << corner;
    EXPECT_EQ(int(f->source), int(source)) << "corner " << corner;
}

void expect_direction(const glm::vec4& tangent, const glm::vec3& direction, float w) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(tangent[k], direction[k], 1e-6);
    EXPECT_EQ(tangent.w, w);
}

TEST(TangentFallback, EmptyMeshHasNoTangents) {
    const Outcome out = make(CornerSoup());
    EXPECT_TRUE(out.tangents.empty());
    EXPECT_TRUE(out.whole.fallbacks.empty());
}

TEST(TangentFallback, OneGoodTriangleNeedsNone) {
    CornerSoup soup;
    add_face(soup, {{{0, 0, 0}, {0, 0}}, {{2, 0, 0}, {1, 0}}, {{0, 3, 0}, {0, 1}}});
    const Outcome out = make(soup);
    EXPECT_TRUE(out.whole.fallbacks.empty());
    for (const glm::vec4& t : out.tangents) expect_direction(t, {1, 0, 0}, 1);
}

// The angles at its ends are zero: so are the definition's tangents there. They run along the line.
TEST(TangentFallback, CollinearTriangleWithRealUvs) {
    CornerSoup soup;
    add_face(soup, {{{0, 0, 0}, {0, 0}}, {{1, 0, 0}, {1, 0}}, {{3, 0, 0}, {2, 1}}});
    const Outcome out = make(soup);
    EXPECT_EQ(out.whole.degenerate_triangles, 0u);
    ASSERT_EQ(out.whole.fallbacks.size(), 2u);
    expect_fallback(out, 0, TangentFault::vanished, TangentSource::gradient);
    expect_fallback(out, 2, TangentFault::vanished, TangentSource::gradient);
    for (const glm::vec4& t : out.tangents) expect_direction(t, {1, 0, 0}, 1);
}

// The left one is not mirrored, the right one is; the one between them has no gradient and must
// take a frame of its neighbours, whole, not a mean of opposite ones.
TEST(TangentFallback, ZeroUvTriangleBetweenOppositeOrientations) {
    const glm::vec2 a(0.25f, 0), b(0.25f, 1);
    CornerSoup soup;
    add_face(soup, {{{0, 0, 0}, {0, 0}}, {{1, 0, 0}, a}, {{1, 1, 0}, b}});
    add_face(soup, {{{1, 0, 0}, a}, {{2, 0, 0}, a}, {{1, 1, 0}, b}});
    add_face(soup, {{{1, 1, 0}, b}, {{2, 0, 0}, a}, {{2, 1, 0}, {0, 1}}});
    const Outcome out = make(soup);
    for (std::uint32_t c = 0; c < 3; ++c) expect_direction(out.tangents[c], {1, 0, 0}, 1);
    for (std::uint32_t c = 6; c < 9; ++c) expect_direction(out.tangents[c], {-1, 0, 0}, -1);
    for (std::uint32_t c = 3; c < 6; ++c)
        EXPECT_NEAR(std::abs(out.tangents[c].x), 1.0f, 1e-6) << "corner " << c;
    EXPECT_EQ(out.whole.mirrored_triangles, 1u);
}

TEST(TangentFallback, ConstantUvsOverAMesh) {
    CornerSoup soup;
    const prep::Mesh sphere = shapes::fan_triangulated(shapes::uv_sphere(24, 12));
    for (std::size_t c = 0; c < sphere.corner_count(); ++c) {
        const glm::vec3 p = sphere.positions[sphere.corner_vertices[c]];
        soup.add(p, p, glm::vec2(0.5f));
        if (c % 3 == 2) soup.end_face();
    }
    const Outcome out = make(soup);
    ASSERT_EQ(out.whole.fallbacks.size(), soup.corners());
    for (const auto& f : out.whole.fallbacks) {
        EXPECT_EQ(int(f.fault), int(TangentFault::no_gradient));
        EXPECT_EQ(int(f.source), int(TangentSource::any));
    }
}

// dP/du is (1, 0, 0), and so is the normal: the bitangent is what the UVs still say.
TEST(TangentFallback, TangentAlongTheNormal) {
    const glm::vec3 n(1, 0, 0);
    CornerSoup soup;
    add_face(soup, {{{0, 0, 0}, {0, 0}, n}, {{1, 0, 0}, {1, 0}, n}, {{0, 1, 0}, {0, 1}, n}});
    const Outcome out = make(soup);
    for (std::uint32_t c = 0; c < 3; ++c) {
        expect_fallback(out, c, TangentFault::vanished, TangentSource::bitangent);
        const glm::vec3 bitangent = out.tangents[c].w * glm::cross(n, glm::vec3(out.tangents[c]));
        EXPECT_NEAR(bitangent.y, 1.0f, 1e-6);
    }
}

// Almost along it: what projection in float leaves is off the plane by far more than rounding of
// the result.
TEST(TangentFallback, TangentAlmostAlongTheNormal) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> about(-1, 1);
    std::uint64_t reported = 0;
    for (int round = 0; round < 500; ++round) {
        const glm::vec3 u = glm::normalize(glm::vec3(about(random), about(random), 1.5f));
        const float off = std::pow(10.0f, -2 - 5 * std::abs(about(random)));
        const glm::vec3 n = glm::normalize(u + off * glm::vec3(0, 1, 0));
        CornerSoup soup;
        add_face(soup, {{{0, 0, 0}, {0, 0}, n}, {u, {1, 0}, n}, {{0, 1, 0}, {0, 1}, n}});
        reported += make(soup).whole.fallbacks.size();
        if (HasFailure()) FAIL() << "round " << round;
    }
    EXPECT_GT(reported, 300u);  // of 1500 corners: those less than about a degree off
}

TEST(TangentFallback, NanUvsCostTheirTriangleOnly) {
    CornerSoup soup;
    add_face(soup, {{{0, 0, 0}, {0, 0}}, {{1, 0, 0}, {1, 0}}, {{0, 1, 0}, {0, 1}}});
    add_face(soup, {{{1, 0, 0}, {1, 0}}, {{1, 1, 0}, {nan, 1}}, {{0, 1, 0}, {0, 1}}});
    add_face(soup, {{{5, 0, 0}, {nan, nan}}, {{6, 0, 0}, {1, 0}}, {{5, 1, 0}, {0, 1}}});
    const Outcome out = make(soup);
    expect_direction(out.tangents[0], {1, 0, 0}, 1);
    for (const std::uint32_t c : {4u, 6u, 7u, 8u})
        EXPECT_NE(out.fallback(c), nullptr) << "corner " << c;
    // The points that it shares are its neighbour's, tangents and all.
    expect_direction(out.tangents[3], {1, 0, 0}, 1);
    expect_direction(out.tangents[5], {1, 0, 0}, 1);
}

TEST(TangentFallback, MirroredUvsAreNoFault) {
    CornerSoup soup;
    add_face(soup, {{{0, 0, 0}, {0, 0}}, {{1, 0, 0}, {1, 0}}, {{0, 1, 0}, {0, 1}}});
    add_face(soup, {{{0, 0, 0}, {0, 0}}, {{0, 1, 0}, {0, 1}}, {{-1, 0, 0}, {1, 0}}});
    const Outcome out = make(soup);
    EXPECT_TRUE(out.whole.fallbacks.empty());
    EXPECT_EQ(out.whole.mirrored_triangles, 1u);
    for (std::uint32_t c = 0; c < 3; ++c) expect_direction(out.tangents[c], {1, 0, 0}, 1);
    for (std::uint32_t c = 3; c < 6; ++c) expect_direction(out.tangents[c], {-1, 0, 0}, -1);
}

TEST(TangentFallback, MissingNormalsGetAFrameAboutZ) {
    CornerSoup soup;
    for (const glm::vec3& n : {glm::vec3(0.0f), glm::vec3(nan), glm::vec3(0, nan, 1)})
        add_face(soup, {{{0, 0, 0}, {0, 0}, n}, {{1, 0, 0}, {1, 0}, n}, {{0, 1, 0}, {0, 1}, n}});
    const Outcome out = make(soup);
    for (std::uint32_t c = 0; c < 9; ++c) {
        expect_fallback(out, c, TangentFault::no_normal, TangentSource::gradient);
        expect_direction(out.tangents[c], {1, 0, 0}, 1);
    }
}

// Each corner asks its polygon for a direction, which is found once for all of them.
TEST(TangentFallback, PolygonsAreLookedThroughOnce) {
    constexpr int count = 20'000;
    CornerSoup soup;
    for (int k = 0; k < count; ++k) {
        const double angle = 2 * 3.14159265358979 * k / count;
        const glm::vec2 at(std::cos(angle), std::sin(angle));
        soup.add(glm::vec3(at, 0), glm::vec3(0.0f), at);
    }
    soup.end_face();
    std::optional<Outcome> out;
    const std::uint64_t steps = test::steps_of([&] { out = make(soup); });
    EXPECT_GE(steps, std::uint64_t(count));
    EXPECT_LE(steps, 20 * std::uint64_t(count));
    for (std::uint32_t c = 0; c < count; c += 997) {
        expect_fallback(*out, c, TangentFault::no_normal, TangentSource::gradient);
        expect_direction(out->tangents[c], {1, 0, 0}, 1);
    }
}

TEST(TangentFallback, RepeatedPositionsTakeTheirNeighbours) {
    CornerSoup soup;
    add_face(soup, {{{0, 0, 0}, {0, 0}}, {{1, 0, 0}, {1, 0}}, {{0, 1, 0}, {0, 1}}});
    add_face(soup, {{{1, 0, 0}, {1, -0.5f}}, {{1, 0, 0}, {1, 0}}, {{0, 1, 0}, {0, 1}}});
    add_face(soup, {{{9, 9, 9}, {0, 0}}, {{9, 9, 9}, {1, 0}}, {{9, 9, 9}, {0, 1}}});
    const Outcome out = make(soup);
    EXPECT_EQ(out.whole.degenerate_triangles, 2u);
    for (std::uint32_t c = 0; c < 6; ++c) expect_direction(out.tangents[c], {1, 0, 0}, 1);
    for (std::uint32_t c = 6; c < 9; ++c)
        expect_fallback(out, c, TangentFault::no_gradient, TangentSource::any);
}

// The definition takes what is below 1.2e-38 for zero: UV areas, lengths.
TEST(TangentFallback, TinyScalesKeepTheirDirections) {
    for (const float uv_scale : {1.0f, 1e-19f, 1e-25f}) {
        for (const float scale : {1.0f, 1e-21f, 1e-30f, 1e18f}) {
            CornerSoup soup;
            add_face(soup, {{{0, 0, 0}, {0, 0}},
                            {{scale, 0, 0}, {0, uv_scale}},
                            {{0, scale, 0}, {-uv_scale, 0}}});
            for (const glm::vec4& t : make(soup).tangents) expect_direction(t, {0, -1, 0}, 1);
        }
    }
}

TEST(TangentFallback, FramesOnHostileSoups) {
    for (std::uint32_t seed = 0; seed < 1500; ++seed) {
        std::mt19937 random(seed);
        test::HostileOptions hostile;
        hostile.quads = seed & 1;
        hostile.minus_zeros = seed & 2;
        hostile.nans = seed & 4;
        hostile.odd_scales = seed & 8;
        const CornerSoup soup = test::hostile_soup(random, hostile);
        auto result = prep::corner_tangents(soup.input());
        ASSERT_TRUE(result.has_value());
        const auto tangents = test::flattened(*result);
        for (std::size_t c = 0; c < tangents.size(); ++c)
            expect_frame(tangents[c], soup.normals[c], c);
        if (HasFailure()) FAIL() << "seed " << seed;
    }
}

TEST(TangentFallback, FramesEverywhereAfterPrepare) {
    MESHPREP_REQUIRE_SHARED(shared);
    for (const char* file : {"NormalTangentTest.glb", "DamagedHelmet/DamagedHelmet.gltf",
                             "diablo3_pose/diablo3_pose.obj"}) {
        SCOPED_TRACE(file);
        auto scene = prep::load_scene(shared / "corpus" / file);
        ASSERT_TRUE(scene.has_value()) << scene.error().text;
        prep::PrepareOptions options;
        options.request.tangents = prep::Request::Level::always;
        auto prepared = prep::prepare(*std::move(scene), options);
        ASSERT_TRUE(prepared.has_value()) << prepared.error().text;
        std::size_t checked = 0;
        for (const prep::VertexMesh& mesh : prepared->meshes) {
            ASSERT_EQ(mesh.tangents.size(), mesh.normals.size());
            for (std::size_t v = 0; v < mesh.tangents.size(); ++v, ++checked)
                expect_frame(mesh.tangents[v], mesh.normals[v], v);
        }
        EXPECT_GT(checked, 1000u);
    }
}

// A corner without a normal or UV counts as one of NaN, wherever it lies and whatever is read
// first.
TEST(TangentFallback, AbsentNormalsAndUvsAreNaN) {
    std::mt19937 random(11);
    for (int round = 0; round < 60; ++round) {
        test::CornerSoup soup;
        if (round < 3) {  // one triangle
            add_face(soup, {{{0, 0, 0}, {0, 0}}, {{1, 0, 0}, {1, 0}}, {{0, 1, 0}, {0, 1}}});
        } else {
            test::HostileOptions hostile;
            hostile.quads = round % 2 == 0;
            soup = test::hostile_soup(random, hostile);
        }
        test::IndexedSoup absent = test::share_values(soup), explicit_nan = absent;
        explicit_nan.normals.push_back(glm::vec3(nan));
        explicit_nan.uvs.push_back(glm::vec2(nan));
        for (std::size_t c = 0; c < soup.corners(); ++c) {
            if (round == 0 || random() % 4 == 0) {
                absent.normal_indices[c] = prep::no_index;
                explicit_nan.normal_indices[c] = std::uint32_t(explicit_nan.normals.size() - 1);
            }
            if (random() % 8 == 0) {
                absent.uv_indices[c] = prep::no_index;
                explicit_nan.uv_indices[c] = std::uint32_t(explicit_nan.uvs.size() - 1);
            }
        }
        for (const auto mode : {prep::TangentMode::mikktspace, prep::TangentMode::definition,
                                prep::TangentMode::mikktspace_exact})
            for (const auto simd : {prep::SimdLevel::scalar, prep::SimdLevel::automatic}) {
                prep::TangentOptions options;
                options.mode = mode;
                options.simd = simd;
                options.threads = 1 + round % 3;
                const auto a = prep::corner_tangents(absent.input(), options);
                const auto b = prep::corner_tangents(explicit_nan.input(), options);
                ASSERT_TRUE(a.has_value());
                ASSERT_TRUE(b.has_value());
                const auto x = test::flattened(*a), y = test::flattened(*b);
                ASSERT_EQ(x.size(), y.size());
                for (std::size_t c = 0; c < x.size(); ++c)
                    for (int k = 0; k < 4; ++k)
                        EXPECT_TRUE(x[c][k] == y[c][k] ||
                                    (std::isnan(x[c][k]) && std::isnan(y[c][k])))
                            << "round " << round << ", corner " << c;
            }
    }
}

// The definition knows triangles and quads: a pentagon alone leaves every corner without a tangent.
TEST(TangentFallback, PolygonsThatTheDefinitionSkipsGetItsDefault) {
    CornerSoup soup;
    add_face(soup, {{{0, 0, 0}, {0, 0}},
                    {{1, 0, 0}, {1, 0}},
                    {{1.5f, 1, 0}, {1, 1}},
                    {{0.5f, 2, 0}, {0.5f, 2}},
                    {{-0.5f, 1, 0}, {0, 1}}});
    for (const auto mode : {prep::TangentMode::definition, prep::TangentMode::mikktspace_exact}) {
        prep::TangentOptions options;
        options.mode = mode;
        const auto made = prep::corner_tangents(soup.input(), options);
        ASSERT_TRUE(made.has_value());
        ASSERT_EQ(made->tangents.indices.size(), 5u);
        for (const glm::vec4& t : test::flattened(*made)) EXPECT_EQ(t, glm::vec4(1, 0, 0, 1));
    }
}

}  // namespace
