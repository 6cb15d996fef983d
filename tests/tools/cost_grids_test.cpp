// Grids of `meshprep cost`, reasons of what is dominated, and what stands in for a surface that is
// not known: coarser meshes, and distances from the surface back.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "climbed_ladders.h"
#include "cost/ladders/coarse_mesh.h"
#include "cost/ladders/meshes.h"
#include "cost/ladders/spline_cage.h"
#include "cost/oracles/pictures.h"
#include "cost/oracles/weighted_normals.h"
#include "prep/subdivide.h"
#include "shapes.h"

namespace {

using cost::Ladder;
using test::climbed;
using test::expect_errors;
using test::ladder_named;

// Rungs of a grid are the pairs of two settings' values, and each is in its place.
TEST(CostLadders, GridsHaveARungForEachPair) {
    std::set<std::string> grids;
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        if (!row.grid) continue;
        grids.insert(row.name);
        const Ladder ladder = ladder_named(row.name);
        ASSERT_EQ(ladder.grid.size(), 2u);
        const auto &first = ladder.grid[0].values, &second = ladder.grid[1].values;
        EXPECT_FALSE(ladder.grid[0].name.empty() || ladder.grid[1].name.empty());
        ASSERT_EQ(ladder.rungs.size(), first.size() * second.size()) << row.name;
        EXPECT_GE(std::min(first.size(), second.size()), 2u) << row.name;
        EXPECT_LE(ladder.rungs.size(), 64u) << row.name;  // as many as a document may have
        for (std::size_t i = 0; i < ladder.rungs.size(); ++i)
            EXPECT_EQ(ladder.rungs[i].name,
                      first[i / second.size()] + ", " + second[i % second.size()]);
    }
    EXPECT_EQ(grids, (std::set<std::string>{"samples-by-supersampling", "weight-by-precision",
                                            "chord-error-by-height-filter", "shading-frequency",
                                            "height-filter"}));
}

// Rungs stand in the order of their work (grids: along both settings): one with more error than
// one before it says why.
TEST(CostLadders, WhereMoreWorkMayGiveMoreErrorTheReasonIsSaid) {
    std::size_t rising = 0;
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        const Ladder ladder = ladder_named(row.name);
        auto n = climbed(ladder);
        const std::size_t columns = ladder.grid.empty() ? 0 : ladder.grid[1].values.size();
        for (std::size_t i = 0; i < ladder.rungs.size(); ++i)
            for (std::size_t j = i + 1; j < ladder.rungs.size(); ++j) {
                if (columns > 0 && (j / columns < i / columns || j % columns < i % columns))
                    continue;
                const cost::Rung &less = ladder.rungs[i], &more = ladder.rungs[j];
                if (less.exact || more.exact) continue;
                if (!(n[more.name][ladder.primary] > 1.001 * n[less.name][ladder.primary]))
                    continue;
                ++rising;
                EXPECT_FALSE(more.because.empty())
                    << row.name << ": " << more.name << " has more error than " << less.name;
            }
    }
    EXPECT_GT(rising, 20u);
}

// The arithmetic moves nothing of what a weight misses of the surface, and the definition knows
// which weight it was.
TEST(CostLadders, WeightByPrecision) {
    auto n = climbed(ladder_named("weight-by-precision"));
    const std::pair<const char*, double> means[] = {{"area", 2.579},
                                                    {"uniform", 1.871},
                                                    {"angle", 1.071},
                                                    {"area-angle", 2.010},
                                                    {"edge-length", 0.5353}};
    for (const auto& [weight, mean] : means)
        EXPECT_NEAR(n[std::string(weight) + ", accurate"][2], mean, 0.03 * mean) << weight;

    for (const char* weight : {"area", "uniform", "angle", "area-angle", "edge-length"}) {
        const std::string name = weight;
        EXPECT_NEAR(n[name + ", fast"][2] / n[name + ", exact"][2], 1, 1e-5) << name;
        EXPECT_NEAR(n[name + ", accurate"][2] / n[name + ", exact"][2], 1, 1e-5) << name;
        for (const char* precision : {", fast", ", accurate", ", exact"})
            EXPECT_LT(n[name + precision][3], 1e-5) << name << precision;
    }
}

// Each pair has exactly the samples of its definition; samples of a finer picture count as many.
TEST(CostLadders, SamplesBySupersampling) {
    auto n = climbed(ladder_named("samples-by-supersampling"));
    auto alone = climbed(ladder_named("anti-aliasing"));
    // Thirds of a picture's lines are rounded: a float's rounding, no sample.
    for (const auto& [name, numbers] : n)
        EXPECT_LE(numbers[3], name.find("× 3") == std::string::npos ? 0 : 2e-8) << name;
    EXPECT_EQ(n["4, × 1"][0], alone["4 samples"][0]);
    EXPECT_EQ(n["1, × 4"][0], alone["supersample 4"][0]);
    for (const char* side : {", × 1", ", × 2", ", × 3", ", × 4"}) {
        double last = 1;
        for (const char* samples : {"1", "2", "4", "8", "16"}) {
            const double now = n[std::string(samples) + side][0];
            // The 16 standard samples lie 1/32 pixel off the middle: seen where little else is
            // left.
            if (std::string(samples) + side == "16, × 4")
                EXPECT_GT(now, last);
            else
                EXPECT_LT(now, last) << samples << side;
            last = now;
        }
    }
    cost::Point2 off(0);
    for (const cost::Point2& p : cost::standard_places(16)) off += p / cost::Real(16);
    EXPECT_EQ(off, cost::Point2(15 / 32.0));
    expect_errors(
        n, 0,
        {{"1, × 1", 0.1694},   {"1, × 2", 0.05966},  {"1, × 3", 0.03304},   {"1, × 4", 0.02066},
         {"2, × 1", 0.1103},   {"2, × 2", 0.03650},  {"2, × 3", 0.01945},   {"2, × 4", 0.01250},
         {"4, × 1", 0.06293},  {"4, × 2", 0.02188},  {"4, × 3", 0.01189},   {"4, × 4", 0.007563},
         {"8, × 1", 0.03863},  {"8, × 2", 0.01301},  {"8, × 3", 0.007148},  {"8, × 4", 0.004458},
         {"16, × 1", 0.02875}, {"16, × 2", 0.01133}, {"16, × 3", 0.006865}, {"16, × 4", 0.004820}});
}

// What a map loses of the surface is left however fine the triangles: bilinear ends at 5.9e-4,
// bicubic is a fifth of that.
TEST(CostLadders, ChordErrorByHeightFilter) {
    auto n = climbed(ladder_named("chord-error-by-height-filter"));
    auto alone = climbed(ladder_named("height-filter"));
    for (const char* filter : {"bilinear", "bicubic"}) {
        const std::string name = filter;
        EXPECT_EQ(n[name + ", 0.0001"], alone[name + ", 32²"]);
        EXPECT_GT(n[name + ", 0.0001"][3], n[name + ", 0.01"][3]);
    }
    EXPECT_GT(n["bilinear, 0.0003"][0], n["bilinear, 0.0001"][0] * 0.9);
    expect_errors(n, 0,
                  {{"bilinear, 0.01", 9.495e-3},
                   {"bilinear, 0.003", 3.049e-3},
                   {"bilinear, 0.001", 1.179e-3},
                   {"bilinear, 0.0003", 7.24e-4},
                   {"bilinear, 0.0001", 5.89e-4},
                   {"bicubic, 0.01", 9.178e-3},
                   {"bicubic, 0.003", 2.826e-3},
                   {"bicubic, 0.001", 9.33e-4},
                   {"bicubic, 0.0003", 2.85e-4},
                   {"bicubic, 0.0001", 1.10e-4}},
                  0.1);
}

// A torus of 49,152 triangles, its positions moved along the normals by up to `noise`.
cost::KnownMesh scan_of_a_torus(double noise) {
    cost::KnownMesh known = cost::known_torus(256, 96, 0.25);
    std::mt19937_64 random(5);
    for (std::size_t v = 0; v < known.mesh.positions.size(); ++v)
        known.mesh.positions[v] +=
            glm::vec3(known.at[v].normal) * float(noise * (double(random() >> 11) * 0x1p-52 - 1));
    return known;
}

// Of a mesh that is given, weights are held against what the dense mesh says of a coarse one: the
// order is that against the surface itself, which the dense mesh does not know.
TEST(CostLadders, NormalWeightOfAMeshThatIsGiven) {
    for (const double noise : {0.0, 1e-4}) {
        const cost::KnownMesh known = scan_of_a_torus(noise);
        const Ladder ladder = ladder_named("normal-weight", &known.mesh);
        EXPECT_NE(ladder.subject.find("mesh, reduced from 49152 to "), std::string::npos)
            << ladder.subject;
        auto n = climbed(ladder);
        // The surface itself, at the vertices of the same coarse mesh.
        const cost::CoarseMesh coarse = cost::coarse_mesh(known.mesh, 0.25);
        EXPECT_NEAR(double(coarse.mesh.face_count()), 49152 / 4.0, 20);
        std::map<std::string, double> mean;
        for (const auto& [name, numbers] : n) {
            const std::vector<cost::Vector> own =
                cost::weighted_normals(coarse.mesh.positions, coarse.mesh.corner_vertices, name);
            std::vector<double> errors;
            for (const std::uint32_t v : coarse.mesh.corner_vertices)
                errors.push_back(
                    cost::degrees_between(own[v], known.at[coarse.dense_vertices[v]].normal));
            mean[name] = cost::summary_of(errors).mean;
            EXPECT_NEAR(numbers[2] / mean[name], 1, 0.05) << name << ", noise " << noise;
            EXPECT_LT(numbers[3], 1e-5) << name;
        }
        EXPECT_LT(*ladder.floor, mean["edge-length"] / 3);
        if (noise == 0) {
            EXPECT_LT(n["edge-length"][2], n["area"][2] / 2);
        }
    }
    // Too few vertices, or none that is smooth: the torus, and the ladder says so.
    const prep::Mesh ball = shapes::icosphere(2);
    const Ladder ladder = ladder_named("normal-weight", &ball);
    EXPECT_NE(ladder.subject.find("mesh has too few smooth vertices"), std::string::npos);
    EXPECT_EQ(ladder.metrics.size(), 5u);
}

// Triangles stay triangles: closed, the way they faced, none a needle, of vertices there were.
TEST(CostLadders, CoarseMeshesAreMeshesOfSomeOfTheVertices) {
    cost::KnownMesh known = scan_of_a_torus(0);
    const cost::CoarseMesh coarse = cost::coarse_mesh(known.mesh, 0.25);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (std::size_t f = 0; f < coarse.mesh.face_count(); ++f) {
        const std::uint32_t* const v = &coarse.mesh.corner_vertices[3 * f];
        cost::Vector p[3], middle(0);
        for (int k = 0; k < 3; ++k) {
            ++edges[{v[k], v[(k + 1) % 3]}];
            p[k] = cost::Vector(coarse.mesh.positions[v[k]]);
            middle += p[k] / cost::Real(3);
            EXPECT_EQ(coarse.mesh.positions[v[k]],
                      known.mesh.positions[coarse.dense_vertices[v[k]]]);
        }
        EXPECT_LT(cost::degrees_between(glm::cross(p[1] - p[0], p[2] - p[0]),
                                        cost::torus_normal_near(middle)),
                  45);
    }
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
    }
    // A torus: as many vertices and faces as edges.
    EXPECT_EQ(coarse.mesh.positions.size() + coarse.mesh.face_count(), edges.size() / 2);
    // Torn at every corner, it is the same; what is open keeps its rim.
    prep::Mesh soup;
    soup.face_offsets = known.mesh.face_offsets;
    for (const std::uint32_t v : known.mesh.corner_vertices) {
        soup.corner_vertices.push_back(std::uint32_t(soup.positions.size()));
        soup.positions.push_back(known.mesh.positions[v]);
    }
    EXPECT_EQ(cost::coarse_mesh(soup, 0.25).mesh.positions.size(), coarse.mesh.positions.size());
    prep::Mesh odd = soup;  // two of its numbers are none
    odd.positions[0].x = std::numeric_limits<float>::quiet_NaN();
    odd.positions[9].y = std::numeric_limits<float>::infinity();
    EXPECT_LT(cost::coarse_mesh(odd, 0.25).mesh.positions.size(), 7000u);
    EXPECT_EQ(cost::coarse_mesh({}, 0.25).mesh.face_count(), 0u);
    const prep::Mesh cube = shapes::icosphere(0);
    EXPECT_LE(cost::coarse_mesh(cube, 0).mesh.positions.size(), cube.positions.size());
}

// A face that is missing changes nothing of the way from the mesh, and all of the way back.
TEST(CostLadders, DistancesBackSeeWhatIsMissing) {
    const cost::SplineCage cage;
    prep::SubdivideOptions options;
    options.level = 4;
    const auto refined = prep::subdivide(cage.mesh, options);
    ASSERT_TRUE(refined);
    prep::Mesh mesh = refined->mesh;
    const double whole = cost::farthest_from(cage, mesh);
    EXPECT_LT(whole, 2e-4);
    mesh.face_offsets.resize(mesh.face_offsets.size() - 256);  // one of the cage's 48
    mesh.corner_vertices.resize(mesh.face_offsets.back());
    EXPECT_GT(cost::farthest_from(cage, mesh), 20 * whole);
    EXPECT_LT(cost::summary_of(cost::limit_errors(cage, mesh).distances).largest, 2e-4);
    EXPECT_EQ(cost::farthest_from(cage, {}), std::numeric_limits<double>::infinity());
}

}  // namespace
