// Polygons with heights, tessellated: closed, certified, refined where it matters.
#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "prep/displacement/tessellate.h"
#include "prep/prepare.h"
#include "tessellation/tessellation.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;

TessellateOptions with_height(std::shared_ptr<const HeightFunction> height, double scale = 1) {
    TessellateOptions options;
    options.displacements = {{std::move(height), scale, 0, 0}};
    return options;
}

TEST(Tessellation, EmptyMeshStaysEmpty) {
    TessellateOptions options;
    options.chord_error = 0.1;
    const auto made = tessellate(Mesh{}, options);
    ASSERT_TRUE(made) << to_string(made.error());
    EXPECT_EQ(made->mesh.face_count(), 0u);
    EXPECT_EQ(made->certificate.proved, 0);
}

TEST(Tessellation, TriangleIsOneUntilItIsOpened) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}};
    add_face(mesh, {0, 1, 2});
    TessellateOptions options;
    options.chord_error = 0.1;
    const auto made = tessellate(mesh, options);
    ASSERT_TRUE(made) << to_string(made.error());
    ASSERT_EQ(made->mesh.face_count(), 1u);
    EXPECT_EQ(made->cage_vertices, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(made->cage_faces, (std::vector<std::uint32_t>{0}));
    options.edge_length = 4;
    const auto opened = tessellate(mesh, options);
    ASSERT_TRUE(opened) << to_string(opened.error());
    ASSERT_EQ(opened->mesh.face_count(), 4u);  // the longest edge is halved as well
    EXPECT_EQ(opened->mesh.positions[3], glm::vec3(1, 1, 0));
    EXPECT_EQ(opened->cage_vertices, (std::vector<std::uint32_t>{0, 1, 2, no_index, no_index}));
    EXPECT_EQ(opened->cage_faces, (std::vector<std::uint32_t>(4, 0)));
}

TEST(Tessellation, WhatIsNotPossibleIsRefused) {
    const Mesh quad = unit_quad();
    TessellateOptions options;
    EXPECT_EQ(tessellate(quad, options).error().code, ErrorCode::invalid);
    for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
        options.chord_error = bad;
        EXPECT_EQ(tessellate(quad, options).error().code, ErrorCode::invalid) << bad;
    }
    options.chord_error = 1e-9;
    EXPECT_EQ(tessellate(quad, options).error().code, ErrorCode::limit);
    options.chord_error = 1e-2;
    Mesh mesh = quad;
    mesh.morph_targets.resize(1);
    EXPECT_EQ(tessellate(mesh, options).error().code, ErrorCode::unsupported);
    mesh = quad;
    mesh.positions[2].y = NAN;
    EXPECT_EQ(tessellate(mesh, options).error().code, ErrorCode::invalid);
    EXPECT_NE(tessellate(mesh, options).error().text.find("vertex 2"), std::string::npos);
    options.displacements = {{std::make_shared<Waves>(0.1, 9, 7), 1, 0, 0}};
    options.displacements[0].scale = 1e300;
    EXPECT_EQ(tessellate(quad, options).error().code, ErrorCode::limit);
    options.displacements[0].scale = 1;
    mesh = quad;
    mesh.uvs.clear();
    EXPECT_EQ(tessellate(mesh, options).error().code, ErrorCode::invalid);
    mesh = quad;
    mesh.uvs[0].values[1].x = NAN;
    EXPECT_EQ(tessellate(mesh, options).error().place, "face 0");
    options.triangle_limit = 50;
    EXPECT_EQ(tessellate(quad, options).error().code, ErrorCode::limit);
}

TEST(Tessellation, SpikeOfOneTexelIsFoundWithFewTriangles) {
    std::mt19937 random(4096);
    std::uniform_int_distribution<int> texel(0, 4095);
    constexpr double height = 0.25;
    std::uint64_t most = 0;
    for (int trial = 0; trial < 100; ++trial) {
        const double x = texel(random), y = texel(random);
        const auto spike = std::make_shared<Spike>(4096, x, y, height);
        TessellateOptions options = with_height(spike);
        options.chord_error = height / 4;
        options.samples = 100;
        const auto made = tessellate(unit_quad(), options);
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_LE(made->certificate.proved, height / 4);
        EXPECT_EQ(made->certificate.unresolved, 0u);
        most = std::max(most, made->certificate.triangles);
        // The top is missed by its distance from the facet under it.
        const glm::dvec2 top((x + 0.5) / 4096, (y + 0.5) / 4096);
        const Mesh& mesh = made->mesh;
        double error = height;
        bool inside = false;
        for (std::size_t t = 0; t < mesh.face_count(); ++t) {
            std::array<glm::dvec3, 3> p;
            for (std::size_t k = 0; k < 3; ++k) {
                p[k] = glm::dvec3(mesh.positions[mesh.corner_vertices[3 * t + k]]);
                inside = inside ||
                         std::max(std::abs(p[k].x - top.x), std::abs(p[k].y - top.y)) < 1.0 / 4096;
            }
            const auto cross = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec2& c) {
                return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
            };
            const double area = cross(p[0], p[1], glm::dvec2(p[2]));
            const glm::dvec3 w =
                glm::dvec3(cross(p[1], p[2], top), cross(p[2], p[0], top), cross(p[0], p[1], top)) /
                area;
            if (std::min({w.x, w.y, w.z}) < -1e-9) continue;
            error = std::abs(height - (w.x * p[0].z + w.y * p[1].z + w.z * p[2].z));
        }
        EXPECT_TRUE(inside) << "spike at " << x << ", " << y;
        EXPECT_GE(made->certificate.proved, error);
    }
    EXPECT_LE(most, 5000u);
    RecordProperty("most_triangles", int(most));
}

// Each face with its own chart: heights disagree along all edges.
std::vector<Mesh> closed_cages(std::mt19937& random) {
    std::vector<Mesh> cages = {cube(), torus(7, 5)};
    for (std::uint32_t n = 3; n <= 9; ++n) cages.push_back(prism(n));
    std::uniform_real_distribution<float> jitter(-0.1F, 0.1F);
    for (Mesh& cage : cages) {
        for (glm::vec3& p : cage.positions) p += glm::vec3(jitter(random), jitter(random), 0);
        add_charts(cage, random);
    }
    return cages;
}

TEST(Tessellation, ClosedCagesStayClosed) {
    std::mt19937 random(2);
    for (int round = 0; round < 4; ++round)
        for (const Mesh& cage : closed_cages(random)) {
            const Closedness before = closedness(cage);
            ASSERT_EQ(before.open_edges, 0u);
            TessellateOptions options =
                with_height(std::make_shared<Waves>(0.1, 7 + round, 5, round));
            options.edge_length = 0.5 / (1 + round);
            options.chord_error = 0.02;
            const auto made = tessellate(cage, options);
            ASSERT_TRUE(made) << to_string(made.error());
            const Closedness after = closedness(made->mesh);
            EXPECT_EQ(after.open_edges, 0u);
            EXPECT_EQ(after.zero_edges, 0u);
            EXPECT_EQ(after.euler, before.euler);
            EXPECT_GT(made->mesh.face_count(), 3 * cage.face_count());
        }
}

TEST(Tessellation, WithoutSharingItTears) {
    std::mt19937 random(2);
    std::uint64_t tears = 0;
    for (const Mesh& cage : closed_cages(random)) {
        TessellateOptions options = with_height(std::make_shared<Waves>(0.1, 7, 5));
        options.edge_length = 0.2;
        detail::TessellationHooks hooks;
        hooks.share_positions = false;
        const auto made = detail::tessellate(cage, options, hooks);
        ASSERT_TRUE(made) << to_string(made.error());
        tears += closedness(made->mesh).open_edges;
    }
    EXPECT_GT(tears, 1000u);
}

TEST(Tessellation, MeasuredIsNotAboveProvedNorProvedAboveAsked) {
    std::mt19937 random(3);
    for (const Mesh& cage : {cube(), torus(9, 6)})
        for (const double asked : {0.1, 0.01, 0.002}) {
            Mesh mesh = cage;
            // One chart: the same at both sides of an edge.
            mesh.uvs.resize(1);
            for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
                const glm::vec3 p = mesh.positions[mesh.corner_vertices[c]];
                mesh.uvs[0].indices.push_back(std::uint32_t(c));
                mesh.uvs[0].values.emplace_back(p.x + 0.3F * p.z, p.y - 0.4F * p.z);
            }
            TessellateOptions options = with_height(std::make_shared<Waves>(0.15, 4, 3, 0.5));
            options.chord_error = asked;
            options.samples = 200000;
            const auto made = tessellate(mesh, options);
            ASSERT_TRUE(made) << to_string(made.error());
            const TessellationCertificate& c = made->certificate;
            EXPECT_LE(c.measured, c.proved);
            EXPECT_LE(c.proved, asked);
            EXPECT_LE(c.proved, 6 * c.measured);
            EXPECT_EQ(c.unresolved, 0u);
            EXPECT_LT(c.worst_face, mesh.face_count());
        }
}

TEST(Tessellation, SharedGapIsTold) {
    std::mt19937 random(5);
    Mesh mesh = cube();
    add_charts(mesh, random);
    TessellateOptions options = with_height(std::make_shared<Waves>(0.2, 5, 5));
    options.chord_error = 0.01;
    options.samples = 100000;
    const auto made = tessellate(mesh, options);
    ASSERT_TRUE(made) << to_string(made.error());
    const TessellationCertificate& c = made->certificate;
    EXPECT_GT(c.largest_shared_gap, 0.01);
    EXPECT_LE(c.proved, c.largest_shared_gap + 0.01 + 1e-9);
    EXPECT_LE(c.proved_refinable, 0.01);
    EXPECT_LE(c.measured, c.proved);
}

TEST(Tessellation, SameBytesWithAnyNumberOfThreads) {
    std::mt19937 random(7);
    Mesh mesh = torus(9, 6);
    add_charts(mesh, random);
    for (const bool budget : {false, true}) {
        TessellateOptions options = with_height(std::make_shared<Waves>(0.1, 11, 7));
        if (budget)
            options.max_triangles = 5000;
        else
            options.chord_error = 0.005;
        options.threads = 1;
        const auto one = tessellate(mesh, options);
        ASSERT_TRUE(one);
        for (const int threads : {2, 8}) {
            options.threads = threads;
            const auto more = tessellate(mesh, options);
            ASSERT_TRUE(more);
            EXPECT_TRUE(same_bytes(one->mesh, more->mesh)) << threads;
            EXPECT_EQ(one->certificate.proved, more->certificate.proved);
            EXPECT_EQ(one->certificate.measured, more->certificate.measured);
        }
    }
}

TEST(Tessellation, OrderOfFacesChangesNoPosition) {
    std::mt19937 random(15);
    for (const bool limit : {false, true})
        for (Mesh cage : {cube(), torus(5, 4), prism(7)}) {
            add_charts(cage, random);
            Mesh shuffled = cage;
            std::vector<std::uint32_t> order(cage.face_count());
            for (std::uint32_t f = 0; f < order.size(); ++f) order[f] = f;
            std::shuffle(order.begin(), order.end(), random);
            shuffled.corner_vertices.clear();
            shuffled.face_offsets = {0};
            shuffled.uvs[0].indices.clear();
            for (const std::uint32_t f : order) {
                for (std::uint32_t c = cage.face_offsets[f]; c < cage.face_offsets[f + 1]; ++c) {
                    shuffled.corner_vertices.push_back(cage.corner_vertices[c]);
                    shuffled.uvs[0].indices.push_back(cage.uvs[0].indices[c]);
                }
                shuffled.face_offsets.push_back(std::uint32_t(shuffled.corner_vertices.size()));
            }
            TessellateOptions options = with_height(std::make_shared<Waves>(0.1, 7, 5));
            options.chord_error = 0.02;
            if (limit) options.scheme = SubdivisionScheme::catmark;
            const auto one = tessellate(cage, options), other = tessellate(shuffled, options);
            ASSERT_TRUE(one && other);
            EXPECT_EQ(one->mesh.face_count(), other->mesh.face_count());
            std::array<std::vector<std::array<float, 3>>, 2> points;
            for (const glm::vec3& p : one->mesh.positions) points[0].push_back({p.x, p.y, p.z});
            for (const glm::vec3& p : other->mesh.positions) points[1].push_back({p.x, p.y, p.z});
            for (auto& list : points) std::sort(list.begin(), list.end());
            ASSERT_EQ(points[0].size(), points[1].size());
            for (std::size_t k = 0; k < points[0].size(); ++k)
                for (std::size_t d = 0; d < 3; ++d)
                    ASSERT_NEAR(points[0][k][d], points[1][k][d], limit ? 1e-5 : 0.0) << k;
        }
}

TEST(Tessellation, ConstantMapAtMidlevelMovesNothing) {
    class Constant final : public HeightFunction {
      public:
        Sample at(const glm::dvec2&) const override { return {188.0 / 255, {}}; }
        double deviation(const std::array<glm::dvec2, 3>&, const std::array<double, 3>&,
                         double) const override {
            return 0;
        }
    };
    std::mt19937 random(8);
    for (Mesh cage : {cube(), torus(6, 5), prism(7)}) {
        add_charts(cage, random);
        TessellateOptions options;
        options.edge_length = 0.3;
        const auto plain = tessellate(cage, options);
        options.displacements = {{std::make_shared<Constant>(), 0.7, 188.0 / 255, 0}};
        const auto displaced = tessellate(cage, options);
        ASSERT_TRUE(plain && displaced);
        EXPECT_TRUE(same_bytes(plain->mesh, displaced->mesh));
    }
}

// Told before a minute and gigabytes are spent on it.
TEST(Tessellation, EdgesThatCannotBeAreRefusedAtOnce) {
    TessellateOptions options;
    for (const double edge : {1e-9, 1e-5}) {
        options.edge_length = edge;
        const auto refused = tessellate(unit_quad(), options);
        ASSERT_FALSE(refused) << edge;
        EXPECT_EQ(refused.error().code, ErrorCode::limit);
        EXPECT_NE(refused.error().text.find(edge == 1e-9 ? "finer than floats" : "takes more than"),
                  std::string::npos)
            << refused.error().text;
    }
    // As many as it would take are enough.
    options.edge_length = 0.01;
    options.triangle_limit = 200'000;
    EXPECT_TRUE(tessellate(unit_quad(), options));
    // A budget ends it in any case.
    options.edge_length = 1e-9;
    options.max_triangles = 100;
    EXPECT_TRUE(tessellate(unit_quad(), options));
}

TEST(Tessellation, BudgetIsUsedUpAndAsGoodAsAnErrorOfThatSize) {
    std::mt19937 random(9);
    Mesh mesh = torus(6, 5);
    add_charts(mesh, random);
    for (const std::uint64_t most : {1000u, 3000u, 20000u}) {
        TessellateOptions options = with_height(std::make_shared<Waves>(0.1, 13, 8));
        options.max_triangles = most;
        options.samples = 0;
        const auto made = tessellate(mesh, options);
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_LE(made->mesh.face_count(), most);
        EXPECT_GE(double(made->mesh.face_count()), 0.95 * double(most));
        // The error that takes as many triangles when it is asked for.
        double low = made->certificate.proved / 16, high = made->certificate.proved * 16;
        options.max_triangles.reset();
        for (int step = 0; step < 12; ++step) {
            const double middle = std::sqrt(low * high);
            options.chord_error = middle;
            const auto asked = tessellate(mesh, options);
            ASSERT_TRUE(asked) << to_string(asked.error());
            (asked->mesh.face_count() <= most ? high : low) = middle;
        }
        EXPECT_LE(made->certificate.proved_refinable, 1.1 * high);
    }
}

TEST(Tessellation, EdgesAreAsShortAsAsked) {
    TessellateOptions options = with_height(std::make_shared<Waves>(0.3, 9, 9));
    options.edge_length = 0.05;
    const auto made = tessellate(unit_quad(), options);
    ASSERT_TRUE(made);
    const Mesh& mesh = made->mesh;
    double longest = 0;
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const std::size_t next = c % 3 == 2 ? c - 2 : c + 1;
        longest =
            std::max(longest, double(glm::distance(mesh.positions[mesh.corner_vertices[c]],
                                                   mesh.positions[mesh.corner_vertices[next]])));
    }
    EXPECT_LE(longest, 0.05 * (1 + 1e-6));
    EXPECT_GE(longest, 0.02);
    // Spokes longer than the rim's edges, which are halved first.
    options.displacements.clear();
    options.edge_length = 0.15;
    Mesh rim = prism(64);
    rim.corner_vertices.resize(64);
    rim.face_offsets = {0, 64};
    const auto wheel = tessellate(rim, options);
    ASSERT_TRUE(wheel);
    for (std::size_t c = 0; c < wheel->mesh.corner_count(); ++c) {
        const std::size_t next = c % 3 == 2 ? c - 2 : c + 1;
        const auto& out = wheel->mesh;
        EXPECT_LE(glm::distance(out.positions[out.corner_vertices[c]],
                                out.positions[out.corner_vertices[next]]),
                  0.15F * (1 + 1e-6F));
    }
}

TEST(Tessellation, PixelErrorIsFiniteWithTheEyeInside) {
    TessellateOptions options = with_height(std::make_shared<Waves>(0.05, 20, 20));
    options.pixel_error = 1;
    options.triangle_limit = 1000000;
    options.screens.resize(1);
    options.screens[0].y = {0, 0, 1, 0};
    options.screens[0].w = {0, 1, 0, -0.5};  // looks along y from y = 0.5
    options.screens[0].pixels = {500, 500};
    options.screens[0].near_distance = 0.05;
    const auto made = tessellate(unit_quad(), options);
    ASSERT_TRUE(made) << to_string(made.error());
    ASSERT_TRUE(made->certificate.proved_pixels);
    EXPECT_LE(*made->certificate.proved_pixels, 1);
    // Farther off less is needed.
    options.screens[0].w.w = 9.5;
    const auto far = tessellate(unit_quad(), options);
    ASSERT_TRUE(far);
    EXPECT_LT(far->mesh.face_count() * 4, made->mesh.face_count());
}

TEST(Tessellation, MarksMaterialsAndUvsComeFromTheCage) {
    Mesh mesh = cube();
    mesh.face_materials = {0, 1, 2, 0, 1, 2};
    mesh.face_parts = {0, 0, 0, 1, 1, 1};
    mesh.parts = {"a", "b"};
    mesh.hard_marks = {{0, 1}};
    std::mt19937 random(10);
    add_charts(mesh, random);
    TessellateOptions options;
    options.edge_length = 0.4;
    const auto made = tessellate(mesh, options);
    ASSERT_TRUE(made);
    const Mesh& out = made->mesh;
    double length = 0;
    for (const glm::uvec2& mark : out.hard_marks)
        length += glm::distance(out.positions[mark.x], out.positions[mark.y]);
    EXPECT_NEAR(length, 2, 1e-6);
    for (std::size_t t = 0; t < out.face_count(); ++t) {
        EXPECT_EQ(out.face_materials[t], mesh.face_materials[made->cage_faces[t]]);
        EXPECT_EQ(out.face_parts[t], mesh.face_parts[made->cage_faces[t]]);
        // Plane faces of a cube: UVs and normals have closed forms.
        const std::uint32_t first = mesh.face_offsets[made->cage_faces[t]];
        const auto corner = [&](std::uint32_t k) {
            return glm::dvec3(mesh.positions[mesh.corner_vertices[first + k]]);
        };
        const auto uv = [&](std::uint32_t k) {
            return glm::dvec2(mesh.uvs[0].values[mesh.uvs[0].indices[first + k]]);
        };
        const glm::dvec3 along = corner(1) - corner(0), up = corner(3) - corner(0);
        const glm::dvec3 normal = glm::cross(along, up) / 4.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 p =
                glm::dvec3(out.positions[out.corner_vertices[3 * t + k]]) - corner(0);
            const double x = glm::dot(p, along) / 4, y = glm::dot(p, up) / 4;
            const glm::dvec2 expected = uv(0) + x * (uv(1) - uv(0)) + y * (uv(3) - uv(0));
            const glm::dvec2 found(out.uvs[0].values[out.uvs[0].indices[3 * t + k]]);
            EXPECT_NEAR(glm::distance(found, expected), 0, 1e-6);
            const glm::dvec3 n(out.normals.values[out.normals.indices[3 * t + k]]);
            EXPECT_NEAR(glm::distance(n, normal), 0, 1e-6);
        }
    }
}

// A shallow bowl of a triangle and two quads, whose weights all differ; its borders are its own.
Mesh bowl() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0},        {1, 0, 0.2F},   {1.5F, 2, 0.5F},    {0, 1, 0.25F},
                      {-2, 0.5F, 0.5F}, {-1, -1, 0.3F}, {0.3F, -0.6F, 0.1F}};
    add_face(mesh, {0, 1, 2, 3});
    add_face(mesh, {0, 3, 4, 5});
    add_face(mesh, {0, 5, 6});
    return mesh;
}

// Normals at the cage's vertices, as they are written, and what was found of them.
struct PreparedNormals {
    std::map<std::tuple<float, float, float>, std::vector<glm::vec3>> at;
    std::map<std::string, std::uint64_t> findings;
};
PreparedNormals prepared_normals(const Mesh& mesh, const PrepareOptions& options) {
    Scene scene;
    scene.meshes = {mesh};
    const auto prepared = prepare(std::move(scene), options);
    PreparedNormals out;
    EXPECT_TRUE(prepared) << to_string(prepared.error());
    if (!prepared) return out;
    const VertexMesh& made = prepared->meshes[0];
    for (const glm::vec3& p : mesh.positions) {
        auto& normals = out.at[{p.x, p.y, p.z}];
        for (std::size_t v = 0; v < made.positions.size(); ++v)
            if (made.positions[v] == p) normals.push_back(made.normals[v]);
    }
    for (const Finding& finding : prepared->findings)
        if (finding.kind.ends_with("-normal")) out.findings[finding.kind] += finding.count;
    return out;
}

// Polygons that are cut have the normals that they have as they are, whatever was asked for, and
// the same is told of them.
TEST(Tessellation, NormalsOfPolygonsArePreparedAsOthersAre) {
    Mesh good = bowl();
    for (const std::uint32_t v : good.corner_vertices) {
        const glm::vec3 p = good.positions[v];
        good.normals.indices.push_back(std::uint32_t(good.normals.values.size()));
        good.normals.values.push_back(glm::normalize(glm::vec3(-0.1F * p.x, 0.2F * p.y, 1)));
    }
    Mesh bad = good, downward = good;
    for (glm::vec3& n : downward.normals.values) n = -n;
    bad.normals.indices[1] = no_index;
    bad.normals.values[2] = glm::vec3(0);
    bad.normals.values[5] = glm::vec3(NAN, 0, 1);
    bad.normals.values[6] *= 3.0F;
    bad.normals.values[9] *= -1.0F;
    std::size_t told = 0;
    double farthest_apart = 0;  // of what different wishes make
    for (const Mesh& mesh : {bowl(), good, bad, downward}) {
        std::vector<PreparedNormals> all;
        for (const Authored normals : {Authored::keep, Authored::repair, Authored::replace})
            for (const NormalWeight weight :
                 {NormalWeight::area, NormalWeight::uniform, NormalWeight::angle}) {
                PrepareOptions options;
                options.normals = normals;
                options.normal.weight = weight;
                options.hard_edges.angle_degrees = 80;
                const PreparedNormals whole = prepared_normals(mesh, options);
                options.tessellate = true;
                options.tessellation.edge_length = 0.4;
                const PreparedNormals cut = prepared_normals(mesh, options);
                EXPECT_EQ(whole.findings, cut.findings);
                told += whole.findings.size();
                for (const auto& [place, normals_there] : whole.at) {
                    const auto& found = cut.at.at(place);
                    EXPECT_EQ(found.size(), normals_there.size());
                    for (const glm::vec3& n : found) {
                        double nearest = 2;
                        for (const glm::vec3& other : normals_there)
                            nearest = std::min(nearest, double(glm::distance(n, other)));
                        EXPECT_LE(nearest, 1e-6) << name_of(normals) << ", " << name_of(weight);
                    }
                }
                all.push_back(cut);
            }
        for (const PreparedNormals& one : all)
            farthest_apart = std::max(
                farthest_apart, double(glm::distance(one.at.begin()->second.front(),
                                                     all.front().at.begin()->second.front())));
    }
    EXPECT_GE(told, 15U);
    EXPECT_GT(farthest_apart, 1);
}

// A sliver along a row of samples, across 280,000 pictures, is no chart to bake.
TEST(Tessellation, SliversAlongRowsGetNoResidualMap) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    add_face(mesh, {0, 1, 2});
    constexpr float row = 0x1p-15F, off = 0x1p-24F;  // the first samples of 4096 texels
    mesh.uvs.resize(1);
    mesh.uvs[0].values = {{-140000, row - off}, {140000, row}, {-140000, row + off}};
    mesh.uvs[0].indices = {0, 1, 2};
    Scene scene;
    scene.meshes = {mesh};
    PrepareOptions options;
    options.tessellate = true;
    options.tessellation.chord_error = 1;
    options.displacement.residual.emplace();
    options.displacement.residual->size = 4096;
    const auto made = prepare(std::move(scene), options);
    ASSERT_TRUE(made) << to_string(made.error());
    const auto& findings = made->findings;
    const auto found = std::find_if(findings.begin(), findings.end(), [](const Finding& finding) {
        return finding.kind == "no-residual-map";
    });
    ASSERT_NE(found, findings.end());
    EXPECT_NE(found->text.find("as wide as the picture"), std::string::npos) << found->text;
}

}  // namespace
}  // namespace prep
