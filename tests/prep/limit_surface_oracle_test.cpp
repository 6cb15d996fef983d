// Limit points, derivatives and normals against the published rules in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "opensubdiv_peer.h"
#include "prep/subdivide.h"
#include "sanitized.h"
#include "shared_data.h"
#include "subdivision_cages.h"

namespace {

using prep::SubdivisionScheme;
using test::Cage;
using test::SubdivisionOracle;
using Location = SubdivisionOracle::Location;
using Limit = SubdivisionOracle::Limit;

struct Errors {
    std::size_t points = 0, missing = 0, normals = 0;
    double position = 0, derivative = 0;  // of the diagonal
    double normal_degrees = 0;
    std::size_t worst = 0;  // the location of the largest error in position
};

std::vector<prep::SurfacePoint> evaluated(const Cage& cage, const SubdivisionOracle& oracle,
                                          std::span<const Location> locations, int levels) {
    const auto surface = prep::LimitSurface::make(cage.mesh, cage.options);
    if (!surface) {
        ADD_FAILURE() << cage.name << ": " << surface.error().text;
        return std::vector<prep::SurfacePoint>(locations.size());
    }
    std::vector<prep::SurfaceLocation> places;
    for (const Location& at : locations) places.push_back(surface_location(oracle, at, levels));
    std::vector<prep::SurfacePoint> points(places.size());
    surface->evaluate(places, points);
    return points;
}

Errors errors_of(const Cage& cage, const SubdivisionOracle& oracle,
                 std::span<const Location> locations, std::span<const Limit> limits) {
    const auto points = evaluated(cage, oracle, locations, test::location_levels);
    Errors errors;
    errors.points = points.size();
    const double diagonal = double(oracle.diagonal());
    for (std::size_t k = 0; k < points.size(); ++k) {
        const prep::SurfacePoint& p = points[k];
        const Limit& truth = limits[k];
        if (!p.has_limit) {
            ++errors.missing;
            continue;
        }
        const glm::dvec3 position = p.position + cage.mesh.origin;
        const double off = glm::length(position - glm::dvec3(truth.position)) / diagonal;
        if (!(off <= errors.position)) {
            errors.position = off;
            errors.worst = k;
        }
        const double scale = test::parameter_scale(oracle, locations[k].face);
        for (const auto& [found, expected] : {std::pair{p.du, truth.du}, std::pair{p.dv, truth.dv}})
            errors.derivative = std::max(
                errors.derivative, glm::length(found * scale - glm::dvec3(expected)) / diagonal);
        if (!truth.has_normal) continue;
        ++errors.normals;
        errors.normal_degrees = std::max(errors.normal_degrees,
                                         test::angle_degrees(p.normal, glm::dvec3(truth.normal)));
    }
    return errors;
}

// The bounds asked for are 1e-6 of the diagonal and 1e-3 degrees; double reaches far below, and
// what is far above rounding is a wrong rule.
void expect_exact(const Errors& errors, std::span<const Location> locations) {
    const Location at = errors.points > 0 ? locations[errors.worst] : Location{};
    EXPECT_EQ(errors.missing, 0U);
    EXPECT_LE(errors.position, 1e-8) << "face " << at.face << ", quad " << at.sub_face << ", at "
                                     << at.x << ", " << at.y << " / 512";
    EXPECT_LE(errors.derivative, 1e-7);
    EXPECT_LE(errors.normal_degrees, 1e-5);
}

TEST(LimitSurfaceOracle, FollowsThePublishedRulesOnEveryKindOfCage) {
    std::mt19937_64 random(1);
    for (const Cage& cage : test::own_cages()) {
        SCOPED_TRACE(cage.name);
        const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
        const auto locations = test::random_locations(cage, oracle, 300, 150, random);
        const auto limits = oracle.limits(locations, test::location_levels);
        expect_exact(errors_of(cage, oracle, locations, limits), locations);
    }
}

std::string text_of(const std::optional<test::PeerErrors>& errors) {
    if (!errors) return "crashed";
    char text[64];
    std::snprintf(text, sizeof text, "%.1e %.1e", errors->position, errors->normal_degrees);
    return text;
}

// The long doubles take most of the time.
constexpr std::size_t corpus_points = test::sanitized ? 500 : 5000;

// Prints a row per shape: our largest errors, and Bfr's at four levels of approximation.
TEST(LimitSurfaceOracle, FollowsThePublishedRulesOnEveryShapeOfTheCorpus) {
    MESHPREP_REQUIRE_SHARED(shared);
    std::mt19937_64 random(2);
    const auto names = test::corpus_cage_names(shared);
    ASSERT_EQ(names.size(), 20U);
    std::printf("%-26s %6s %7s %9s %9s %9s | Bfr, positions and degrees at levels 2, 6, 10, 15\n",
                "shape", "points", "missing", "position", "deriv.", "degrees");
    for (const std::string& name : names) {
        SCOPED_TRACE(name);
        const Cage cage = test::corpus_cage(shared, name);
        ASSERT_GT(cage.mesh.face_count(), 0U);
        const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
        const auto locations =
            test::random_locations(cage, oracle, corpus_points, corpus_points / 5, random);
        const auto limits = oracle.limits(locations, test::location_levels);
        ASSERT_EQ(limits.size(), corpus_points);
        const Errors ours = errors_of(cage, oracle, locations, limits);
        std::printf("%-26s %6zu %7zu %9.1e %9.1e %9.1e |", name.c_str(), ours.points, ours.missing,
                    ours.position, ours.derivative, ours.normal_degrees);
        std::array<std::optional<test::PeerErrors>, 4> bfr;
        for (std::size_t i = 0; i < 4; ++i) {
            bfr[i] = test::bfr_errors(cage, oracle, locations, limits, std::array{2, 6, 10, 15}[i]);
            std::printf(" [%s]", text_of(bfr[i]).c_str());
            std::fflush(stdout);
        }
        std::printf("\n");
        expect_exact(ours, locations);
        // The check can tell: it fails Bfr where its end caps are too coarse.
        if (name == "catmark_pole64") {
            ASSERT_TRUE(bfr[0] && bfr[1]);
            EXPECT_GT(bfr[0]->position, 1e-6);
            EXPECT_GT(bfr[1]->position, 1e-6);
        }
        if (name == "catmark_rook") {
            ASSERT_TRUE(bfr[1]);
            EXPECT_GT(bfr[1]->position, 1e-6);
        }
    }
}

// Where OpenSubdiv 3.5.0 loses sharp edges of patches that overlap themselves.
TEST(LimitSurfaceOracle, CreasedCopyOfTheShapeWithValenceTwo) {
    MESHPREP_REQUIRE_SHARED(shared);
    const Cage cage = test::corpus_cage(shared, "catmark_val2_interior");
    const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
    std::vector<Location> locations;
    std::size_t faces = 0;
    for (std::uint32_t f = 0; f < cage.mesh.face_count(); ++f) {
        const auto vertices =
            std::span(cage.mesh.corner_vertices)
                .subspan(cage.mesh.face_offsets[f],
                         cage.mesh.face_offsets[f + 1] - cage.mesh.face_offsets[f]);
        if (std::ranges::none_of(vertices, [](std::uint32_t v) { return v >= 87 && v <= 94; }))
            continue;
        ++faces;
        const std::uint32_t quads = oracle.is_split_in_quads(f) ? oracle.corner_count(f) : 1;
        for (std::uint32_t quad = 0; quad < quads; ++quad)
            for (std::uint32_t y = 1; y < 512; y += 42)
                for (std::uint32_t x = 1; x < 512; x += 42) locations.push_back({f, quad, x, y});
    }
    ASSERT_GT(faces, 4U);
    const auto limits = oracle.limits(locations, test::location_levels);
    expect_exact(errors_of(cage, oracle, locations, limits), locations);
}

// At the extraordinary vertex itself: position, and the plane of the limit tangents' masks.
TEST(LimitSurfaceOracle, TangentsAtExtraordinaryVerticesAreThoseOfTheMasks) {
    for (const auto scheme : {SubdivisionScheme::catmark, SubdivisionScheme::loop})
        for (const std::uint32_t valence : {3U, 5U, 8U, 16U, 64U}) {
            const Cage cage = test::pole(scheme, valence);
            SCOPED_TRACE(cage.name);
            const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
            std::vector<Location> poles;  // from every face around
            for (std::uint32_t f = 0; f < valence; ++f) poles.push_back({f, 0, 0, 0});
            const auto limits = oracle.limits(poles, 2);
            const auto points = evaluated(cage, oracle, poles, 2);
            for (std::size_t k = 0; k < poles.size(); ++k) {
                ASSERT_TRUE(limits[k].has_normal);
                EXPECT_LE(glm::length(points[k].position - glm::dvec3(limits[k].position)), 1e-13);
                EXPECT_LE(test::angle_degrees(points[k].normal, glm::dvec3(limits[k].normal)),
                          1e-3);
                const glm::dvec3 n = glm::normalize(glm::cross(points[k].du, points[k].dv));
                EXPECT_LE(test::angle_degrees(n, glm::dvec3(limits[k].normal)), 1e-3);
            }
        }
}

// Every corner of every cage: all rules at vertices, sharp edges and darts.
TEST(LimitSurfaceOracle, CagesOwnVertices) {
    for (const Cage& cage : test::own_cages()) {
        SCOPED_TRACE(cage.name);
        const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
        const bool loop = cage.options.scheme == SubdivisionScheme::loop;
        std::vector<Location> corners;
        for (std::uint32_t f = 0; f < oracle.face_count(); ++f)
            for (std::uint32_t i = 0; i < oracle.corner_count(f) && !oracle.is_hole(f); ++i) {
                const bool split = oracle.is_split_in_quads(f);
                corners.push_back({f, split ? i : 0,
                                   !split && (i == 1 || (i == 2 && !loop)) ? 4U : 0U,
                                   !split && i >= 2 ? 4U : 0U});
            }
        const auto limits = oracle.limits(corners, 2);
        const auto points = evaluated(cage, oracle, corners, 2);
        for (std::size_t k = 0; k < corners.size(); ++k) {
            SCOPED_TRACE("face " + std::to_string(corners[k].face) + " at " +
                         std::to_string(corners[k].x) + ", " + std::to_string(corners[k].y) +
                         ", quad " + std::to_string(corners[k].sub_face));
            EXPECT_LE(glm::length(points[k].position - glm::dvec3(limits[k].position)),
                      1e-8 * double(oracle.diagonal()));
            EXPECT_NEAR(glm::length(points[k].normal), 1, 1e-12);
            if (limits[k].has_normal) {
                // Where no derivatives give it, it is a mean of those nearby.
                EXPECT_LE(test::angle_degrees(points[k].normal, glm::dvec3(limits[k].normal)),
                          points[k].fallback_normal ? 1e-2 : 1e-3);
            }
        }
    }
}

TEST(LimitSurfaceOracle, GridsAreThePointsEvaluatedOneByOne) {
    for (const Cage& cage : test::own_cages()) {
        SCOPED_TRACE(cage.name);
        const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
        const auto surface = prep::LimitSurface::make(cage.mesh, cage.options);
        ASSERT_TRUE(surface) << surface.error().text;
        constexpr int rate = 8;
        const std::size_t size = surface->grid_size(rate), count = surface->grid_count();
        std::vector<glm::dvec3> positions(count * size), du(count * size), dv(count * size);
        surface->evaluate_grids(rate, 0, count, {positions, du, dv});
        const bool loop = cage.options.scheme == SubdivisionScheme::loop;
        std::uint32_t sub_face = 0;
        for (std::size_t g = 0; g < count; ++g) {
            const std::uint32_t face = surface->grid_face(g);
            if (!surface->has_limit(face)) continue;
            sub_face = g > 0 && surface->grid_face(g - 1) == face ? sub_face + 1 : 0;
            std::vector<Location> places;
            for (std::uint32_t j = 0; j <= rate; ++j)
                for (std::uint32_t i = 0; i <= (loop ? rate - j : rate); ++i)
                    places.push_back({face, sub_face, i, j});
            ASSERT_EQ(places.size(), size);
            const auto limits = oracle.limits(places, 3);
            for (std::size_t k = 0; k < size; ++k) {
                const glm::dvec3& p = positions[g * size + k];
                ASSERT_LE(glm::length(p - glm::dvec3(limits[k].position)),
                          1e-8 * double(oracle.diagonal()))
                    << "grid " << g << " point " << k;
                if (!limits[k].has_derivatives) continue;
                ASSERT_LE(glm::length(du[g * size + k] - glm::dvec3(limits[k].du)),
                          1e-7 * double(oracle.diagonal()))
                    << "grid " << g << " point " << k;
                ASSERT_LE(glm::length(dv[g * size + k] - glm::dvec3(limits[k].dv)),
                          1e-7 * double(oracle.diagonal()))
                    << "grid " << g << " point " << k;
            }
        }
    }
}

}  // namespace
