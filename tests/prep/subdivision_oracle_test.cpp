// The judge judged: refined around a point it says what it says of the whole mesh, and its limits
// do not depend on the level at which a mask is applied.
#include "subdivision_oracle.h"

#include <gtest/gtest.h>

#include "subdivision_cages.h"

namespace {

using test::SubdivisionOracle;
using Location = SubdivisionOracle::Location;
using Limit = SubdivisionOracle::Limit;
using Real = SubdivisionOracle::Real;

// Long double's rounding, through nine levels.
constexpr Real rounding = 1e-16L;

TEST(SubdivisionOracle, RefinesAroundAPointAsItRefinesTheWhole) {
    for (const test::Cage& cage : test::own_cages()) {
        SCOPED_TRACE(cage.name);
        const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
        const SubdivisionOracle::Refined whole = oracle.refine_all(4);
        // Every seventh corner, seen from its own face.
        std::vector<Location> locations;
        std::vector<std::uint32_t> vertices;
        for (std::size_t c = 0; c < whole.corners.size(); c += 7) {
            locations.push_back(whole.corners[c]);
            vertices.push_back(whole.corner_vertices[c]);
        }
        const std::vector<Limit> local = oracle.limits(locations, 4);
        for (std::size_t k = 0; k < local.size(); ++k)
            ASSERT_LE(glm::length(local[k].position - whole.limits[vertices[k]].position),
                      rounding * oracle.diagonal())
                << "face " << locations[k].face << " at " << locations[k].x << ", "
                << locations[k].y;
    }
}

TEST(SubdivisionOracle, MasksHoldAtEveryLevel) {
    for (const test::Cage& cage : test::own_cages()) {
        SCOPED_TRACE(cage.name);
        const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
        // The cage's own vertices, sharpness worn off: there the masks are those of all rules.
        std::vector<Location> early, late;
        for (std::uint32_t f = 0; f < oracle.face_count(); ++f) {
            const bool split = oracle.is_split_in_quads(f);
            for (std::uint32_t i = 0; i < oracle.corner_count(f); ++i) {
                const bool loop = cage.options.scheme == prep::SubdivisionScheme::loop;
                const std::uint32_t x = !split && (i == 1 || (i == 2 && !loop));
                const std::uint32_t y = !split && (i == 3 || i == 2);
                early.push_back({f, split ? i : 0, x << 1, y << 1});
                late.push_back({f, split ? i : 0, x << 12, y << 12});
            }
        }
        const std::vector<Limit> a = oracle.limits(early, 1), b = oracle.limits(late, 12);
        for (std::size_t k = 0; k < a.size(); ++k) {
            SCOPED_TRACE("face " + std::to_string(early[k].face) + " corner at " +
                         std::to_string(early[k].x) + ", " + std::to_string(early[k].y));
            ASSERT_LE(glm::length(a[k].position - b[k].position), 1e-15L * oracle.diagonal());
            ASSERT_EQ(a[k].has_normal, b[k].has_normal);
            if (a[k].has_normal) {
                ASSERT_LE(glm::length(a[k].normal - b[k].normal), 1e-10L);
            }
            if (a[k].has_derivatives && b[k].has_derivatives) {
                ASSERT_LE(glm::length(a[k].du - b[k].du), 1e-11L * oracle.diagonal());
                ASSERT_LE(glm::length(a[k].dv - b[k].dv), 1e-11L * oracle.diagonal());
            }
        }
    }
}

// The limit of normals, not only of masks: a vertex' normal is that of points close by.
TEST(SubdivisionOracle, NormalsAreLimitsOfNormalsAround) {
    for (const auto scheme : {prep::SubdivisionScheme::catmark, prep::SubdivisionScheme::loop})
        for (const std::uint32_t valence : {3U, 5U, 8U}) {
            const test::Cage cage = test::pole(scheme, valence);
            SCOPED_TRACE(cage.name);
            const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
            const std::vector<Location> places{{0, 0, 0, 0}, {0, 0, 1, 1}};
            const std::vector<Limit> found = oracle.limits(places, 20);
            ASSERT_TRUE(found[0].has_normal && found[1].has_normal);
            EXPECT_EQ(found[0].valence, valence);
            EXPECT_LE(glm::length(found[0].normal - found[1].normal), 1e-3L);
            EXPECT_LE(glm::length(found[0].position - found[1].position), 1e-2L);
        }
}

// A plane stays one, and a regular grid's parameters are linear: derivatives by hand.
TEST(SubdivisionOracle, DerivativesOfAPlaneAreItsEdges) {
    prep::Mesh mesh;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) mesh.positions.emplace_back(2 * x + y, 3 * y, x - y);
    for (std::uint32_t y = 0; y < 3; ++y)
        for (std::uint32_t x = 0; x < 3; ++x) {
            const std::uint32_t v = 4 * y + x;
            mesh.corner_vertices.insert(mesh.corner_vertices.end(), {v, v + 1, v + 5, v + 4});
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        }
    const SubdivisionOracle oracle(mesh, {});
    const std::vector<Location> places{{4, 0, 3, 5}, {0, 0, 0, 0}, {3, 0, 0, 7}};
    for (const Limit& limit : oracle.limits(places, 3)) {
        ASSERT_TRUE(limit.has_derivatives);
        EXPECT_LE(glm::length(limit.du - SubdivisionOracle::Point(2, 0, 1)), 1e-15L);
        EXPECT_LE(glm::length(limit.dv - SubdivisionOracle::Point(1, 3, -1)), 1e-15L);
    }
}

}  // namespace
