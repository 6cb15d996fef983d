// The pieces of limit surfaces, each against what it must be equal to: refinement, taken far.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "limit_surface/bicubic.h"
#include "limit_surface/channel_surface.h"
#include "limit_surface/extraordinary_ring.h"
#include "limit_surface/loop_patch.h"
#include "prep/subdivide.h"
#include "simd_levels.h"
#include "subdivision_cages.h"

namespace prep {
namespace {

using detail::RingShape;

std::vector<double> random_numbers(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<double> numbers(count);
    for (double& number : numbers) number = double(random() % 4096) / 4096 - 0.5;
    return numbers;
}

// All shapes of few sectors.
std::vector<RingShape> shapes() {
    std::vector<RingShape> all;
    for (const bool triangles : {false, true})
        for (const std::uint16_t sectors :
             std::initializer_list<std::uint16_t>{1, 2, 3, 4, 5, 7, 12})
            for (const bool closed : {true, false})
                for (const bool sharp : {true, false})
                    for (const bool corner : {true, false})
                        if ((!closed && !sharp) || (closed && sectors > 1))
                            all.push_back({sectors, closed, sharp, corner, triangles});
    return all;
}

std::vector<double> refined(const RingShape& shape, std::uint32_t width, std::vector<double> rings,
                            int levels) {
    std::vector<double> next(rings.size());
    for (int k = 0; k < levels; ++k) {
        detail::refine_ring(shape, width, rings.data(), next.data());
        rings.swap(next);
    }
    return rings;
}

TEST(ExtraordinaryRing, LimitOfTheVertexIsWhereRefinementTakesIt) {
    for (const RingShape& shape : shapes()) {
        const auto rings = random_numbers(shape.point_count() * 3, shape.sectors);
        std::vector<double> value(3), t0(3), t1(3), scratch(2 * rings.size());
        detail::ring_limit(shape, 3, rings.data(), value.data(), t0.data(), t1.data(), scratch);
        const auto far = refined(shape, 3, rings, 90);
        for (int d = 0; d < 3; ++d)
            EXPECT_NEAR(value[d], far[d], 1e-12)
                << shape.sectors << shape.closed << shape.corner_rule;
    }
}

TEST(ExtraordinaryRing, TangentsAreEigenvectorsOfRefinement) {
    // Refining scales each by its eigenvalue, whatever the points are: two inputs, one ratio.
    for (const RingShape& shape : shapes()) {
        if (shape.corner_rule || (shape.closed && shape.sharp_edge) || shape.sectors < 2) continue;
        if (shape.triangles && shape.closed && shape.sectors == 2) continue;  // has none
        double ratios[2][2];
        for (const unsigned seed : {0U, 1U}) {
            const auto rings = random_numbers(shape.point_count(), 10 + seed);
            double value, before[2], after[2];
            std::vector<double> scratch(2 * rings.size());
            detail::ring_limit(shape, 1, rings.data(), &value, before, before + 1, scratch);
            detail::ring_limit(shape, 1, refined(shape, 1, rings, 1).data(), &value, after,
                               after + 1, scratch);
            for (int k = 0; k < 2; ++k) ratios[seed][k] = after[k] / before[k];
        }
        for (int k = 0; k < 2; ++k) {
            EXPECT_NEAR(ratios[0][k], ratios[1][k], 1e-9)
                << shape.sectors << shape.closed << shape.triangles << k;
            EXPECT_GT(ratios[0][k], 0.2);
            EXPECT_LT(ratios[0][k], 0.9);
        }
    }
}

TEST(ExtraordinaryRing, PatchesMeetTheLimitsOfTheirCorners) {
    const RingShape shape{5, true, false, false, false};
    const auto rings = random_numbers(shape.point_count(), 3), next = refined(shape, 1, rings, 1);
    double value, da, db, at[3], controls[16];
    detail::ring_corner_limit(shape, 1, rings.data(), 2, 1, 1, &value, &da, &db);
    detail::ring_patch(shape, 1, rings.data(), next.data(), 2, 1, 1, controls);
    const auto end = detail::bicubic_weights(1);
    detail::bicubic_point(1, controls, end, end, at, at + 1, at + 2);
    EXPECT_NEAR(at[0], value, 1e-15);
    EXPECT_NEAR(2 * at[1], da, 1e-14);
    EXPECT_NEAR(2 * at[2], db, 1e-14);
}

TEST(Bicubic, CreaseWeightsJoinTheCornerAndTheSpline) {
    for (const double t : {0.0, 0.1, 0.25, 0.4, 0.7, 1.0}) {
        const auto smooth = detail::bicubic_weights(t), plain = detail::crease_weights(t, 0);
        for (int k = 0; k < 4; ++k) EXPECT_EQ(smooth.value[k], plain.value[k]);
        for (const float sharpness : {0.3F, 1.0F, 2.7F, 9.5F}) {
            const auto weights = detail::crease_weights(t, sharpness);
            EXPECT_NEAR(std::accumulate(weights.value, weights.value + 4, 0.0), 1, 1e-15);
            EXPECT_NEAR(std::accumulate(weights.derivative, weights.derivative + 4, 0.0), 0, 1e-11);
        }
    }
    // Nine levels of a corner are nearly one.
    EXPECT_NEAR(detail::crease_weights(0, 9).value[1], 1, 1e-2);
}

TEST(Bicubic, RefinedControlPointsTendToTheCurve) {
    const auto coarse = detail::BicubicTable::make_crease(4, 1.5F);
    const auto fine = detail::BicubicTable::make_crease(1024, 1.5F);
    for (std::uint32_t i = 0; i <= 4; ++i)
        for (std::uint32_t k = 0; k < 4; ++k)
            EXPECT_NEAR(coarse.value[4 * i + k], fine.control[4 * 256 * i + k], 3e-6);
}

// Sums of four in the kernels' order, for every width and grid: vectors that reach beyond a point
// or a row must leave nothing of it.
TEST(Bicubic, KernelsGiveTheScalarBits) {
    for (const std::uint32_t width : {1U, 2U, 3U, 4U, 5U, 9U})
        for (const std::uint32_t n : {1U, 2U, 4U, 8U}) {
            const auto table = detail::BicubicTable::make(n);
            const auto across = detail::BicubicTable::make_crease(n, 1.7F);
            const auto controls = random_numbers(detail::bicubic_controls(width), width);
            const std::size_t row = std::size_t(n + 1) * width, stride = row + 2;
            std::vector<double> expected(3 * (n + 1) * stride, 7.0);
            const auto sum = [](const double* w, double a, double b, double c, double d) {
                return ((w[0] * a + w[1] * b) + w[2] * c) + w[3] * d;
            };
            for (std::uint32_t j = 0; j <= n; ++j)
                for (std::uint32_t i = 0; i <= n; ++i)
                    for (std::uint32_t d = 0; d < width; ++d)
                        for (int output = 0; output < 3; ++output) {
                            const auto& u = output == 1 ? table.derivative : table.value;
                            const auto& v = output == 2 ? across.derivative : across.value;
                            double rows[4];
                            for (std::uint32_t b = 0; b < 4; ++b) {
                                const double* c = controls.data() + 4 * b * width + d;
                                rows[b] = sum(u.data() + 4 * i, c[0], c[width], c[2 * width],
                                              c[3 * width]);
                            }
                            const double value =
                                sum(v.data() + 4 * j, rows[0], rows[1], rows[2], rows[3]);
                            expected[output * (n + 1) * stride + j * stride + i * width + d] =
                                output == 0 ? value : 2 * value;
                        }
            for (const prep::SimdLevel level : ::test::every_level()) {
                std::vector<double> out(expected.size(), 7.0);
                std::vector<double> scratch(detail::bicubic_scratch(width, n));
                double* const du = out.data() + (n + 1) * stride;
                const detail::GridOutput to{out.data(), du, du + (n + 1) * stride, stride, 2};
                detail::bicubic_grid(table, across, false, width, controls.data(), to,
                                     scratch.data(), level);
                EXPECT_EQ(out, expected) << to_string(level) << ' ' << width << ' ' << n;
            }
        }
}

TEST(LoopPatch, WeightsAreThoseOfTheBoxSpline) {
    for (const auto& [u, v] : {std::pair(0.0, 0.0), {0.3, 0.2}, {0.0, 1.0}, {1 / 3.0, 1 / 3.0}}) {
        const auto weights = detail::loop_weights(u, v);
        double x = 0, y = 0, sum = 0, dx = 0, dy = 0;
        for (int k = 0; k < 12; ++k) {
            const auto [cx, cy] = detail::loop_controls[k];
            sum += weights.value[k];
            x += weights.value[k] * cx, y += weights.value[k] * cy;
            dx += weights.du[k] * cx, dy += weights.du[k] * cy;
        }
        EXPECT_NEAR(sum, 1, 1e-15);
        EXPECT_NEAR(x, u, 1e-15);
        EXPECT_NEAR(y, v, 1e-15);
        EXPECT_NEAR(dx, 1, 1e-14);
        EXPECT_NEAR(dy, 0, 1e-14);
    }
    EXPECT_NEAR(detail::loop_weights(0, 0).value[0], 0.5, 1e-15);
}

Mesh cube() {
    Mesh mesh;
    for (int k = 0; k < 8; ++k) mesh.positions.emplace_back(k & 1, k >> 1 & 1, k >> 2);
    mesh.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    mesh.face_offsets = {0, 4, 8, 12, 16, 20, 24};
    return mesh;
}

Mesh tetrahedron() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.corner_vertices = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    mesh.face_offsets = {0, 3, 6, 9, 12};
    return mesh;
}

TEST(PatchTree, RefusesMorePiecesThanItsLimitAndCountsThem) {
    for (const bool triangles : {false, true}) {
        SubdivideOptions options;
        if (triangles) options.scheme = SubdivisionScheme::loop;
        Mesh mesh = triangles ? tetrahedron() : cube();
        mesh.subdivision.creases = {{0, 1, 1.5F}};
        const auto cage = detail::position_cage(mesh, options);
        ASSERT_TRUE(cage);
        const auto refined = detail::RefinedCage::make(*cage);
        ASSERT_TRUE(refined);
        const auto tree = detail::PatchTree::make(*refined);
        ASSERT_TRUE(tree);
        const auto count =
            std::uint32_t(tree->regular_patches.size() + tree->triangle_patches.size() +
                          tree->crease_patches.size() + tree->sectors.size());
        EXPECT_GT(count, 16U);
        EXPECT_TRUE(detail::PatchTree::make(*refined, count));
        for (const std::uint32_t most : {count - 1, 5U}) {
            const auto refused = detail::PatchTree::make(*refined, most);
            ASSERT_FALSE(refused);
            EXPECT_EQ(refused.error().code, ErrorCode::limit);
            const std::string& text = refused.error().text;
            EXPECT_NE(text.find(std::to_string(count) + " pieces"), std::string::npos) << text;
            EXPECT_NE(text.find("limit is " + std::to_string(most)), std::string::npos) << text;
        }
    }
}

// A ring needs nothing but regular vertices around it: cutting is for what is closer together.
TEST(PatchTree, CutsOnlyWhereExtraordinaryVerticesAreNeighbours) {
    const auto levels_and_rings = [](const Mesh& mesh) {
        const auto cage = detail::position_cage(mesh, {});
        const auto refined = detail::RefinedCage::make(*cage);
        const auto tree = detail::PatchTree::make(*refined);
        return std::pair(refined->levels.size(), tree->rings.size());
    };
    SubdivideOptions options;
    options.level = 1;
    options.control_points = true;
    const Mesh apart = subdivide(cube(), options)->mesh;
    EXPECT_EQ(levels_and_rings(apart), std::pair(std::size_t(1), std::size_t(8)));
    EXPECT_EQ(levels_and_rings(cube()), std::pair(std::size_t(2), std::size_t(8)));
    // The triangles' middles, and vertices at three of them, are neighbours still when cut once.
    EXPECT_EQ(levels_and_rings(tetrahedron()), std::pair(std::size_t(3), std::size_t(8)));
    // Both in one: what is cut once beside what is cut twice.
    Mesh both = cube(), other = tetrahedron();
    for (const glm::vec3& p : other.positions) both.positions.push_back(p + glm::vec3(5));
    for (const std::uint32_t v : other.corner_vertices) both.corner_vertices.push_back(v + 8);
    for (int k = 0; k < 4; ++k) both.face_offsets.push_back(both.face_offsets.back() + 3);
    EXPECT_EQ(levels_and_rings(both), std::pair(std::size_t(3), std::size_t(16)));
    options.level = 3;
    const auto whole = subdivide(both, options), part = subdivide(cube(), options);
    ASSERT_TRUE(whole && part);
    for (std::uint32_t v = 0; v < 8; ++v)
        EXPECT_EQ(whole->mesh.positions[v], part->mesh.positions[v]);
    for (std::size_t f = 0; f < part->mesh.face_count(); ++f)
        for (std::size_t c = 4 * f; c < 4 * f + 4; ++c)
            EXPECT_EQ(whole->mesh.positions[whole->mesh.corner_vertices[c]],
                      part->mesh.positions[part->mesh.corner_vertices[c]]);
}

// Nine by nine quads, with a crease along a column of edges and another one along a row.
Mesh creased_grid() {
    Mesh mesh;
    std::mt19937 random(7);
    for (std::uint32_t k = 0; k < 100; ++k)
        mesh.positions.emplace_back(k % 10, k / 10, float(random() % 256) / 256);
    for (std::uint32_t k = 0; k < 90; ++k) {
        if (k % 10 == 9) continue;
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), {k, k + 1, k + 11, k + 10});
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    for (std::uint32_t k = 0; k < 9; ++k) {
        mesh.subdivision.creases.push_back({10 * k + 3, 10 * k + 13, 1.5F});
        mesh.subdivision.creases.push_back({60 + k, 61 + k, 2.25F});
    }
    return mesh;
}

TEST(GridTables, CreasesWithoutStoredTablesGiveTheSameBits) {
    const Mesh mesh = creased_grid();
    const auto cage = detail::position_cage(mesh, {});
    ASSERT_TRUE(cage);
    std::vector<double> numbers;
    for (const glm::vec3& p : mesh.positions) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    const auto surface = detail::ChannelSurface::make(*cage, numbers, 3, true, 3, 1);
    ASSERT_TRUE(surface);
    const detail::PatchTree& tree = surface->tree;
    // Each once: what is left at the levels where patches are.
    EXPECT_EQ(std::set<float>(tree.sharpnesses.begin(), tree.sharpnesses.end()),
              (std::set{0.25F, 0.5F, 1.25F, 1.5F, 2.25F}));
    EXPECT_EQ(tree.sharpnesses.size(), 5U);
    unsigned sides = 0;
    for (const auto& patch : tree.crease_patches) sides |= 1U << patch.side;
    EXPECT_EQ(sides, 15U);
    const detail::GridTables stored(2, tree.sharpnesses, false);
    const detail::GridTables none(2, tree.sharpnesses, false, 0);
    EXPECT_NE(stored.crease(4, 1, true), nullptr);
    EXPECT_EQ(none.crease(4, 0, false), nullptr);
    for (const bool control_points : {false, true}) {
        std::vector<double> results[2];
        for (const int k : {0, 1}) {
            detail::PatchEvaluator evaluator(surface->pieces(), SimdLevel::automatic);
            for (std::uint32_t root = 0; root < tree.roots.size(); ++root) {
                std::vector<double> out(9 * 25);
                const detail::GridOutput to{out.data(), out.data() + 75, out.data() + 150, 15, 1};
                evaluator.grid(root, 4, control_points, k == 0 ? stored : none, to);
                results[k].insert(results[k].end(), out.begin(), out.end());
            }
        }
        EXPECT_EQ(results[0], results[1]);
    }
}

// Rings of many sectors stay while all of their levels are within the budget; others are walked,
// two levels at a time. Values are the same.
TEST(PatchEvaluator, KeepsRingsWithinItsBudget) {
    const ::test::Cage pole = ::test::pole(SubdivisionScheme::catmark, 64);
    const auto cage = detail::position_cage(pole.mesh, {});
    ASSERT_TRUE(cage);
    std::vector<double> numbers;
    for (const glm::vec3& p : pole.mesh.positions) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    const auto surface = detail::ChannelSurface::make(*cage, numbers, 3, false, 5, 1);
    ASSERT_TRUE(surface);
    const detail::PatchTree& tree = surface->tree;
    std::size_t points = 0, rings = 0;
    for (const detail::Ring& ring : tree.rings)
        if (ring.shape.sectors == 64) points = ring.shape.point_count(), ++rings;
    ASSERT_EQ(rings, 1U);
    const detail::SurfacePieces pieces{
        &surface->cage, &surface->tree, {surface->values.numbers.data(), 3, nullptr}, nullptr};
    const detail::GridTables tables(5, tree.sharpnesses, false);
    const std::size_t all = 3 * points * 7;  // levels 0 to 5, and the one after
    std::vector<double> expected;
    std::uint64_t least_gathered = 0;
    for (const std::size_t budget : {all, all - 1, 3 * points, std::size_t(0)}) {
        detail::PatchEvaluator evaluator(pieces, SimdLevel::automatic, budget);
        std::vector<double> results, out(3 * 33 * 33);
        detail::GridOutput to;
        to.value = out.data(), to.stride = 3 * 33;
        for (std::uint32_t root = 0; root < tree.roots.size(); ++root) {
            evaluator.grid(root, 32, false, tables, to);
            results.insert(results.end(), out.begin(), out.end());
        }
        const std::size_t walked = 2 * 3 * points;
        EXPECT_LE(evaluator.held_ring_numbers(), budget == all ? all + walked : walked) << budget;
        if (budget == all) {
            expected = results;
            least_gathered = evaluator.gathered_ring_points();
            continue;
        }
        EXPECT_EQ(results, expected) << budget;
        EXPECT_GT(evaluator.gathered_ring_points(), least_gathered + 32 * points) << budget;
    }
}

TEST(GridTables, AreBoundedWhereSharpnessesAreMany) {
    std::vector<float> sharpnesses(1000);
    for (std::size_t k = 0; k < 1000; ++k) sharpnesses[k] = 1 + 0.001F * float(k);
    const detail::GridTables tables(8, sharpnesses, false, 1 << 20);
    std::size_t bytes = 0;
    for (std::uint32_t k = 0; k < 1000; ++k)
        for (std::uint32_t n = 1; n <= 256; n *= 2)
            for (const bool reversed : {false, true})
                if (const auto* table = tables.crease(n, k, reversed))
                    bytes += 8 * (table->value.size() + table->derivative.size() +
                                  table->control.size());
    EXPECT_GT(bytes, 900'000U);
    EXPECT_LE(bytes, 1'048'576U);
}

TEST(LimitSurface, EvaluatesPointsAndGridsAlike) {
    Mesh mesh = cube();
    mesh.subdivision.creases = {{0, 1, 2.5F}, {1, 3, 10.0F}};
    const auto surface = LimitSurface::make(mesh);
    ASSERT_TRUE(surface);
    std::vector<glm::dvec3> positions(6 * 25), du(6 * 25), dv(6 * 25);
    surface->evaluate_grids(4, 0, 6, {positions, du, dv});
    for (std::uint32_t face = 0; face < 6; ++face)
        for (int k = 0; k < 25; ++k) {
            const SurfaceLocation at{face, (k % 5) / 4.0, (k / 5) / 4.0};
            SurfacePoint point;
            surface->evaluate({&at, 1}, {&point, 1});
            EXPECT_LT(glm::length(point.position - positions[25 * face + k]), 1e-14);
            if (point.extraordinary) continue;
            EXPECT_LT(glm::length(point.du - du[25 * face + k]), 1e-12);
        }
}

TEST(Subdivide, SharesPointsAndKeepsTheWayBackOnAnyThreads) {
    Mesh mesh = cube();
    mesh.subdivision.creases = {{0, 1, 10.0F}, {1, 3, 1.3F}};
    std::optional<SubdividedMesh> first;
    for (const int threads : {1, 2, 8}) {
        SubdivideOptions options;
        options.level = 3;
        options.threads = threads;
        auto made = subdivide(mesh, options);
        ASSERT_TRUE(made);
        EXPECT_EQ(made->mesh.face_count(), 6 * 64U);
        EXPECT_EQ(made->mesh.vertex_count(), 6 * 64U + 2);  // Euler: every point is shared
        EXPECT_EQ(made->cage_faces[64], 1U);
        EXPECT_EQ(made->mesh.hard_marks.size(), 8U);
        if (!first) first = *made;
        EXPECT_EQ(made->mesh.positions, first->mesh.positions);
        EXPECT_EQ(made->mesh.normals.values, first->mesh.normals.values);
    }
}

TEST(Subdivide, RefusesWhatHasNoSurface) {
    Mesh mesh = cube();
    SubdivideOptions options;
    options.level = 40;
    auto made = subdivide(mesh, options);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::limit);
    EXPECT_NE(made.error().text.find("40"), std::string::npos);
    options.level = 10;
    options.max_faces = 1000;
    made = subdivide(mesh, options);
    ASSERT_FALSE(made);
    EXPECT_NE(made.error().text.find("6291456"), std::string::npos) << made.error().text;
    EXPECT_NE(made.error().text.find("1000"), std::string::npos);
    options = {};
    options.scheme = SubdivisionScheme::loop;
    EXPECT_EQ(subdivide(mesh, options).error().code, ErrorCode::unsupported);
    options = {};
    mesh.positions[3].y = NAN;
    EXPECT_EQ(subdivide(mesh, options).error().place, "vertex 3");
    mesh = cube();
    mesh.subdivision.creases = {{0, 99, 1.0F}};
    EXPECT_EQ(subdivide(mesh, options).error().code, ErrorCode::invalid);
    EXPECT_TRUE(subdivide(Mesh{}, options));
}

// Faces that use a vertex twice, and creases anywhere: OpenSubdiv's sparse refinement leaves out
// faces around some of their smooth vertices, which its own sums do not survive.
TEST(LimitSurface, FoldedCagesAreRefinedOrRefused) {
    int refused = 0;
    for (unsigned seed = 1; seed <= 4000; ++seed) {
        std::mt19937 random(seed);
        const auto below = [&](unsigned count) { return unsigned(random() % count); };
        Mesh mesh;
        const unsigned vertices = 4 + below(7);
        for (unsigned v = 0; v < vertices; ++v) {
            const float x = float(below(5)), y = float(below(5));
            mesh.positions.emplace_back(x, y, float(below(5)));
        }
        const unsigned faces = 2 + below(3);
        for (unsigned f = 0; f < faces; ++f) {
            for (unsigned corners = 3 + below(6); corners > 0; --corners)
                mesh.corner_vertices.push_back(below(vertices));
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        }
        for (unsigned k = below(3); k > 0; --k) {
            const std::uint32_t v0 = below(vertices), v1 = below(vertices);
            mesh.subdivision.creases.push_back({v0, v1, float(below(11))});
        }
        const auto surface = LimitSurface::make(mesh);
        if (!surface) {
            EXPECT_EQ(surface.error().code, ErrorCode::invalid);
            ++refused;
            continue;
        }
        for (std::uint32_t face = 0; face < faces; ++face) {
            SurfacePoint point;
            const SurfaceLocation at{face, 0.25, 0.25};
            surface->evaluate({&at, 1}, {&point, 1});
            EXPECT_TRUE(std::isfinite(point.position.x + point.position.y + point.position.z));
        }
    }
    EXPECT_GT(refused, 0);
    EXPECT_LT(refused, 40);
}

TEST(LimitSurface, NoFacesHaveNoUvSurface) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}};
    mesh.uvs.resize(1);
    const auto made = LimitSurface::make_uv(mesh, 0);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::invalid);
    EXPECT_TRUE(LimitSurface::make(mesh));
}

}  // namespace
}  // namespace prep
