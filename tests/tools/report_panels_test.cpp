// The pictures of a validation sheet: where the camera stands, what their colours and lines say,
// and the figures that go with them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "shapes.h"
#include "sheets/overlay.h"
#include "sheets/panels.h"
#include "sheets/shot.h"

namespace {

using report::PanelSet;

prep::PreparedScene prepared_of(prep::Mesh mesh, const glm::dmat4& transform = glm::dmat4(1.0),
                                prep::Material* material = nullptr) {
    prep::Scene scene;
    if (material) {
        scene.materials.push_back(*material);
        mesh.face_materials.assign(mesh.face_count(), 0);
    }
    scene.meshes.push_back(std::move(mesh));
    scene.nodes.push_back({});
    scene.nodes[0].mesh = 0;
    scene.nodes[0].transform = transform;
    prep::PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    auto prepared = prep::prepare(std::move(scene), options);
    EXPECT_TRUE(prepared);
    return *std::move(prepared);
}

// A square from −1 to 1 that faces +z, upright letters on it or mirrored ones.
prep::Mesh square(bool mirrored = false) {
    prep::Mesh mesh =
        shapes::mesh_of({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2, 3}});
    mesh.uvs.resize(1);
    mesh.uvs[0].values = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    if (mirrored)
        for (glm::vec2& uv : mesh.uvs[0].values) uv.x = 1 - uv.x;
    mesh.uvs[0].indices = mesh.corner_vertices;
    return mesh;
}

PanelSet panels(const prep::PreparedScene& scene, std::uint32_t size = 64,
                const prep::PrepareOptions& prepare = {}) {
    report::PanelOptions options;
    options.size = size;
    options.azimuth = options.elevation = 0;
    options.prepare = prepare;
    auto set = report::make_panels(report::whole_subject(scene, "it"), options);
    EXPECT_TRUE(set);
    return *std::move(set);
}

const report::Panel& panel(const PanelSet& set, const std::string& id) {
    for (const report::Panel& p : set.panels)
        if (p.id == id) return p;
    ADD_FAILURE() << "no panel " << id;
    return set.panels.front();
}

double srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

TEST(Shot, AveragesWhatIsCoveredAndSaysHowMuchThatIs) {
    prep::Material material;
    material.diffuse = glm::vec4(0.2f, 0.4f, 0.6f, 1.0f);
    material.specular = glm::vec3(0);
    const prep::PreparedScene scene = prepared_of(square(), glm::dmat4(1.0), &material);
    rast::View view;
    view.perspective = false;
    view.half_height = 1.6;  // 16 pixels are 3.2 units: the square's edges lie at 3 and 13
    view.znear = 1;
    view.zfar = 10;
    view.aspect = 1;
    view.world_to_view[3] = glm::dvec4(0.1 + 1e-4, 0, -5, 1);  // half a pixel to the right
    report::ShotOptions options;
    options.size = 16;
    options.samples = 4;
    rast::LightInstance ambient;
    ambient.kind = prep::LightKind::ambient;
    ambient.color = glm::vec3(0.5f);
    options.lights = {ambient};
    const auto shot = report::take_shot(scene, view, options);
    ASSERT_TRUE(shot);
    const prep::Image& image = shot->image;
    EXPECT_EQ(image.width, 16u);
    EXPECT_EQ(image.channels, 4u);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(double(image.at(8, 8)[k]), srgb(0.1 * (k + 1)), 1e-5);
    EXPECT_EQ(image.at(8, 8)[3], 1.0f);
    EXPECT_EQ(image.at(1, 1)[3], 0.0f);
    // Half of a column is covered, and its colour is that of the covered half.
    EXPECT_NEAR(double(image.at(3, 8)[3]), 0.5, 1e-6);
    EXPECT_NEAR(double(image.at(13, 8)[3]), 0.5, 1e-6);
    EXPECT_NEAR(double(image.at(3, 8)[1]), srgb(0.2), 1e-5);
    options.data = true;  // values, not light
    EXPECT_NEAR(double(report::take_shot(scene, view, options)->image.at(8, 8)[1]), 0.2, 1e-6);
}

// Every vertex is inside, and four sides of the frame are touched as far as the margin allows.
TEST(FittedView, IsTheClosestThatShowsAll) {
    std::mt19937_64 random(5);
    prep::Mesh mesh = shapes::torus(12, 8);
    shapes::jitter(mesh, 0.3f, random);
    glm::dmat4 transform(1.0);
    transform[1][1] = 3;
    transform[3] = {50, -20, 10, 1};
    const prep::PreparedScene scene = prepared_of(mesh, transform);
    for (const auto& [azimuth, elevation] : {std::pair{0.0, 0.0}, {30.0, 20.0}, {200.0, -50.0}}) {
        const rast::View view = report::fitted_view(scene, azimuth, elevation, 0.25);
        double most_x = 0, most_y = 0, farthest = 0;
        const double t = std::tan(view.yfov / 2);
        for (const glm::vec3& p : mesh.positions) {
            const glm::dvec4 q = view.world_to_view * (transform * glm::dvec4(glm::dvec3(p), 1));
            ASSERT_LT(q.z, 0);
            EXPECT_GE(-q.z, view.znear);
            farthest = std::max(farthest, -q.z);
            most_x = std::max(most_x, std::abs(q.x / (q.z * t)));
            most_y = std::max(most_y, std::abs(q.y / (q.z * t)));
        }
        EXPECT_NEAR(std::max(most_x, most_y), 1 / 1.25, 1e-9) << azimuth;
        // It looks from where it should: azimuth 90 is +x, elevation upwards.
        const double a = azimuth * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
        const glm::dvec3 back(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
        EXPECT_NEAR(glm::length(view.forward() + back), 0, 1e-9);
    }
}

// (1 + n) / 2, axis by axis: x as red, y as green, z as blue.
TEST(Panels, NormalsAreShownAsColours) {
    prep::Mesh bare = square();
    bare.uvs.clear();
    const struct {
        glm::dvec3 x, y;  // the square's axes
        double color[3];
    } cases[] = {{{1, 0, 0}, {0, 1, 0}, {0.5, 0.5, 1}},
                 {{0.8, 0, -0.6}, {0, 1, 0}, {0.8, 0.5, 0.9}},
                 {{1, 0, 0}, {0, 0.8, 0.6}, {0.5, 0.2, 0.9}}};
    for (const auto& c : cases) {
        const glm::dmat4 turned(glm::dmat3(c.x, c.y, glm::cross(c.x, c.y)));
        const PanelSet set = panels(prepared_of(bare, turned));
        const prep::Image& image = *panel(set, "normals").picture;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(double(image.at(32, 32)[k]), c.color[k], 1e-3) << k;
    }
}

// The middle of what is drawn in red (0) or green (1): lines are thin, their colour is a tint.
struct Spot {
    double x = 0, y = 0, weight = 0;
};
Spot spot(const prep::Image& image, int channel, double near_x = 0, double near_y = 0,
          double within = 1e9) {
    Spot out;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            if (std::abs(x - near_x) > within || std::abs(y - near_y) > within) continue;
            const float* p = image.at(x, y);
            const double others = double(p[1 - channel] + p[2]) / 2;
            const double tint = (double(p[channel]) - others) * double(p[3]);
            if (tint < 0.1) continue;
            out.x += tint * (x + 0.5), out.y += tint * (y + 0.5);
            out.weight += tint;
        }
    if (out.weight > 0) out.x /= out.weight, out.y /= out.weight;
    return out;
}

TEST(Panels, TangentsPointAlongUAndBitangentsAgainstV) {
    // Upright letters on the left, mirrored ones on the right.
    prep::Mesh mesh = square();
    const prep::Mesh other = square(true);
    for (std::uint32_t i = 0; i < 4; ++i) {
        mesh.positions.push_back(other.positions[i] + glm::vec3(2, 0, 0));
        mesh.positions[i].x -= 2;
        mesh.uvs[0].values.push_back(other.uvs[0].values[i]);
        mesh.corner_vertices.push_back(4 + i);
        mesh.uvs[0].indices.push_back(4 + i);
    }
    mesh.face_offsets.push_back(8);
    const PanelSet set = panels(prepared_of(mesh), 240);
    const report::Panel& p = panel(set, "tangents");
    EXPECT_EQ(p.caption, "2 of 4 triangles have mirrored UVs");
    EXPECT_EQ(p.legend.size(), 3u);
    for (const bool mirrored : {false, true}) {
        // The lower corner from which u grows inwards; ticks are 14 · 240/480 = 7 pixels long.
        const double unit = 120 / 1.06 / 3, corner_x = 120 + (mirrored ? 3 : -3) * unit,
                     corner_y = 120 + unit;
        const Spot tangent = spot(*p.picture, 0, corner_x, corner_y, 12),
                   bitangent = spot(*p.picture, 1, corner_x, corner_y, 12);
        ASSERT_GT(tangent.weight, 1);
        ASSERT_GT(bitangent.weight, 1);
        EXPECT_NEAR(tangent.x - corner_x, mirrored ? -3.5 : 3.5, 1.2);
        EXPECT_NEAR(tangent.y, corner_y, 1.5);
        EXPECT_NEAR(bitangent.x, corner_x, 1.5);
        EXPECT_NEAR(bitangent.y - corner_y, -3.5, 1.2);  // upwards: v grows downwards
        // Mirrored triangles are bluish.
        const float* middle = p.picture->at(mirrored ? 195 : 45, 120);
        EXPECT_EQ(middle[2] > middle[0] + 0.1f, mirrored);
    }
}

TEST(Panels, EdgesAreCountedByClassAndThoseBehindAreHidden) {
    const prep::PreparedScene cube = prepared_of(shapes::cube());
    PanelSet set = panels(cube, 120);
    EXPECT_EQ(panel(set, "hard-edges").caption, "Shading breaks at 12 edges");
    ASSERT_EQ(set.edges.figures.size(), 1u);
    EXPECT_EQ(set.edges.figures[0].name, "angle");
    EXPECT_EQ(set.edges.figures[0].value, "12");
    EXPECT_EQ(panel(set, "wireframe").caption.substr(0, 23), "12 edges as in the file");
    EXPECT_EQ(panel(set, "flat").caption, "One normal a triangle: 12 facets");
    EXPECT_EQ(panel(set, "gouraud").caption.substr(0, 20), "Light at 24 vertices");
    // From straight ahead the four edges of the far side lie behind the near one, but for
    // perspective's sake within it: a ring of lines, nothing in the middle.
    const prep::Image& lines = *panel(set, "hard-edges").picture;
    EXPECT_GT(spot(lines, 0).weight, 100);
    const std::uint32_t inner = 120 / 5;
    for (std::uint32_t y = inner; y < 120 - inner; ++y)
        for (std::uint32_t x = inner; x < 120 - inner; ++x)
            ASSERT_FALSE(lines.at(x, y)[0] > lines.at(x, y)[1] + 0.3f) << x << " " << y;
    // A square alone: its borders do not break anything.
    prep::Mesh bare = square();
    bare.uvs.clear();
    set = panels(prepared_of(bare), 64);
    EXPECT_EQ(panel(set, "hard-edges").caption, "Shading breaks nowhere: all edges are smooth");
    ASSERT_EQ(set.edges.figures.size(), 1u);
    EXPECT_EQ(set.edges.figures[0].name, "open border");
    EXPECT_EQ(set.edges.figures[0].value, "4");
    ASSERT_EQ(panel(set, "hard-edges").legend.size(), 1u);
    EXPECT_EQ(panel(set, "hard-edges").legend[0].text, "open border");
}

// The figures between two pictures: over what both of them cover, in levels of 8 bits.
TEST(Panels, ShadingsApartAreMeasuredOnTheirPictures) {
    prep::Mesh mesh = shapes::uv_sphere(8, 5);
    mesh.uvs.resize(1);
    for (const glm::vec3& p : mesh.positions) mesh.uvs[0].values.push_back({p.x, p.y + 3 * p.z});
    mesh.uvs[0].indices = mesh.corner_vertices;
    const PanelSet set = panels(prepared_of(mesh), 64);
    const char* const pairs[3][2] = {
        {"flat", "gouraud"}, {"gouraud", "phong"}, {"phong", "normal-mapped"}};
    ASSERT_EQ(set.differences.figures.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        const prep::Image &a = *panel(set, pairs[i][0]).picture,
                          &b = *panel(set, pairs[i][1]).picture;
        double squares = 0, largest = 0;
        int count = 0;
        for (std::uint32_t y = 0; y < 64; ++y)
            for (std::uint32_t x = 0; x < 64; ++x)
                for (int k = 0; k < 3; ++k) {
                    if (a.at(x, y)[3] == 0 || b.at(x, y)[3] == 0) continue;
                    const double d = 255 * std::abs(double(a.at(x, y)[k]) - double(b.at(x, y)[k]));
                    squares += d * d;
                    largest = std::max(largest, d);
                    ++count;
                }
        char text[60];
        std::snprintf(text, sizeof text, "RMS %.2f, max %.0f", std::sqrt(squares / count), largest);
        EXPECT_EQ(set.differences.figures[i].value, text) << pairs[i][0];
        EXPECT_GT(largest, 5) << pairs[i][0];
    }
}

TEST(Panels, WhatCannotBeDrawnSaysWhy) {
    const auto note = [](const PanelSet& set, const char* id) {
        const report::Panel& p = panel(set, id);
        EXPECT_FALSE(p.picture.has_value()) << id;
        return p.note;
    };
    prep::Mesh bare = square();
    bare.uvs.clear();
    PanelSet set = panels(prepared_of(bare));
    EXPECT_EQ(note(set, "uv"), "No UVs in the file.");
    EXPECT_EQ(note(set, "tangents"), "No UVs: tangents are not defined.");
    EXPECT_EQ(note(set, "normal-mapped"), "No UVs: a normal map has nothing to lie on.");
    prep::PreparedScene without = prepared_of(square());
    without.meshes[0].tangents.clear();
    without.meshes[0].normals.clear();
    set = panels(without);
    EXPECT_EQ(note(set, "tangents"), "No tangents were prepared: switched off by the options.");
    EXPECT_EQ(note(set, "normal-mapped"),
              "No tangents were prepared, and a normal map needs them.");
    EXPECT_EQ(note(set, "normals"), "No normals were prepared: nothing that is lit.");
    set = panels(prepared_of({}));
    ASSERT_EQ(set.panels.size(), 4u);
    for (const report::Panel& p : set.panels) EXPECT_EQ(p.note, "No faces: nothing to shade.");
}

// A mesh of several stands alone on its sheet, where its first instance is.
TEST(Panels, AMeshAloneKeepsItsPlaceAndItsMaterials) {
    prep::Scene scene;
    scene.meshes = {square(), square(), square()};
    scene.meshes[1].name = "middle";
    scene.nodes.resize(4);
    for (std::uint32_t n = 0; n < 4; ++n) {
        scene.nodes[n].mesh = n == 3 ? 1 : n;
        scene.nodes[n].transform[3] = {double(n), 0, 0, 1};
    }
    scene.nodes[1].parent = 2;
    scene.materials.resize(2);
    const auto prepared = prep::prepare(std::move(scene));
    ASSERT_TRUE(prepared);
    const report::Subject subject = report::mesh_subject(*prepared, 1);
    EXPECT_EQ(subject.name, "mesh 'middle'");
    EXPECT_EQ(report::mesh_subject(*prepared, 2).name, "mesh 2");
    ASSERT_EQ(subject.scene.meshes.size(), 1u);
    ASSERT_EQ(subject.scene.scene.nodes.size(), 1u);
    EXPECT_EQ(subject.scene.scene.nodes[0].mesh, 0u);
    EXPECT_EQ(subject.scene.scene.nodes[0].transform[3].x, 3.0);  // 1 under 2, not the one at 3
    EXPECT_EQ(subject.scene.scene.materials.size(), 2u);
}

TEST(Overlay, DrawsWhatTheEyeSees) {
    // A small square before the middle of a large one.
    prep::Mesh mesh = square();
    mesh.uvs.clear();
    for (const glm::vec3& p : std::vector<glm::vec3>(mesh.positions))
        mesh.positions.push_back({p.x / 2, p.y / 2, 1});
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), {4, 5, 6, 7});
    mesh.face_offsets.push_back(8);
    const prep::PreparedScene scene = prepared_of(mesh);
    rast::View view;
    view.perspective = false;
    view.half_height = 2;
    view.znear = 1;
    view.zfar = 10;
    view.aspect = 1;
    view.world_to_view[3] = glm::dvec4(0, 0, -5, 1);
    report::ShotOptions options;
    options.size = 40;
    const auto shot = report::take_shot(scene, view, options);
    ASSERT_TRUE(shot);
    report::Overlay overlay(*shot);
    EXPECT_TRUE(overlay.visible({0, 0, 1}));
    EXPECT_FALSE(overlay.visible({0, 0, 0}));
    EXPECT_TRUE(overlay.visible({0.8, 0, 0}));
    EXPECT_FALSE(overlay.visible({5, 0, 0}));  // off the picture
    EXPECT_NEAR(overlay.pixel_extent({0, 0, 0}), 4.0 / 40, 1e-12);
    EXPECT_NEAR(overlay.projected({1, 0.5, 0}).x, 30, 1e-9);
    EXPECT_NEAR(overlay.projected({1, 0.5, 0}).y, 15, 1e-9);
    // A line on the large square, behind the small one: two pieces.
    overlay.segment({-0.9, 0.05, 0}, {0.9, 0.05, 0}, report::rgb(0x00ff00), 1.5);
    const prep::Image image = overlay.image();
    for (std::uint32_t x = 12; x < 28; ++x) {
        if (x == 14 || x == 15 || x == 24 || x == 25) continue;  // round ends
        EXPECT_EQ(image.at(x, 19)[1] > 0.99f && image.at(x, 19)[0] < 0.01f, x < 15 || x >= 25) << x;
    }
    // A quarter of the rows beside it, on a surface that stays opaque.
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(image.at(13, 18)[k], 0.75f * shot->image.at(13, 18)[k] + (k == 1 ? 0.25f : 0),
                    1e-5f);
    EXPECT_NEAR(image.at(13, 18)[3], 1, 1e-6f);
}

}  // namespace
