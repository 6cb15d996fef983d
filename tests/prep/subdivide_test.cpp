// Refined meshes: their points, their watertightness, their normals, their limits.
#include "prep/subdivide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>

#include "mesh_files.h"
#include "prep/check.h"
#include "sanitized.h"
#include "shapes.h"
#include "shared_data.h"
#include "subdivision_cages.h"

namespace {

using prep::SubdivisionScheme;
using test::Cage;
using test::SubdivisionOracle;

prep::SubdivideOptions at_level(const Cage& cage, int level, bool control_points = false) {
    prep::SubdivideOptions options = cage.options;
    options.level = level;
    options.control_points = control_points;
    return options;
}

// Every output corner has the position of one of the oracle's of its cage face, and every one of
// those is there.
void expect_same_points(const Cage& cage, int level, bool control_points) {
    const auto refined = prep::subdivide(cage.mesh, at_level(cage, level, control_points));
    ASSERT_TRUE(refined) << refined.error().text;
    const prep::Mesh& mesh = refined->mesh;
    const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
    const SubdivisionOracle::Refined truth = oracle.refine_all(level);
    std::map<std::uint32_t, std::vector<glm::dvec3>> points;
    for (std::size_t c = 0; c < truth.corners.size(); ++c) {
        const std::uint32_t v = truth.corner_vertices[c], f = truth.corners[c].face;
        points[f].push_back(
            glm::dvec3(control_points ? truth.control_points[v] : truth.limits[v].position));
    }
    const std::size_t per_face = cage.options.scheme == SubdivisionScheme::loop ? 3 : 4;
    const double tolerance = 1e-8 * double(oracle.diagonal());
    std::map<std::uint32_t, std::size_t> found;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t cage_face = refined->cage_faces[f];
        ASSERT_FALSE(oracle.is_hole(cage_face));
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const glm::dvec3 p = glm::dvec3(mesh.positions[mesh.corner_vertices[c]]) + mesh.origin;
            const double half_ulp = 6e-8 * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
            double best = 1e300;
            for (const glm::dvec3& q : points[cage_face]) best = std::min(best, glm::length(p - q));
            ASSERT_LE(best, tolerance + 2 * half_ulp) << "cage face " << cage_face;
        }
        ++found[cage_face];
    }
    for (std::uint32_t f = 0; f < oracle.face_count(); ++f) {
        if (oracle.is_hole(f)) continue;
        EXPECT_EQ(found[f] * per_face, points[f].size()) << "cage face " << f;
    }
}

TEST(Subdivide, PointsAreTheRulesLimitsOrControlPoints) {
    for (const Cage& cage : test::own_cages())
        for (const bool control_points : {false, true}) {
            SCOPED_TRACE(cage.name + (control_points ? ", control points" : ""));
            expect_same_points(cage, 3, control_points);
        }
}

// A vertex of a refined mesh is one vertex to all of its faces: the edges that have two faces in
// the cage have two in it, and borders are where the cage's are.
TEST(Subdivide, RefinedMeshesAreAsClosedAsTheirCages) {
    const auto borders = [](const prep::Mesh& mesh) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        for (std::size_t f = 0; f < mesh.face_count(); ++f) {
            const std::uint32_t first = mesh.face_offsets[f], n = mesh.face_offsets[f + 1] - first;
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t a = mesh.corner_vertices[first + i];
                const std::uint32_t b = mesh.corner_vertices[first + (i + 1) % n];
                ++edges[{std::min(a, b), std::max(a, b)}];
            }
        }
        std::array<std::size_t, 4> counts{};
        for (const auto& [edge, count] : edges) ++counts[std::size_t(std::min(count, 3))];
        return counts;
    };
    for (const Cage& cage : test::own_cages()) {
        if (cage.name.ends_with("_none") || cage.name == "hole" || cage.name == "vertex_twice")
            continue;  // faces are left out, or fold onto themselves
        SCOPED_TRACE(cage.name);
        const auto before = borders(cage.mesh);
        for (const int level : {1, 3}) {
            const auto refined = prep::subdivide(cage.mesh, at_level(cage, level));
            if (!refined) {
                ADD_FAILURE() << refined.error().text;
                continue;
            }
            const auto after = borders(refined->mesh);
            EXPECT_EQ(after[1], before[1] << level);
            EXPECT_EQ(after[3], before[3] << level);
        }
    }
}

bool unit(const glm::vec3& n) {
    const double length = glm::length(glm::dvec3(n));
    return std::abs(length - 1) < 1e-6;
}

void expect_sound(const prep::SubdividedMesh& refined) {
    const prep::Mesh& mesh = refined.mesh;
    ASSERT_EQ(refined.cage_faces.size(), mesh.face_count());
    ASSERT_EQ(mesh.normals.indices.size(), mesh.corner_count());
    for (const glm::vec3& p : mesh.positions)
        ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        ASSERT_LT(mesh.corner_vertices[c], mesh.vertex_count());
        ASSERT_LT(mesh.normals.indices[c], mesh.normals.values.size());
        ASSERT_TRUE(unit(mesh.normals.values[mesh.normals.indices[c]])) << "corner " << c;
    }
}

// Under sanitizers every level of the smaller cages.
constexpr std::size_t most_faces = test::sanitized ? 300000 : 10000000;

TEST(Subdivide, NormalsAreFiniteAndUnitOnOwnCagesAtLevelsOneToSix) {
    for (const Cage& cage : test::own_cages())
        for (int level = 1; level <= 6; ++level) {
            if (level > 3 && (cage.mesh.face_count() << 2 * level) > most_faces) continue;
            SCOPED_TRACE(cage.name + " at level " + std::to_string(level));
            const auto refined = prep::subdivide(cage.mesh, at_level(cage, level));
            if (!refined) {
                ADD_FAILURE() << refined.error().text;
                continue;
            }
            expect_sound(*refined);
        }
}

TEST(Subdivide, NormalsAreFiniteAndUnitOnTheCorpusAtLevelsOneToSix) {
    MESHPREP_REQUIRE_SHARED(shared);
    for (const std::string& name : test::corpus_cage_names(shared)) {
        const Cage cage = test::corpus_cage(shared, name);
        for (int level = 1; level <= 6; ++level) {
            if (level > 3 && (cage.mesh.face_count() << 2 * level) > most_faces) continue;
            SCOPED_TRACE(name + " at level " + std::to_string(level));
            const auto refined = prep::subdivide(cage.mesh, at_level(cage, level));
            if (!refined) {
                ADD_FAILURE() << refined.error().text;
                continue;
            }
            expect_sound(*refined);
        }
    }
}

TEST(Subdivide, NormalsAreTheLimitsOwn) {
    for (const Cage& cage : test::own_cages()) {
        SCOPED_TRACE(cage.name);
        const int level = 3;
        const auto refined = prep::subdivide(cage.mesh, at_level(cage, level));
        if (!refined) {
            ADD_FAILURE() << refined.error().text;
            continue;
        }
        const SubdivisionOracle oracle(cage.mesh, rules_of(cage));
        const SubdivisionOracle::Refined truth = oracle.refine_all(level);
        // Corners of the oracle's faces, each seen from its own side.
        const auto limits = oracle.limits(truth.corners, level);
        std::map<std::uint32_t, std::vector<std::size_t>> corners;
        for (std::size_t c = 0; c < truth.corners.size(); ++c)
            corners[truth.corners[c].face].push_back(c);
        const prep::Mesh& mesh = refined->mesh;
        const double tolerance = 1e-6 * double(oracle.diagonal());
        for (std::size_t f = 0; f < mesh.face_count(); ++f)
            for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
                const glm::dvec3 p = mesh.positions[mesh.corner_vertices[c]];
                const glm::dvec3 n = mesh.normals.values[mesh.normals.indices[c]];
                double best = 1e300;
                bool known = true;
                for (const std::size_t k : corners[refined->cage_faces[f]]) {
                    if (glm::length(glm::dvec3(limits[k].position) - p) > tolerance) continue;
                    known &= limits[k].has_normal;
                    best = std::min(best, test::angle_degrees(n, glm::dvec3(limits[k].normal)));
                }
                // Bilinear faces have a normal each, and share one where they are smooth.
                if (known && cage.options.scheme != SubdivisionScheme::bilinear) {
                    ASSERT_LE(best, 1e-2) << "cage face " << refined->cage_faces[f] << " at " << p.x
                                          << ", " << p.y << ", " << p.z;
                }
            }
    }
}

TEST(Subdivide, RandomCagesWithCreasesGiveSoundMeshes) {
    constexpr int cages = test::sanitized ? 200 : 1000;
    std::size_t refused = 0;
    for (int seed = 0; seed < cages; ++seed) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed));
        const Cage cage = test::random_cage(random);
        SCOPED_TRACE("seed " + std::to_string(seed));
        const auto refined = prep::subdivide(cage.mesh, at_level(cage, 1 + seed % 3));
        if (!refined) {
            ++refused;
            EXPECT_FALSE(refined.error().text.empty());
            continue;
        }
        expect_sound(*refined);
        if (HasFatalFailure()) return;
    }
    EXPECT_EQ(refused, 0U);
}

std::string error_of(const prep::Mesh& mesh, const prep::SubdivideOptions& options = {}) {
    const auto refined = prep::subdivide(mesh, options);
    return refined ? "no error" : refined.error().text + " " + refined.error().place;
}

TEST(Subdivide, ErrorsNameWhatIsWrong) {
    prep::Mesh nan = shapes::cube();
    nan.positions[5].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(error_of(nan).find("5"), std::string::npos);
    prep::Mesh quads = shapes::cube();
    prep::SubdivideOptions loop;
    loop.scheme = SubdivisionScheme::loop;
    EXPECT_NE(error_of(quads, loop).find("triangle"), std::string::npos) << error_of(quads, loop);
    prep::SubdivideOptions deep;
    deep.level = 11;
    EXPECT_NE(error_of(quads, deep).find("10"), std::string::npos) << error_of(quads, deep);
    deep.level = -1;
    EXPECT_NE(error_of(quads, deep), "no error");
    // 6 · 4^10 faces are 6,291,456: the number that is too large and the limit are named.
    deep.level = 10;
    deep.max_faces = 1000000;
    const std::string many = error_of(quads, deep);
    EXPECT_NE(many.find("6291456"), std::string::npos) << many;
    EXPECT_NE(many.find("1000000"), std::string::npos) << many;
    prep::Mesh tagged = shapes::cube();
    tagged.subdivision.creases.push_back({0, 99, 1});
    EXPECT_NE(error_of(tagged).find("99"), std::string::npos) << error_of(tagged);
    tagged.subdivision = {};
    tagged.subdivision.corners.push_back({77, 1});
    EXPECT_NE(error_of(tagged).find("77"), std::string::npos) << error_of(tagged);
    tagged.subdivision = {};
    tagged.subdivision.holes.push_back(66);
    EXPECT_NE(error_of(tagged).find("66"), std::string::npos) << error_of(tagged);
    prep::Mesh moved = shapes::cube();
    moved.morph_targets.push_back({{}, {}, {}, "smile", 0});
    std::vector<glm::vec3> deltas(8, glm::vec3(0.0F));
    deltas[6].z = std::numeric_limits<float>::infinity();
    moved.morph_targets[0].positions.push_back(
        {0, std::make_shared<const std::vector<glm::vec3>>(deltas)});
    EXPECT_NE(error_of(moved).find("'smile' moves vertex 6"), std::string::npos) << error_of(moved);
    prep::Mesh skinned = shapes::cube();
    skinned.skin_influences.resize(1);
    skinned.skin_influences[0].joints.assign(8, glm::vec<4, std::uint16_t>(0));
    skinned.skin_influences[0].weights.assign(8, glm::vec4(1, 0, 0, 0));
    skinned.skin_influences[0].weights[3].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(error_of(skinned).find("vertex 3"), std::string::npos) << error_of(skinned);
}

// Each of them asks for 12 · 2^10 small faces beside it, whatever the level.
TEST(Subdivide, ManySharpCreasesOfManySharpnessesAreRefused) {
    prep::Mesh grid = shapes::grid(130, 130);
    std::uint32_t k = 0;
    for (std::uint32_t f = 0; f < grid.face_count(); ++f)
        grid.subdivision.creases.push_back({grid.corner_vertices[grid.face_offsets[f]],
                                            grid.corner_vertices[grid.face_offsets[f] + 1],
                                            9.1F + 0.1F * float(k++ % 8)});
    const std::string refused = error_of(grid);
    EXPECT_NE(refused.find("semi-sharp"), std::string::npos) << refused;
    EXPECT_NE(refused.find("67108864"), std::string::npos) << refused;
    // One sharpness along whole lines is a patch.
    for (prep::EdgeMark& crease : grid.subdivision.creases) crease.sharpness = 1;
    prep::SubdivideOptions options;
    options.level = 1;
    EXPECT_EQ(error_of(grid, options), "no error");
}

TEST(Subdivide, NamesBetweenNamesAreNotMade) {
    prep::Mesh mesh = shapes::cube();
    mesh.vertex_attributes.push_back({"_FEATURE_ID_0", 1, {0, 1, 2, 3, 4, 5, 6, 7}});
    mesh.vertex_attributes.push_back({"_HEAT", 1, {0, 1, 2, 3, 4, 5, 6, 7}});
    const auto refined = prep::subdivide(mesh);
    ASSERT_TRUE(refined) << refined.error().text;
    ASSERT_EQ(refined->mesh.vertex_attributes.size(), 2U);
    EXPECT_TRUE(refined->mesh.vertex_attributes[0].values.empty());
    EXPECT_FALSE(refined->mesh.vertex_attributes[1].values.empty());
}

TEST(Subdivide, EmptyMeshesAndSingleFaces) {
    const auto nothing = prep::subdivide(prep::Mesh{});
    ASSERT_TRUE(nothing) << nothing.error().text;
    EXPECT_EQ(nothing->mesh.face_count(), 0U);
    const auto triangle = prep::subdivide(shapes::polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    ASSERT_TRUE(triangle) << triangle.error().text;
    EXPECT_EQ(triangle->mesh.face_count(), 12U);
    expect_sound(*triangle);
    // No area at all: the rules hold, the normals are told as fallbacks.
    const auto point = prep::subdivide(shapes::polygon({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}));
    ASSERT_TRUE(point) << point.error().text;
    expect_sound(*point);
    EXPECT_GT(point->fallback_normals, 0U);
}

// A pole or a polygon of more than 512 corners is refused by its name, its count and the limit, and
// at once.
TEST(Subdivide, PolesAndPolygonsBeyondTheLimitAreRefused) {
    for (const std::uint32_t n : {513U, 100000U}) {
        prep::Mesh pole;
        pole.positions.assign(n + 1, glm::vec3(0.0F));
        prep::Mesh polygon;
        for (std::uint32_t i = 0; i < n; ++i) {
            const double angle = 6.283185307 * i / n;
            pole.positions[i + 1] = {std::cos(angle), std::sin(angle), 0.1F};
            polygon.positions.push_back(pole.positions[i + 1]);
            polygon.corner_vertices.push_back(i);
            for (const std::uint32_t v : {0U, 1 + i, 1 + (i + 1) % n})
                pole.corner_vertices.push_back(v);
            pole.face_offsets.push_back(3 * (i + 1));
        }
        polygon.face_offsets.push_back(n);
        for (const prep::Mesh* mesh : {&pole, &polygon}) {
            const std::string text = error_of(*mesh);
            EXPECT_NE(text.find(mesh == &pole ? "vertex" : std::to_string(n)), std::string::npos)
                << text;
            EXPECT_NE(text.find("512"), std::string::npos) << text;
            EXPECT_FALSE(prep::LimitSurface::make(*mesh));
        }
    }
    const auto largest = prep::subdivide(test::pole(SubdivisionScheme::catmark, 512).mesh);
    ASSERT_TRUE(largest) << largest.error().text;
    expect_sound(*largest);
}

TEST(Subdivide, SameBytesForAnyThreadsAndInstructionSet) {
    for (const Cage& cage : test::own_cages()) {
        SCOPED_TRACE(cage.name);
        prep::SubdivideOptions options = at_level(cage, 3);
        test::expect_same_of_any_threads(cage.mesh, options,
                                         [](const prep::Mesh& a, const prep::Mesh& b) {
                                             EXPECT_EQ(test::exact_difference(a, b), "");
                                         });
    }
}

// Faces in another order: the same faces, but for the order and the last bits of sums.
TEST(Subdivide, OrderOfFacesChangesNothingButOrder) {
    std::mt19937_64 random(21);
    for (const Cage& cage : test::own_cages()) {
        if (!cage.mesh.subdivision.holes.empty()) continue;
        SCOPED_TRACE(cage.name);
        const auto order = shapes::random_order(cage.mesh.face_count(), random);
        const prep::Mesh permuted = shapes::with_face_order(cage.mesh, order);
        const auto a = prep::subdivide(cage.mesh, at_level(cage, 2));
        const auto b = prep::subdivide(permuted, at_level(cage, 2));
        if (!a || !b) {
            ADD_FAILURE();
            continue;
        }
        const auto points_of = [](const prep::SubdividedMesh& refined, std::uint32_t cage_face) {
            std::vector<glm::vec3> points;
            const prep::Mesh& mesh = refined.mesh;
            for (std::size_t f = 0; f < mesh.face_count(); ++f)
                for (std::uint32_t c = mesh.face_offsets[f];
                     refined.cage_faces[f] == cage_face && c < mesh.face_offsets[f + 1]; ++c)
                    points.push_back(mesh.positions[mesh.corner_vertices[c]]);
            return points;
        };
        for (std::uint32_t f = 0; f < order.size(); ++f) {
            const auto before = points_of(*a, order[f]), after = points_of(*b, f);
            ASSERT_EQ(before.size(), after.size());
            for (std::size_t k = 0; k < before.size(); ++k)
                ASSERT_LE(glm::length(before[k] - after[k]), 1e-6F);
        }
    }
}

TEST(Subdivide, LevelsAreNested) {
    for (const Cage& cage : test::own_cages()) {
        SCOPED_TRACE(cage.name);
        const auto coarse = prep::subdivide(cage.mesh, at_level(cage, 1));
        const auto fine = prep::subdivide(cage.mesh, at_level(cage, 3));
        if (!coarse || !fine) {
            ADD_FAILURE();
            continue;
        }
        // Cage vertices are where they were, bit for bit: a point does not depend on the level.
        std::map<std::uint32_t, glm::vec3> at;
        for (std::size_t v = 0; v < coarse->cage_vertices.size(); ++v)
            if (coarse->cage_vertices[v] != prep::no_index)
                at[coarse->cage_vertices[v]] = coarse->mesh.positions[v];
        EXPECT_FALSE(at.empty() && coarse->mesh.face_count() > 0);
        for (std::size_t v = 0; v < fine->cage_vertices.size(); ++v)
            if (fine->cage_vertices[v] != prep::no_index) {
                EXPECT_LE(glm::length(at.at(fine->cage_vertices[v]) - fine->mesh.positions[v]),
                          1e-6F);
            }
    }
}

// About an origin far away the same points, to the same precision.
TEST(Subdivide, FarFromZeroAsPreciseAsAtZero) {
    prep::Mesh near = shapes::cube(), far = shapes::cube();
    far.origin = {1e6, -2e6, 3e5};
    const auto a = prep::subdivide(near), b = prep::subdivide(far);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(b->mesh.origin, far.origin);
    for (std::size_t v = 0; v < a->mesh.positions.size(); ++v)
        EXPECT_EQ(a->mesh.positions[v], b->mesh.positions[v]);
}

// A moved-from mesh has no face offsets, not even the first.
TEST(Subdivide, MeshesWithoutFacesAreLikeThoseThatWereMovedFrom) {
    prep::Mesh without = shapes::cube();
    without.face_offsets = {0};
    without.corner_vertices.clear();
    prep::Mesh moved = without;
    moved.face_offsets.clear();
    const auto a = prep::subdivide(without), b = prep::subdivide(moved);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
        EXPECT_EQ(b->mesh.face_count(), 0u);
        EXPECT_EQ(a->mesh.positions, b->mesh.positions);
    }
}

}  // namespace
