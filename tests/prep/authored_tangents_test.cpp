// Tangents that the file brings: kept bit for bit, replaced, or repaired where they are bad.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "prep/prepare.h"
#include "shapes.h"

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// 6 × 6 quads facing +z, UVs along x and −y as glTF counts them: every tangent is (1, 0, 0, 1). The
// file's own are all turned by 10° in the plane, which is nobody's business.
prep::Mesh authored_grid() {
    prep::Mesh mesh = shapes::grid(6, 6);
    mesh.normals.values = {{0, 0, 1}};
    mesh.normals.indices.assign(mesh.corner_count(), 0);
    prep::CornerLayer<glm::vec2>& uv = mesh.uvs.emplace_back();
    for (const glm::vec3& p : mesh.positions) uv.values.push_back({p.x / 6, 1 - p.y / 6});
    uv.indices = mesh.corner_vertices;
    const float turn = 10 * 3.14159265f / 180;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        mesh.tangents.values.push_back({std::cos(turn), std::sin(turn), 0, 1});
        mesh.tangents.indices.push_back(c);
    }
    return mesh;
}

prep::PreparedScene prepared(prep::Mesh mesh, prep::Authored what) {
    prep::Scene scene;
    scene.meshes.push_back(std::move(mesh));
    prep::PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    options.tangents = what;
    auto result = prep::prepare(std::move(scene), options);
    EXPECT_TRUE(result.has_value());
    return *std::move(result);
}

glm::vec4 tangent(const prep::Mesh& mesh, std::uint32_t corner) {
    const std::uint32_t i = mesh.tangents.indices[corner];
    return i == prep::no_index ? glm::vec4(nan) : mesh.tangents.values[i];
}

bool same(const glm::vec4& a, const glm::vec4& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

const prep::Finding* finding(const prep::PreparedScene& scene, const std::string& kind) {
    for (const prep::Finding& f : scene.findings)
        if (f.kind == kind) return &f;
    return nullptr;
}

struct Fault {
    std::uint32_t corner;
    const char* kind;
    glm::vec4 value;
};

const Fault faults[] = {
    {3, "non-finite-tangent", {nan, 0, 0, 1}},
    {20, "zero-tangent", {0, 0, 0, 1}},
    {41, "tangent-sign", {1, 0, 0, 0}},
    {62, "non-unit-tangent", {2, 0, 0, 1}},
    {63, "non-unit-tangent", {0, 0, 0.25f, 1}},  // and out of the plane
    {80, "non-orthogonal-tangent", {0.6f, 0, 0.8f, 1}},
    {95, "tangent-against-uvs", {0, 1, 0, 1}},
    {101, "tangent-against-uvs", {1, 0, 0, -1}},
};

prep::Mesh grid_with_faults() {
    prep::Mesh mesh = authored_grid();
    for (const Fault& fault : faults) mesh.tangents.values[fault.corner] = fault.value;
    mesh.tangents.indices[130] = prep::no_index;
    return mesh;
}

TEST(AuthoredTangents, GoodOnesKeepTheirBits) {
    const prep::Mesh mesh = authored_grid();
    for (const prep::Authored what : {prep::Authored::keep, prep::Authored::repair}) {
        const prep::PreparedScene out = prepared(mesh, what);
        for (std::uint32_t c = 0; c < mesh.corner_count(); ++c)
            EXPECT_TRUE(same(tangent(out.scene.meshes[0], c), tangent(mesh, c))) << "corner " << c;
        EXPECT_TRUE(out.findings.empty());
    }
}

TEST(AuthoredTangents, ReplaceComputesThemAll) {
    const prep::PreparedScene out = prepared(grid_with_faults(), prep::Authored::replace);
    const prep::Mesh& mesh = out.scene.meshes[0];
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        EXPECT_NEAR(tangent(mesh, c).x, 1.0f, 1e-6) << "corner " << c;
        EXPECT_EQ(tangent(mesh, c).w, 1.0f) << "corner " << c;
    }
}

TEST(AuthoredTangents, RepairTouchesTheBadOnesAlone) {
    const prep::Mesh mesh = grid_with_faults();
    const prep::PreparedScene out = prepared(mesh, prep::Authored::repair);
    std::vector<bool> bad(mesh.corner_count(), false);
    bad[130] = true;
    for (const Fault& fault : faults) bad[fault.corner] = true;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::vec4 got = tangent(out.scene.meshes[0], c);
        if (bad[c])
            EXPECT_NEAR(glm::distance(got, glm::vec4(1, 0, 0, 1)), 0, 1e-6) << "corner " << c;
        else
            EXPECT_TRUE(same(got, tangent(mesh, c))) << "corner " << c;
    }
}

TEST(AuthoredTangents, RepairSaysWhichAndWhy) {
    const prep::PreparedScene out = prepared(grid_with_faults(), prep::Authored::repair);
    const auto expect = [&](const char* kind, std::vector<std::uint32_t> places) {
        const prep::Finding* f = finding(out, kind);
        ASSERT_NE(f, nullptr) << kind;
        EXPECT_EQ(f->count, places.size()) << kind;
        EXPECT_EQ(f->places, places) << kind;
        EXPECT_NE(f->text.find(std::string(kind) == "missing-tangent" ? "got" : "replaced"),
                  std::string::npos)
            << f->text;
    };
    expect("missing-tangent", {130});
    expect("non-finite-tangent", {3});
    expect("zero-tangent", {20});
    expect("tangent-sign", {41});
    expect("non-unit-tangent", {62, 63});
    expect("non-orthogonal-tangent", {63, 80});
    expect("tangent-against-uvs", {63, 95, 101});  // 63 points along the normal
    EXPECT_EQ(finding(out, "tangent-fallback"), nullptr);
}

// Without a direction or a sign there is no frame; everything else is the author's decision.
TEST(AuthoredTangents, KeepReplacesTheUnusableAlone) {
    const prep::Mesh mesh = grid_with_faults();
    const prep::PreparedScene out = prepared(mesh, prep::Authored::keep);
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::vec4 got = tangent(out.scene.meshes[0], c), own = tangent(mesh, c);
        if (c == 3 || c == 20 || c == 41 || c == 130)
            EXPECT_NEAR(glm::distance(got, glm::vec4(1, 0, 0, 1)), 0, 1e-6) << "corner " << c;
        else if (c == 62)
            EXPECT_EQ(got, glm::vec4(1, 0, 0, 1));
        else if (c == 63)
            EXPECT_EQ(got, glm::vec4(0, 0, 1, 1));
        else
            EXPECT_TRUE(same(got, own)) << "corner " << c;
    }
    ASSERT_NE(finding(out, "non-orthogonal-tangent"), nullptr);
    EXPECT_NE(finding(out, "non-orthogonal-tangent")->text.find("kept"), std::string::npos);
    EXPECT_EQ(finding(out, "tangent-against-uvs"), nullptr);
}

TEST(AuthoredTangents, UvsWithoutAGradientJudgeNobody) {
    prep::Mesh mesh = authored_grid();
    mesh.uvs[0].values.assign(mesh.uvs[0].values.size(), glm::vec2(0.5f));
    const prep::PreparedScene out = prepared(mesh, prep::Authored::repair);
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c)
        EXPECT_TRUE(same(tangent(out.scene.meshes[0], c), tangent(mesh, c))) << "corner " << c;
    EXPECT_TRUE(out.findings.empty());
}

// One normal of the file is bad: repairing it leaves the tangents of all other corners alone.
TEST(AuthoredTangents, RepairOutlivesRepairedNormals) {
    prep::Mesh mesh = authored_grid();
    mesh.normals.values.push_back({0, 0, 0});
    mesh.normals.indices[77] = 1;
    mesh.tangents.values[77] = {0, 0, 1, 1};
    prep::Scene scene;
    scene.meshes.push_back(mesh);
    prep::PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    options.tangents = options.normals = prep::Authored::repair;
    const auto out = prep::prepare(std::move(scene), options);
    ASSERT_TRUE(out.has_value());
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c)
        EXPECT_EQ(same(tangent(out->scene.meshes[0], c), tangent(mesh, c)), c != 77)
            << "corner " << c;
}

TEST(AuthoredTangents, EmptyMesh) {
    EXPECT_TRUE(prepared(prep::Mesh(), prep::Authored::repair).findings.empty());
}

}  // namespace
