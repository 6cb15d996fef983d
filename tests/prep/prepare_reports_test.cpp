// What prepare() tells: why a stage ran or did not, over how many meshes, what exact arithmetic
// decided, what was split for which reason, and what stood in for what.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "prep/prepare.h"
#include "shapes.h"

namespace {

using prep::Mesh;
using prep::no_index;
using prep::PreparedScene;
using prep::PrepareOptions;
using Indices = std::vector<std::uint32_t>;

PreparedScene prepared(std::vector<Mesh> meshes, const PrepareOptions& options = {}) {
    prep::Scene scene;
    scene.meshes = std::move(meshes);
    auto result = prep::prepare(std::move(scene), options);
    EXPECT_TRUE(result.has_value());
    return *std::move(result);
}

prep::StageReport stage(const PreparedScene& scene, const std::string& name) {
    for (const prep::StageReport& s : scene.stages)
        if (s.stage == name) return s;
    ADD_FAILURE() << "no stage " << name;
    return {};
}

const prep::Finding* finding(const PreparedScene& scene, const std::string& kind) {
    for (const prep::Finding& f : scene.findings)
        if (f.kind == kind) return &f;
    return nullptr;
}

// Two quads that bend by 20° at their common edge, each of them with vertices of its own there, and
// a vertex that both share, so that it is no soup.
Mesh roof() {
    const float low = -float(std::tan(10 * std::acos(-1.0) / 180));
    return shapes::mesh_of(
        {{-1, 0, low}, {0, 0, 0}, {0, 1, 0}, {-1, 1, low}, {0, 0, 0}, {1, 0, low}, {1, 1, low}},
        {{0, 1, 2, 3}, {4, 5, 6, 2}});
}

bool is_smooth(const PreparedScene& scene) {
    const prep::CornerLayer<glm::vec3>& n = scene.scene.meshes[0].normals;
    return n.values[n.indices[1]] == n.values[n.indices[4]];
}

template <class T>
prep::CornerLayer<T> by_vertex(const Mesh& mesh, const T& value) {
    return {std::vector<T>(mesh.vertex_count(), value), mesh.corner_vertices};
}

TEST(PrepareReports, WhetherAndWhyVerticesAreWelded) {
    const std::string repeated = "vertices are repeated at seams: equal positions are one point";
    const auto expect = [](const Mesh& mesh, bool run, const std::string& reason,
                           prep::WeldMode mode = prep::WeldMode::automatic) {
        PrepareOptions options;
        options.weld = mode;
        options.normals = prep::Authored::replace;
        const PreparedScene scene = prepared({mesh}, options);
        EXPECT_EQ(stage(scene, "weld").run, run) << reason;
        EXPECT_EQ(stage(scene, "weld").reason, reason);
        EXPECT_EQ(is_smooth(scene), run) << reason;
    };
    expect(roof(), false, "the file's faces share vertices, and nothing repeats them");
    expect(roof(), true, repeated, prep::WeldMode::exact);
    Mesh mesh = roof();
    mesh.normals = by_vertex(mesh, glm::vec3(0, 0, 1));
    expect(mesh, true, repeated);
    expect(mesh, false, "switched off", prep::WeldMode::none);
    mesh = roof();
    mesh.tangents = by_vertex(mesh, glm::vec4(1, 0, 0, 1));
    expect(mesh, true, repeated);
    mesh = roof();
    mesh.uvs = {by_vertex(mesh, glm::vec2(0))};
    expect(mesh, true, repeated);
    mesh.uvs.insert(mesh.uvs.begin(), {{{0, 0}}, Indices(8, 0)});
    expect(mesh, true, repeated);  // a second set that is by vertex
    mesh.uvs.pop_back();
    expect(mesh, false, "the file indexes positions apart from attributes");
    mesh = roof();
    mesh.normals = {{{0, 0, 1}}, Indices(8, 0)};
    expect(mesh, false, "the file indexes positions apart from attributes");
    mesh = roof();
    mesh.tangents = {{{1, 0, 0, 1}}, Indices(8, 0)};
    expect(mesh, false, "the file indexes positions apart from attributes");
    expect(shapes::soup(roof()), true,
           "every corner has a vertex of its own: those at one point are shared");
}

TEST(PrepareReports, ASoupWhoseVerticesAreNamedKeepsThem) {
    const auto vertices = [](const Mesh& mesh) {
        PrepareOptions options;
        options.hard_edges.angle_degrees.reset();
        return prepared({mesh}, options).scene.meshes[0].vertex_count();
    };
    const Mesh soup = shapes::soup(shapes::cube());
    EXPECT_EQ(vertices(soup), 8u);
    Mesh mesh = soup;
    mesh.hard_marks = {{0, 1}};
    EXPECT_EQ(vertices(mesh), 24u);
    mesh = soup;
    mesh.subdivision.creases = {{0, 1, 3.0f}};
    EXPECT_EQ(vertices(mesh), 24u);
    mesh = soup;
    mesh.subdivision.corners = {{0, 3.0f}};
    EXPECT_EQ(vertices(mesh), 24u);
    mesh = soup;
    mesh.points = {23};
    EXPECT_EQ(vertices(mesh), 24u);
    mesh = soup;
    mesh.line_offsets = {0, 2};
    mesh.line_vertices = {3, 4};
    EXPECT_EQ(vertices(mesh), 24u);
}

TEST(PrepareReports, AStageSaysOverHowManyMeshesAndTheFirstReasons) {
    prep::Scene scene;
    scene.materials.resize(2);
    scene.materials[0].name = "brick";
    scene.materials[1].name = "tile";
    Mesh authored = shapes::cube(), points;
    authored.normals = {{{0, 0, 1}}, Indices(24, 0)};
    points.positions = {{0, 0, 0}};
    points.points = {0};
    scene.meshes = {authored, shapes::cube(), shapes::cube(), points};
    for (std::size_t m = 0; m < 3; ++m) scene.meshes[m].face_materials.assign(6, m == 2 ? 1u : 0u);
    const auto result = prep::prepare(scene);
    ASSERT_TRUE(result.has_value());
    for (const char* name : {"topology", "face normals", "hard edges", "normals"}) {
        EXPECT_TRUE(stage(*result, name).run);
        EXPECT_EQ(stage(*result, name).reason,
                  "2 of 4 meshes: material 'brick' is lit; others: the file's own normals are kept")
            << name;
    }
    EXPECT_FALSE(stage(*result, "tangents").run);
    EXPECT_EQ(stage(*result, "tangents").reason,
              "no material in use has a tangent-space normal map");
    EXPECT_EQ(stage(*result, "split").reason, "vertices carry one set of attributes each");
    ASSERT_FALSE(result->stages.empty());
    EXPECT_EQ(result->stages.front().stage, "requirements");
    EXPECT_TRUE(result->stages.front().run);
    // In the order of the pipeline.
    Indices order;
    for (const char* name : {"requirements", "weld", "topology", "face normals", "hard edges",
                             "normals", "tangents", "split"})
        for (std::uint32_t i = 0; i < result->stages.size(); ++i)
            if (result->stages[i].stage == name) order.push_back(i);
    EXPECT_EQ(order.size(), 8u);
}

// Decisions that doubles leave open: right angles at a threshold of 90°, a face whose corners lie
// on one line but too far apart for doubles to say so, sums that cancel.
TEST(PrepareReports, ExactDecisionsAddUpOverTheMeshes) {
    PrepareOptions options;
    options.hard_edges.angle_degrees = 90;
    PreparedScene scene = prepared({shapes::cube(), shapes::cube()}, options);
    EXPECT_EQ(stage(scene, "hard edges").exact, 24u);  // none of which is hard
    EXPECT_EQ(stage(scene, "face normals").exact, 0u);
    Mesh line = shapes::polygon({glm::vec3(0x1p-60f), glm::vec3(1), glm::vec3(3)});
    scene = prepared({line, shapes::cube(), line});
    EXPECT_EQ(stage(scene, "face normals").exact, 2u);
    // A leaf of two sides, smooth all around: nothing is left at any of its three points.
    const Mesh leaf = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {2, 1, 0}});
    options.hard_edges.angle_degrees.reset();
    scene = prepared({leaf, shapes::cube(), leaf}, options);
    EXPECT_EQ(stage(scene, "normals").exact, 6u);
}

TEST(PrepareReports, FallbacksOfNormalsAreToldByKind) {
    PrepareOptions options;
    options.hard_edges.angle_degrees.reset();
    // Corners 0 … 5: a leaf of two sides. 6 … 8: a face without area and without neighbours.
    // 9 … 14: one without area beside a good one: at its far end nothing else is.
    const Mesh mesh = shapes::mesh_of({{0, 0, 0},
                                       {1, 0, 0},
                                       {0, 1, 0},
                                       {5, 0, 0},
                                       {6, 0, 0},
                                       {7, 0, 0},
                                       {9, 0, 0},
                                       {9, 2, 0},
                                       {8, 1, 0},
                                       {9, 1, 0}},
                                      {{0, 1, 2}, {2, 1, 0}, {3, 4, 5}, {6, 7, 8}, {7, 6, 9}});
    const PreparedScene scene = prepared({mesh}, options);
    const prep::Finding* vanishing = finding(scene, "vanishing-normal");
    const prep::Finding* undefined = finding(scene, "undefined-normal");
    ASSERT_NE(vanishing, nullptr);
    ASSERT_NE(undefined, nullptr);
    EXPECT_EQ(vanishing->count, 4u);
    EXPECT_EQ(vanishing->places, (Indices{0, 1, 2, 14}));
    EXPECT_EQ(undefined->count, 3u);
    EXPECT_EQ(undefined->places, (Indices{6, 7, 8}));
    EXPECT_EQ(vanishing->severity, prep::Severity::warning);
    const auto& layer = scene.scene.meshes[0].normals;
    for (const std::uint32_t c : {6u, 7u, 8u, 14u})
        EXPECT_EQ(layer.values[layer.indices[c]], glm::vec3(0, 0, 1)) << c;
}

TEST(PrepareReports, SplitsAreCountedByTheirReason) {
    using Count = std::uint64_t prep::SplitCounts::*;
    const Count all[] = {&prep::SplitCounts::hard_edge,       &prep::SplitCounts::smoothing_group,
                         &prep::SplitCounts::authored_normal, &prep::SplitCounts::uv_seam,
                         &prep::SplitCounts::mirrored_uv,     &prep::SplitCounts::tangent,
                         &prep::SplitCounts::color,           &prep::SplitCounts::material};
    const Indices halves{0, 0, 0, 0, 1, 1, 1, 1};
    const auto expect = [&](const Mesh& mesh, Count reason, std::uint64_t count = 2) {
        PrepareOptions options;
        options.request.tangents = prep::Request::Level::as_called_for;
        const PreparedScene scene = prepared({mesh}, options);
        for (std::size_t k = 0; k < std::size(all); ++k)
            EXPECT_EQ(scene.splits.*all[k], all[k] == reason ? count : 0u)
                << "reason " << k << " of " << std::find(all, std::end(all), reason) - all;
    };
    Mesh flat = shapes::grid(2, 1);
    flat.normals = {{{0, 0, 1}}, Indices(8, 0)};
    Mesh mesh = flat;
    mesh.colors = {{{{1, 0, 0, 1}, {0, 1, 0, 1}}, halves}};
    expect(mesh, &prep::SplitCounts::color);
    mesh = flat;
    mesh.uvs = {{{{0, 0}, {1, 1}}, halves}};
    expect(mesh, &prep::SplitCounts::uv_seam);
    mesh = flat;
    mesh.tangents = {{{1, 0, 0, 1}, {1, 0, 0, -1}}, halves};
    expect(mesh, &prep::SplitCounts::mirrored_uv);
    mesh.tangents.values[1] = {0, 1, 0, 1};
    expect(mesh, &prep::SplitCounts::tangent);
    mesh = flat;
    mesh.normals = {{{0, 0, 1}, {0.6f, 0, 0.8f}}, halves};
    expect(mesh, &prep::SplitCounts::authored_normal);
    mesh = flat;
    mesh.face_materials = {0, 1};
    expect(mesh, &prep::SplitCounts::material);
    mesh = shapes::cube();
    expect(mesh, &prep::SplitCounts::hard_edge, 16);
    mesh.face_smoothing = {1, 2, 3, 4, 5, 6};
    expect(mesh, &prep::SplitCounts::smoothing_group, 16);
}

// The file's normals are there on one face of a cube: at its corners they part, elsewhere edges do.
TEST(PrepareReports, SplitsAreTheFilesWhereItsNormalsAre) {
    Mesh mesh = shapes::cube();
    mesh.normals = {{{0.6f, 0, 0.8f}}, Indices(24, prep::no_index)};
    for (std::size_t c = 0; c < 4; ++c) mesh.normals.indices[c] = 0;
    const PreparedScene scene = prepared({mesh}, {});
    EXPECT_EQ(scene.splits.authored_normal, 8u);
    EXPECT_EQ(scene.splits.hard_edge, 8u);
}

// Three quads around a vertex, open at the fourth: the first two part for their groups, the second
// and the third for their angle. A copy is told to be for the edges at either corner, whichever of
// their two sides they are on.
TEST(PrepareReports, ACopyIsForTheEdgesAtBothCorners) {
    // The grid's faces are 0 1 / 2 3; around the middle, vertex 4, the order is 0, 1, 3.
    for (const bool backwards : {false, true}) {
        Mesh mesh = shapes::grid(2, 2);
        mesh.positions[0].z = mesh.positions[3].z = -0.2f;  // 0 bends a little, 3 by 90°
        mesh.positions[7] = {1, 1, 1};
        mesh.positions[8] = {2, 1, 1};
        mesh = shapes::with_face_order(mesh, backwards ? Indices{3, 1, 0} : Indices{0, 1, 3});
        mesh.face_smoothing = backwards ? Indices{2, 2, 1} : Indices{1, 2, 2};
        PrepareOptions options;
        options.hard_edges.angle_inside_groups = true;
        const PreparedScene scene = prepared({mesh}, options);
        // The middle has three vertices, of which both copies are for both; the edges' other ends
        // have two each.
        EXPECT_EQ(scene.meshes[0].vertex_count(), 8u + 2 + 2) << backwards;
        EXPECT_EQ(scene.splits.smoothing_group, 2u + 1) << backwards;
        EXPECT_EQ(scene.splits.hard_edge, 2u + 1) << backwards;
    }
}

TEST(PrepareReports, CopiesAtOneVertexAreToldApartByTheirEdges) {
    // Three faces of a cube's corner: groups 1, 1, 2. Inside a group the angle is not asked.
    Mesh mesh = shapes::mesh_of(
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
        {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 6, 3}});
    mesh.face_smoothing = {1, 1, 2};
    PrepareOptions options;
    const PreparedScene scene = prepared({mesh}, options);
    // Face 2 parts from the others at the vertices 0, 3 and 4.
    EXPECT_EQ(scene.splits.smoothing_group, 3u);
    EXPECT_EQ(scene.splits.hard_edge, 0u);
    options.hard_edges.angle_inside_groups = true;
    // Now every face has normals of its own: 3 copies at vertex 0 make 2, and one at 1, 3 and 4.
    const PreparedScene both = prepared({mesh}, options);
    EXPECT_EQ(both.meshes[0].vertex_count(), 7u + 2 + 3);
    // Vertex 0: the second copy has the hard edge on one side and groups on the other, the third
    // likewise; 3 and 4: edges that are hard for both; 1: for its angle alone.
    EXPECT_EQ(both.splits.hard_edge, 5u);
    EXPECT_EQ(both.splits.smoothing_group, 4u);
}

// The file's own tangents, where some are missing or none at all.
Mesh with_tangents() {
    Mesh mesh = shapes::grid(2, 1);
    mesh.normals = {{{0, 0, 1}}, Indices(8, 0)};
    mesh.tangents = {{{1, 0, 0, 1}}, Indices(8, 0)};
    mesh.uvs.resize(1);
    for (const glm::vec3& p : mesh.positions) mesh.uvs[0].values.emplace_back(p.x / 2, 1 - p.y);
    mesh.uvs[0].indices = mesh.corner_vertices;
    return mesh;
}

TEST(PrepareReports, MissingTangentsAreNoWarningBadOnesAre) {
    Mesh mesh = with_tangents();
    mesh.tangents.values.push_back({0, 0, 0, 1});
    mesh.tangents.indices[3] = no_index;
    mesh.tangents.indices[6] = 1;
    PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    const PreparedScene scene = prepared({mesh}, options);
    ASSERT_NE(finding(scene, "missing-tangent"), nullptr);
    EXPECT_EQ(finding(scene, "missing-tangent")->severity, prep::Severity::info);
    EXPECT_EQ(finding(scene, "missing-tangent")->places, Indices{3});
    ASSERT_NE(finding(scene, "zero-tangent"), nullptr);
    EXPECT_EQ(finding(scene, "zero-tangent")->severity, prep::Severity::warning);
    EXPECT_EQ(finding(scene, "zero-tangent")->places, Indices{6});
}

TEST(PrepareReports, FallbacksAreToldOfReplacedTangentsAlone) {
    // The right quad's UVs say nothing; the file has tangents there, but for one corner.
    Mesh mesh = with_tangents();
    mesh.uvs[0].values.push_back({0.5f, 0.5f});
    for (std::uint32_t c = 4; c < 8; ++c) mesh.uvs[0].indices[c] = 6;
    mesh.tangents.indices[5] = no_index;
    PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    const PreparedScene scene = prepared({mesh}, options);
    ASSERT_NE(finding(scene, "tangent-fallback"), nullptr);
    EXPECT_EQ(finding(scene, "tangent-fallback")->count, 1u);
    EXPECT_EQ(finding(scene, "tangent-fallback")->places, Indices{5});
}

TEST(PrepareReports, TangentsOfReplacedNormalsAreStaleWhereThereAreAny) {
    Mesh mesh = with_tangents();
    mesh.normals.values.push_back({0, 0, 0});
    for (const std::uint32_t c : {1u, 2u, 3u}) mesh.normals.indices[c] = 1;
    mesh.tangents.indices[2] = no_index;
    const PreparedScene scene = prepared({mesh});
    ASSERT_NE(finding(scene, "stale-tangent"), nullptr);
    EXPECT_EQ(finding(scene, "stale-tangent")->count, 2u);
    EXPECT_EQ(finding(scene, "stale-tangent")->places, (Indices{1, 3}));
    EXPECT_EQ(finding(scene, "missing-tangent")->places, Indices{2});
}

TEST(PrepareReports, TangentsAreJudgedByTheirAngles) {
    // Corner 0: a w that is nearer to 0 than to 1. 1: short, 3 % off its plane. 2: 75° from the
    // UVs' direction, 3: 50°.
    const double pi = std::acos(-1.0);
    Mesh mesh = with_tangents();
    mesh.tangents.values.insert(
        mesh.tangents.values.end(),
        {{1, 0, 0, 0.3f},
         {0.25f, 0, 0.0075f, 1},
         {float(std::cos(75 * pi / 180)), float(std::sin(75 * pi / 180)), 0, 1},
         {float(std::cos(50 * pi / 180)), float(std::sin(50 * pi / 180)), 0, 1}});
    for (std::uint32_t c = 0; c < 4; ++c) mesh.tangents.indices[c] = c + 1;
    PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    options.tangents = prep::Authored::repair;
    const PreparedScene scene = prepared({mesh}, options);
    const auto places = [&](const char* kind) {
        const prep::Finding* f = finding(scene, kind);
        return f ? f->places : Indices{};
    };
    EXPECT_EQ(places("tangent-sign"), Indices{0});
    EXPECT_EQ(places("non-orthogonal-tangent"), Indices{1});
    EXPECT_EQ(places("non-unit-tangent"), Indices{1});
    EXPECT_EQ(places("tangent-against-uvs"), Indices{2});
}

// Without tangents; the first set runs along x, the second along y.
Mesh with_two_uv_sets() {
    Mesh mesh = with_tangents();
    mesh.tangents = {};
    mesh.uvs.push_back(mesh.uvs[0]);
    for (std::size_t v = 0; v < 6; ++v)
        mesh.uvs[1].values[v] = {mesh.positions[v].y, mesh.positions[v].x};
    return mesh;
}

TEST(PrepareReports, TangentsFollowTheUvSetThatTheNormalMapSamples) {
    prep::Scene scene;
    Mesh mesh = with_two_uv_sets();
    mesh.face_materials = {0, 0};
    scene.meshes = {mesh};
    scene.textures.resize(1);
    scene.materials.resize(1);
    scene.materials[0].normal_map.texture = 0;
    for (const std::uint32_t set : {0u, 1u}) {
        scene.materials[0].normal_map.uv_set = set;
        const auto result = prep::prepare(scene);
        ASSERT_TRUE(result.has_value());
        EXPECT_EQ(result->requirements[0].tangent_uv_set, set);
        for (const glm::vec4& t : result->meshes[0].tangents)
            EXPECT_EQ(glm::vec3(t), set == 0 ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0));
    }
}

// Materials that sample different sets: each face's tangents are those of its own set, as in a mesh
// of its own.
TEST(PrepareReports, TangentsFollowTheUvSetOfEachMaterial) {
    prep::Scene scene;
    Mesh mesh = with_two_uv_sets();
    mesh.face_materials = {0, 1};
    scene.textures.resize(1);
    scene.materials.resize(2);
    for (const std::uint32_t set : {0u, 1u}) {
        scene.meshes = {mesh};
        scene.materials[0].normal_map = {.texture = 0, .uv_set = set};
        scene.materials[1].normal_map = {.texture = 0, .uv_set = 1 - set};
        const auto result = prep::prepare(scene);
        ASSERT_TRUE(result.has_value());
        const prep::MeshRequirements& need = result->requirements[0];
        EXPECT_EQ(need.tangent_uv_set, set);
        ASSERT_EQ(need.other_tangent_uv_sets.size(), 1u);
        EXPECT_EQ(need.other_tangent_uv_sets[0].material, 1u);
        EXPECT_EQ(need.other_tangent_uv_sets[0].uv_set, 1 - set);
        const Mesh& out = result->scene.meshes[0];
        for (std::uint32_t f = 0; f < 2; ++f)
            for (std::uint32_t c = out.face_offsets[f]; c < out.face_offsets[f + 1]; ++c)
                EXPECT_EQ(glm::vec3(out.tangents.values[out.tangents.indices[c]]),
                          (f == 0) == (set == 0) ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0))
                    << f;
    }
}

// So do those of morph targets: a target that turns the sheet about its normal turns each face's
// tangents by the angle, whichever set they follow.
TEST(PrepareReports, MorphedTangentsFollowTheUvSetOfEachMaterial) {
    prep::Scene scene;
    Mesh mesh = with_two_uv_sets();
    mesh.face_materials = {0, 1};
    std::vector<glm::vec3> deltas;
    for (const glm::vec3& p : mesh.positions)  // a quarter of a turn
        deltas.push_back(glm::vec3(-p.y, p.x, p.z) - p);
    prep::MorphTarget target;
    target.positions.push_back(
        {0, std::make_shared<const std::vector<glm::vec3>>(std::move(deltas))});
    mesh.morph_targets = {target};
    scene.meshes = {mesh};
    scene.textures.resize(1);
    scene.materials.resize(2);
    for (prep::Material& material : scene.materials) material.normal_map.texture = 0;
    scene.materials[1].normal_map.uv_set = 1;
    const auto result = prep::prepare(scene);
    ASSERT_TRUE(result.has_value()) << to_string(result.error());
    const prep::VertexMesh& out = result->meshes[0];
    ASSERT_EQ(result->morphs[0].size(), 1u);
    const std::vector<glm::vec3>& moved = result->morphs[0][0].tangents;
    ASSERT_EQ(moved.size(), out.vertex_count());
    for (std::size_t v = 0; v < out.vertex_count(); ++v) {
        const bool first = out.source_corners[v] < mesh.face_offsets[1];
        const glm::vec3 rest = first ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
        EXPECT_LT(glm::length(glm::vec3(out.tangents[v]) - rest), 1e-6F) << v;
        const glm::vec3 turned = glm::vec3(out.tangents[v]) + moved[v];
        EXPECT_LT(glm::length(turned - glm::vec3(-rest.y, rest.x, 0)), 1e-6F) << v;
    }
}

}  // namespace
