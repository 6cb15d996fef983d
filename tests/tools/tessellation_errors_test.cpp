// What a validation sheet says of tessellated meshes: the error of each triangle, by closed forms,
// its colour, and the certificate's figures.
#include "sheets/surfaces/tessellation_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "prep/prepare.h"
#include "shapes.h"
#include "sheets/panels.h"

namespace {

// A square from 0 to 1 that faces +z; UVs are x and y.
prep::Mesh square() {
    prep::Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}});
    mesh.uvs.resize(1);
    mesh.uvs[0].values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.uvs[0].indices = mesh.corner_vertices;
    return mesh;
}

// x² y: bent more and more towards one corner.
struct Bent final : prep::HeightFunction {
    static double height(double x, double y) { return x * x * y; }
    Sample at(const glm::dvec2& uv) const override {
        return {height(uv.x, uv.y), {2 * uv.x * uv.y, uv.x * uv.x}};
    }
    // Second derivatives are at most 2 in size, their norm at most 3: half of it by the square of
    // the longest edge is no less than the departure.
    double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<double, 3>&,
                     double) const override {
        double longest = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 edge = uv[(k + 1) % 3] - uv[k];
            longest = std::max(longest, glm::dot(edge, edge));
        }
        return 1.5 * longest;
    }
};

TEST(TessellationErrors, OfEachTriangleAreNotBelowWhatItIsOff) {
    prep::TessellateOptions options;
    options.displacements = {{.height = std::make_shared<Bent>()}};
    options.max_triangles = 300;
    const auto without = prep::tessellate(square(), options);
    ASSERT_TRUE(without);
    EXPECT_TRUE(without->errors.empty());
    options.keep_errors = true;
    const auto made = prep::tessellate(square(), options);
    ASSERT_TRUE(made);
    const prep::Mesh& mesh = made->mesh;
    ASSERT_EQ(made->errors.size(), mesh.face_count());
    double least = 1, most = 0;
    for (std::size_t t = 0; t < mesh.face_count(); ++t) {
        glm::dvec3 p[3];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = glm::dvec3(mesh.positions[mesh.corner_vertices[3 * t + k]]);
        double off = 0;
        constexpr int steps = 12;
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; i + j <= steps; ++j) {
                const double a = double(i) / steps, b = double(j) / steps;
                const glm::dvec3 at = a * p[0] + b * p[1] + (1 - a - b) * p[2];
                off = std::max(off, std::abs(at.z - Bent::height(at.x, at.y)));
            }
        EXPECT_GE(double(made->errors[t]), off) << "triangle " << t;
        least = std::min(least, double(made->errors[t]));
        most = std::max(most, double(made->errors[t]));
    }
    EXPECT_GE(most, made->certificate.proved);
    EXPECT_LT(most, made->certificate.proved * 1.000001);
    EXPECT_LT(least, most) << "triangles differ";
}

prep::PrepareOptions options_of(bool tessellate, bool keep_cages) {
    prep::PrepareOptions options;
    options.tessellate = tessellate;
    options.tessellation.edge_length = 0.3;
    options.keep_cages = keep_cages;
    return options;
}

prep::PreparedScene prepared_square(const prep::PrepareOptions& options) {
    prep::Scene scene;
    scene.meshes = {square()};
    scene.nodes.resize(1);
    scene.nodes[0].mesh = 0;
    auto prepared = prep::prepare(std::move(scene), options);
    EXPECT_TRUE(prepared);
    return *std::move(prepared);
}

TEST(TessellationErrors, AreKeptWithTheCages) {
    EXPECT_TRUE(prepared_square(options_of(true, false)).tessellation_errors.empty());
    const prep::PreparedScene kept = prepared_square(options_of(true, true));
    ASSERT_EQ(kept.tessellation_errors.size(), 1U);
    EXPECT_EQ(kept.tessellation_errors[0].size(), kept.scene.meshes[0].face_count());
}

// Four triangles of two materials, whose ranges put them in another order than the faces'.
prep::PreparedScene four_triangles(std::vector<float> errors, std::optional<double> asked) {
    prep::Scene scene;
    prep::Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}},
                                      {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
    scene.materials.resize(2);
    mesh.face_materials = {1, 0, 1, 0};
    scene.meshes = {std::move(mesh)};
    scene.nodes.resize(1);
    scene.nodes[0].mesh = 0;
    auto prepared = prep::prepare(std::move(scene), {});
    EXPECT_TRUE(prepared);
    prepared->tessellation_errors = {std::move(errors)};
    prepared->tessellated.resize(1);
    prepared->tessellated[0].emplace();
    prepared->tessellated[0]->asked = asked;
    return *std::move(prepared);
}

enum class Hue { pale, bluish, blue, red };
Hue hue_of(const glm::vec4& c) {
    if (c.r > 2 * c.b) return Hue::red;
    if (c.r == c.b) return Hue::pale;
    return c.b > 5 * c.r ? Hue::blue : Hue::bluish;
}

// By the middle of each triangle, which tells its face.
std::vector<Hue> hues(const prep::VertexMesh& mesh) {
    std::vector<Hue> by_face(4, Hue::pale);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        glm::vec3 middle(0.0f);
        for (std::size_t k = 0; k < 3; ++k) middle += mesh.positions[mesh.indices[3 * t + k]];
        middle /= 3.0f;
        const std::size_t face = middle.y < 0.3f   ? 0
                                 : middle.x > 0.7f ? 1
                                 : middle.y > 0.7f ? 2
                                                   : 3;
        by_face[face] = hue_of(mesh.colors.at(0)[mesh.indices[3 * t]]);
        for (std::size_t k = 1; k < 3; ++k)
            EXPECT_EQ(mesh.colors[0][mesh.indices[3 * t + k]], mesh.colors[0][mesh.indices[3 * t]]);
    }
    return by_face;
}

TEST(TessellationErrors, AreColoursOfTheirOwnTriangles) {
    prep::PreparedScene scene = four_triangles({0, 0.5F, 1, 1.25F}, 1.0);
    ASSERT_NE(scene.meshes[0].triangle_faces, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    const report::ErrorColors found = report::color_by_errors(scene);
    EXPECT_TRUE(found.asked);
    EXPECT_EQ(found.triangles, 4U);
    EXPECT_EQ(found.missed, 1U);
    EXPECT_EQ(hues(scene.meshes[0]),
              (std::vector<Hue>{Hue::pale, Hue::bluish, Hue::blue, Hue::red}));
}

// Without a length to compare with, the largest is blue; what has no bound at all is red.
TEST(TessellationErrors, AreBesideTheLargestWhereNoneWasAsked) {
    const float none = std::numeric_limits<float>::infinity();
    prep::PreparedScene scene = four_triangles({0.02F, none, 0, 0.01F}, std::nullopt);
    const report::ErrorColors found = report::color_by_errors(scene);
    EXPECT_FALSE(found.asked);
    EXPECT_EQ(found.missed, 1U);
    EXPECT_EQ(hues(scene.meshes[0]),
              (std::vector<Hue>{Hue::blue, Hue::red, Hue::pale, Hue::bluish}));
}

std::string figure(const report::FigureGroup& group, const std::string& name) {
    for (const report::Figure& f : group.figures)
        if (f.name == name) return f.value + (f.attention ? " !" : "");
    return "absent";
}

TEST(TessellationErrors, FiguresAreThoseOfTheCertificate) {
    prep::PreparedScene scene = four_triangles({0, 0, 0, 0}, 0.25);
    prep::TessellationCertificate& c = *scene.tessellated[0];
    c.proved = 0.5;
    c.measured = 0.125;
    c.samples = 12345;
    c.largest_shared_gap = 0.375;
    c.triangles = 4000;
    c.deepest = 17;
    c.unresolved = 3;
    c.worst_face = 2;
    const report::FigureGroup group = report::tessellation_group(scene, 1);
    EXPECT_EQ(group.title, "Tessellation");
    EXPECT_EQ(figure(group, "triangles"), "4,000");
    EXPECT_EQ(figure(group, "error asked"), "0.25");
    EXPECT_EQ(figure(group, "error proved"), "0.5 !");
    EXPECT_EQ(figure(group, "measured, 12,345 points"), "0.125");
    EXPECT_EQ(figure(group, "of it shared at seams"), "0.375");
    EXPECT_EQ(figure(group, "largest at cage face"), "2");
    EXPECT_EQ(figure(group, "halvings at most"), "17");
    EXPECT_EQ(figure(group, "finer than floats"), "3 !");
    EXPECT_EQ(figure(group, "left by the maximum"), "absent");
    EXPECT_EQ(figure(group, "open edges, of three or more"), "4, 0");
    scene.tessellated[0].reset();
    EXPECT_TRUE(report::tessellation_group(scene, 1).figures.empty());
}

TEST(TessellationErrors, HaveAPanelOfTessellatedMeshesAlone) {
    for (const bool tessellate : {false, true}) {
        const prep::PrepareOptions prepare = options_of(tessellate, true);
        const prep::PreparedScene prepared = prepared_square(prepare);
        report::PanelOptions options;
        options.size = 64;
        options.prepare = prepare;
        for (const report::Subject& subject :
             {report::whole_subject(prepared, "it"), report::mesh_subject(prepared, 0)}) {
            const auto set = report::make_panels(subject, options);
            ASSERT_TRUE(set);
            const auto there = std::find_if(
                set->panels.begin(), set->panels.end(),
                [](const report::Panel& panel) { return panel.id == "tessellation-error"; });
            ASSERT_EQ(there != set->panels.end(), tessellate);
            if (tessellate) {
                EXPECT_TRUE(there->picture.has_value());
            }
        }
    }
}

}  // namespace
