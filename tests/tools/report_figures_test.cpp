// The figures beside the pictures of a validation page, each against a count of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "command_runner.h"
#include "sheets/figures.h"

namespace {

using report::FigureGroup;

glm::vec3 leaning(double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    return {std::sin(a), 0, std::cos(a)};
}

// A triangle in the plane z = 0 that faces +z.
prep::VertexMesh triangle() {
    prep::VertexMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    return mesh;
}

std::map<std::string, std::string> by_name(const FigureGroup& group) {
    std::map<std::string, std::string> out;
    for (const report::Figure& f : group.figures) out[f.name] = f.value;
    return out;
}
std::map<std::string, bool> attention(const FigureGroup& group) {
    std::map<std::string, bool> out;
    for (const report::Figure& f : group.figures) out[f.name] = f.attention;
    return out;
}

TEST(AttributeQuality, TurnsAreThoseOfEveryCornerAgainstItsTriangle) {
    prep::VertexMesh a = triangle(), b = triangle();
    a.normals = {leaning(0), leaning(30), leaning(120)};
    b.normals = {leaning(90), leaning(10), leaning(170)};  // a right angle is not behind yet
    const report::AttributeQuality q = report::measure_attributes({a, b});
    EXPECT_TRUE(q.normals);
    EXPECT_FALSE(q.tangents);
    EXPECT_EQ(q.triangles, 2u);
    EXPECT_NEAR(q.mean_turn, (0 + 30 + 120 + 90 + 10 + 170) / 6.0, 1e-5);
    EXPECT_NEAR(q.largest_turn, 170, 1e-5);
    EXPECT_EQ(q.against_face, 2u);
}

TEST(AttributeQuality, WhatHasNoDirectionHasNoTurn) {
    prep::VertexMesh mesh = triangle();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    mesh.normals = {leaning(20), {nan, 0, 1}, leaning(40)};
    // A triangle without area, behind: not measured.
    mesh.positions.push_back({2, 0, 0});
    mesh.normals.push_back(leaning(180));
    mesh.indices.insert(mesh.indices.end(), {0, 1, 3});
    const report::AttributeQuality q = report::measure_attributes({mesh, triangle()});
    EXPECT_NEAR(q.mean_turn, 30, 1e-5);
    EXPECT_NEAR(q.largest_turn, 40, 1e-5);
    EXPECT_EQ(q.against_face, 0u);
    EXPECT_EQ(q.triangles, 3u);
    const report::AttributeQuality none = report::measure_attributes({triangle()});
    EXPECT_FALSE(none.normals);
    EXPECT_EQ(none.mean_turn, 0.0);
    EXPECT_EQ(report::measure_attributes({}).triangles, 0u);
}

TEST(AttributeQuality, LengthsAndRightAnglesAreTheFarthestOff) {
    prep::VertexMesh a = triangle(), b = triangle();
    a.normals = {{0, 0, 1}, {0, 0, 0.5f}, {0, 0, 1.25f}};  // off by 0, 1/2 and 1/4
    a.tangents = {{1, 0, 0, 1}, {0.75f, 0, 0, -1}, {1.125f, 0, 0, 1}};
    b.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    b.tangents = {{1, 0, 0, 1}, {0.8f, 0, -0.6f, 1}, {1, 0, 0, 1}};  // leans by n · t = −0.6
    const report::AttributeQuality q = report::measure_attributes({a, b});
    EXPECT_TRUE(q.tangents);
    EXPECT_NEAR(q.normal_length_error, 0.5, 1e-7);
    EXPECT_NEAR(q.tangent_length_error, 0.25, 1e-7);
    EXPECT_NEAR(q.orthogonality_error, 0.6, 1e-7);
}

// v grows downwards: upright letters have their v axis against y.
TEST(AttributeQuality, MirroredTrianglesAreThoseWhoseLettersAre) {
    prep::VertexMesh upright = triangle(), mirrored = triangle(), flat = triangle();
    upright.uvs = {{{0, 1}, {1, 1}, {0, 0}}};
    mirrored.uvs = {{{1, 1}, {0, 1}, {1, 0}}};
    flat.uvs = {{{0, 0}, {0.5f, 0.5f}, {1, 1}}};
    EXPECT_FALSE(report::mirrored_uv(upright, 0));
    EXPECT_TRUE(report::mirrored_uv(mirrored, 0));
    EXPECT_FALSE(report::mirrored_uv(flat, 0));
    EXPECT_FALSE(report::mirrored_uv(triangle(), 0));
    // The second triangle of a mesh is told by its own corners.
    prep::VertexMesh both = upright;
    both.positions.push_back({0, -1, 0});
    both.uvs[0].push_back({0, 0});  // folded back
    both.indices = {0, 1, 2, 0, 3, 1};
    EXPECT_FALSE(report::mirrored_uv(both, 0));
    EXPECT_TRUE(report::mirrored_uv(both, 1));
    const auto count = [](const std::vector<prep::VertexMesh>& meshes) {
        return report::measure_attributes(meshes).mirrored_triangles;
    };
    EXPECT_EQ(count({upright, flat}), 0u);
    EXPECT_EQ(count({upright, mirrored, both, mirrored}), 3u);
}

// Two meshes whose figures are all different: what belongs to which sum is seen in it.
struct Example {
    prep::PreparedScene prepared;
    std::vector<prep::MeshSummary> summaries{2};
    Example() {
        prepared.scene.meshes.resize(2);
        prepared.scene.meshes[0].positions.resize(17);  // shared since: not the file's
        prepared.meshes = {triangle(), triangle()};
        prepared.meshes[0].positions.resize(2000);
        prepared.meshes[1].positions.resize(345);
        prepared.meshes[1].indices.insert(prepared.meshes[1].indices.end(), {0, 1, 2, 0, 2, 1});
        prepared.meshes[0].ranges = {{0, 1, 4, 0}, {0, 0, prep::no_index, 0}};
        prepared.meshes[1].ranges = {{0, 1, 7, 0}, {1, 1, 4, 0}, {2, 1, 9, 0}};
        prep::MeshSummary &a = summaries[0], &b = summaries[1];
        a.vertices = 1000, b.vertices = 234;
        a.faces = 1'234'567, b.faces = 3;
        a.triangles = 1000, b.triangles = 11;
        a.quads = 2000, b.quads = 22;
        a.polygons = 3000, b.polygons = 33;
        a.components = 4, b.components = 5;
        a.closed = b.closed = a.manifold = b.manifold = a.oriented = b.oriented = true;
    }
    std::vector<FigureGroup> groups() const {
        return report::make_figures(prepared, summaries, "because");
    }
};

TEST(ReportFigures, SumTheMeshesOfTheSheet) {
    const Example example;
    const std::vector<FigureGroup> groups = example.groups();
    ASSERT_EQ(groups.size(), 3u);
    EXPECT_EQ(groups[0].title, "Mesh");
    auto mesh = by_name(groups[0]);
    EXPECT_EQ(mesh["meshes"], "2");
    EXPECT_EQ(mesh["faces"], "1,234,570");
    EXPECT_EQ(mesh["triangles, quads, polygons"], "1,011, 2,022, 3,033");
    EXPECT_EQ(mesh["components"], "9");
    EXPECT_EQ(mesh["closed"], "yes");
    EXPECT_EQ(mesh["manifold"], "yes");
    EXPECT_EQ(mesh["consistent orientation"], "yes");
    EXPECT_EQ(mesh["materials"], "3");  // 4, 7 and 9; none is no material
    auto vertices = by_name(groups[1]);
    EXPECT_EQ(vertices["in the file"], "1,234");
    EXPECT_EQ(vertices["prepared"], "2,345");
    EXPECT_EQ(vertices["triangles"], "4");
    EXPECT_EQ(vertices.size(), 3u);
    auto quality = by_name(groups[2]);
    EXPECT_EQ(quality["normals"], "none");
    EXPECT_EQ(quality["tangents called for"], "because");
    for (const FigureGroup& group : groups)
        for (const auto& [name, seen] : attention(group)) EXPECT_FALSE(seen) << name;
}

TEST(ReportFigures, OneMeshAloneIsNotCounted) {
    Example example;
    example.summaries.resize(1);
    EXPECT_EQ(by_name(example.groups()[0]).count("meshes"), 0u);
}

TEST(ReportFigures, SayWhatIsOpenBadOrMixedInAnyOfTheMeshes) {
    for (const std::size_t which : {std::size_t(0), std::size_t(1)}) {
        Example example;
        prep::MeshSummary& s = example.summaries[which];
        s.closed = s.manifold = s.oriented = false;
        s.open_edges = 1200;
        s.non_manifold_edges = 34;
        example.summaries[1 - which].open_edges = 5;
        const FigureGroup group = example.groups()[0];
        auto mesh = by_name(group);
        EXPECT_EQ(mesh["closed"], "no, 1,205 open edges");
        EXPECT_EQ(mesh["manifold"], "no, 34 bad edges");
        EXPECT_EQ(mesh["consistent orientation"], "no");
        auto seen = attention(group);
        EXPECT_FALSE(seen["closed"]);  // open surfaces are no fault
        EXPECT_TRUE(seen["manifold"]);
        EXPECT_TRUE(seen["consistent orientation"]);
        s.non_manifold_vertices = 1001;
        example.summaries[1 - which].non_manifold_vertices = 1;
        EXPECT_EQ(by_name(example.groups()[0])["manifold"], "no, 34 bad edges, 1,002 bad vertices");
        s.non_manifold_edges = 0;  // bow ties alone
        EXPECT_EQ(by_name(example.groups()[0])["manifold"], "no, 1,002 bad vertices");
    }
}

TEST(ReportFigures, SplitsAreCountedByTheirReasons) {
    Example example;
    using prep::SplitReason;
    const std::pair<SplitReason, const char*> reasons[] = {
        {SplitReason::hard_edge, "split at hard edges"},
        {SplitReason::smoothing_group, "split at smoothing groups"},
        {SplitReason::authored_normal, "split by authored normals"},
        {SplitReason::uv_seam, "split at UV seams"},
        {SplitReason::mirrored_uv, "split at mirrored UVs"},
        {SplitReason::tangent, "split by tangents"},
        {SplitReason::color, "split by colours"},
        {SplitReason::material, "split at materials"}};
    // One vertex for the first, two for the second … in both meshes, and one for all of them.
    auto& first = example.prepared.meshes[0].split_reasons;
    auto& second = example.prepared.meshes[1].split_reasons;
    for (std::size_t k = 0; k < std::size(reasons); ++k)
        for (std::size_t i = 0; i <= k; ++i)
            (i % 2 ? second : first).push_back(prep::SplitReasons(reasons[k].first));
    second.push_back(255);
    second.push_back(0);
    auto vertices = by_name(example.groups()[1]);
    for (std::size_t k = 0; k < std::size(reasons); ++k)
        EXPECT_EQ(vertices[reasons[k].second], std::to_string(k + 2)) << reasons[k].second;
}

TEST(ReportFigures, QualityIsShownAndStandsOutWhereItIsBad) {
    Example example;
    prep::VertexMesh& mesh = example.prepared.meshes[0];
    example.prepared.meshes[1] = {};
    mesh = triangle();
    mesh.normals.assign(3, {0, 0, 1});
    mesh.tangents.assign(3, {1, 0, 0, 1});
    mesh.uvs = {{{1, 1}, {0, 1}, {1, 0}}};
    FigureGroup group = example.groups()[2];
    auto quality = by_name(group);
    EXPECT_EQ(quality["normal length off 1 by"], "0");
    EXPECT_EQ(quality["turn against the face"], "mean 0.0°, max 0.0°");
    EXPECT_EQ(quality["corners lit from behind"], "0");
    EXPECT_EQ(quality["tangent length off 1 by"], "0");
    EXPECT_EQ(quality["normal · tangent at most"], "0");
    EXPECT_EQ(quality["mirrored triangles"], "1 of 1");
    for (const auto& [name, seen] : attention(group)) EXPECT_FALSE(seen) << name;
    mesh.normals = {leaning(100), {0, 0, 1.5f}, leaning(7)};
    mesh.tangents = {{1, 0, 0, 1}, {0.9375f, 0, 0, 1}, {1, 0, 0, 1}};
    group = example.groups()[2];
    quality = by_name(group);
    EXPECT_EQ(quality["normal length off 1 by"], "5.0e-01");
    EXPECT_EQ(quality["turn against the face"], "mean 35.7°, max 100.0°");
    EXPECT_EQ(quality["corners lit from behind"], "1");
    EXPECT_EQ(quality["tangent length off 1 by"], "6.2e-02");   // 1/16
    EXPECT_EQ(quality["normal · tangent at most"], "9.8e-01");  // sin 100°
    auto seen = attention(group);
    for (const char* name : {"normal length off 1 by", "corners lit from behind",
                             "tangent length off 1 by", "normal · tangent at most"})
        EXPECT_TRUE(seen[name]) << name;
}

TEST(ReportFindings, AreAddedByKindAndTheGravestComeFirst) {
    const auto finding = [](const char* kind, prep::Severity severity, std::uint64_t count,
                            std::uint32_t mesh) {
        prep::Finding f;
        f.kind = kind;
        f.severity = severity;
        f.count = count;
        f.mesh = mesh;
        return f;
    };
    using prep::Severity;
    const std::vector<prep::Finding> findings = {
        finding("open-edge", Severity::info, 1000, 0), finding("sliver", Severity::warning, 2, 0),
        finding("open-edge", Severity::info, 234, 1), finding("broken", Severity::error, 5, 1),
        finding("hole", Severity::info, 6, 1)};
    FigureGroup group = report::findings_group(findings, 8);
    ASSERT_EQ(group.figures.size(), 4u);
    const char* const names[] = {"broken", "sliver", "open-edge", "hole"};
    const char* const counts[] = {"5", "2", "1,234", "6"};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(group.figures[i].name, names[i]);
        EXPECT_EQ(group.figures[i].value, counts[i]);
        EXPECT_EQ(group.figures[i].attention, i < 2) << i;
    }
    group = report::findings_group(findings, 3);
    ASSERT_EQ(group.figures.size(), 4u);
    EXPECT_EQ(group.figures[3].name, "and more");
    EXPECT_EQ(group.figures[3].value, "1");  // kinds
    group = report::findings_group({}, 3);
    ASSERT_EQ(group.figures.size(), 1u);
    EXPECT_EQ(group.figures[0].name, "nothing odd");
}

}  // namespace
