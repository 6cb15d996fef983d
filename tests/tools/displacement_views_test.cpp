// What stands beside a displaced scene on a validation sheet.
#include "sheets/surfaces/displacement_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "random_scenes.h"
#include "shapes.h"
#include "sheets/panels.h"

namespace {

constexpr double wide = 0.05;  // of heights

// Two waves along each side.
prep::ImageRef waves() {
    constexpr std::uint32_t side = 64;
    std::vector<float> heights;
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x) {
            const auto wave = [](std::uint32_t i) {
                return std::sin(4 * std::numbers::pi * (i + 0.5) / side);
            };
            heights.push_back(static_cast<float>(0.5 + 0.5 * wave(x) * wave(y)));
        }
    return test::float_picture(side, side, 1, heights);
}

// A square from 0 to 1 that faces +z; UVs are x and y.
prep::Scene square() {
    prep::Scene scene;
    prep::Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}});
    mesh.uvs.resize(1);
    mesh.uvs[0].values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.uvs[0].indices = mesh.corner_vertices;
    scene.meshes.push_back(std::move(mesh));
    scene.nodes.emplace_back();
    scene.nodes[0].mesh = 0;
    return scene;
}

// With a material whose displacement map it is.
prep::Scene square_with_material() {
    prep::Scene scene = square();
    scene.meshes[0].face_materials = {0};
    scene.images.push_back(waves());
    scene.textures.push_back({.image = 0});
    scene.materials.emplace_back();
    scene.materials[0].displacement_map.texture = 0;
    scene.materials[0].displacement_map.strength = 0.5f;
    scene.materials[0].displacement_scale = static_cast<float>(2 * wide);
    return scene;
}

prep::PrepareOptions options_with_map() {
    prep::PrepareOptions options;
    options.tessellate = true;
    options.tessellation.max_triangles = 4000;
    options.displacement.map = waves();
    options.displacement.heights.scale = wide;
    return options;
}

report::DisplacementViews views_of(const prep::Scene& scene, const prep::PrepareOptions& options,
                                   std::uint32_t pixels = 256) {
    const auto displaced = prep::prepare(scene, options);
    EXPECT_TRUE(displaced) << to_string(displaced.error());
    return report::make_displacement_views(scene, options, *displaced, pixels);
}

double height_of(const prep::PreparedScene& scene) {
    float least = 1, most = -1;
    for (const glm::vec3& p : scene.meshes[0].positions) {
        least = std::min(least, p.z);
        most = std::max(most, p.z);
    }
    return static_cast<double>(most) - static_cast<double>(least);
}

TEST(DisplacementViews, ShowTheSameHeightsAsBumpsAndInNormals) {
    const report::DisplacementViews views = views_of(square(), options_with_map());
    ASSERT_TRUE(views.bumped && views.coarse);
    EXPECT_EQ(height_of(*views.bumped), 0);
    for (const prep::VertexMesh::Range& range : views.bumped->meshes[0].ranges) {
        const prep::Material& m = views.bumped->scene.materials.at(range.material);
        ASSERT_TRUE(m.bump_map);
        EXPECT_FLOAT_EQ(m.bump_map.strength, static_cast<float>(wide));
    }
    EXPECT_GT(height_of(*views.coarse), wide / 2);
    EXPECT_LE(views.coarse->meshes[0].triangle_count(), 4000U / 32);
    ASSERT_EQ(views.coarse->residual_maps.size(), 1U);
    EXPECT_GT(views.coarse->residual_maps[0].mean_degrees, 1);
}

// A map with more texels than the picture shows is not baked.
TEST(DisplacementViews, BakeNoMoreTexelsThanThePictureShows) {
    for (const auto& [pixels, texels] : {std::pair{20U, 64U}, {100U, 128U}, {4000U, 1024U}}) {
        const report::DisplacementViews views = views_of(square(), options_with_map(), pixels);
        ASSERT_TRUE(views.coarse);
        ASSERT_EQ(views.coarse->residual_maps.size(), 1U);
        EXPECT_EQ(views.coarse->residual_maps[0].size, texels) << pixels;
    }
}

TEST(DisplacementViews, TakeMaterialsByTheirScales) {
    prep::PrepareOptions options = options_with_map();
    options.displacement.map.reset();
    options.displacement.from_materials = true;
    options.displacement.heights.scale = 3;
    const report::DisplacementViews views = views_of(square_with_material(), options);
    ASSERT_TRUE(views.bumped && views.coarse);
    EXPECT_EQ(height_of(*views.bumped), 0);
    const std::uint32_t m = views.bumped->meshes[0].ranges.at(0).material;
    EXPECT_FLOAT_EQ(views.bumped->scene.materials.at(m).bump_map.strength,
                    static_cast<float>(0.5 * 2 * wide * 3));
}

TEST(DisplacementViews, SayWhyThereAreNone) {
    prep::PrepareOptions options = options_with_map();
    options.displacement.noise = prep::NoiseOptions{.frequency = 3, .scale = wide};
    EXPECT_NE(views_of(square(), options).no_bumped.find("Noise"), std::string::npos);
    options = options_with_map();
    options.displacement.heights.channel = 1;
    const float pixel[] = {0, 1};
    options.displacement.map = test::float_picture(1, 1, 2, pixel);
    EXPECT_NE(views_of(square(), options).no_bumped.find("first channel"), std::string::npos);
    options = options_with_map();
    options.displacement.kind = prep::DisplacementKind::vector_object;
    const float vectors[] = {0, 0, 0.5f};
    options.displacement.map = test::float_picture(1, 1, 3, vectors);
    EXPECT_NE(views_of(square(), options).no_bumped.find("Vector"), std::string::npos);
    // Its own normal map stays.
    options = options_with_map();
    options.displacement.map.reset();
    options.displacement.from_materials = true;
    prep::Scene scene = square_with_material();
    scene.materials[0].normal_map.texture = 0;
    EXPECT_NE(views_of(scene, options).no_coarse.find("No residual"), std::string::npos);
    // A mesh that is left as it is.
    scene = square();
    scene.meshes[0].corner_vertices.clear();
    scene.meshes[0].face_offsets = {0};
    scene.meshes[0].uvs.clear();
    const report::DisplacementViews none = views_of(scene, options_with_map());
    EXPECT_FALSE(none.bumped || none.coarse);
    EXPECT_EQ(none.no_bumped, "No mesh was displaced.");
}

TEST(DisplacementViews, LeaveOutWhatCannotBePreparedAndWhatIsNoPartOfTheRelief) {
    prep::PrepareOptions options = options_with_map();
    options.request.tangents = prep::Request::Level::never;
    const report::DisplacementViews without = views_of(square(), options);
    EXPECT_TRUE(without.bumped);
    EXPECT_FALSE(without.coarse);
    EXPECT_NE(without.no_coarse.find("tangents"), std::string::npos) << without.no_coarse;
    // Two meshes: one has a bump map of its own, and so no residual map.
    prep::Scene scene = square_with_material();
    scene.materials.push_back(scene.materials[0]);
    scene.materials[1].bump_map.texture = 0;
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes[1].face_materials = {1};
    scene.nodes.push_back(scene.nodes[0]);
    scene.nodes[1].mesh = 1;
    const report::DisplacementViews mixed = views_of(scene, options_with_map());
    ASSERT_TRUE(mixed.coarse);
    const std::vector<prep::Material>& materials = mixed.coarse->scene.materials;
    EXPECT_TRUE(materials.at(0).normal_map);
    EXPECT_FALSE(materials.at(1).normal_map);
    EXPECT_FALSE(materials.at(1).bump_map);
}

const report::Panel* find(const report::PanelSet& set, const char* id) {
    const auto at = std::find_if(set.panels.begin(), set.panels.end(),
                                 [&](const report::Panel& panel) { return panel.id == id; });
    return at != set.panels.end() ? &*at : nullptr;
}

// Root mean square of what two pictures are apart, of 1.
double apart(const prep::Image& a, const prep::Image& b) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i + 3 < a.pixels.size(); i += 4) {
        if (a.pixels[i + 3] < 1 || b.pixels[i + 3] < 1) continue;
        const double d = static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]);
        sum += d * d;
        ++count;
    }
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
}

// Seen from the front, where outlines do not matter, all three look alike, and unlike a plane.
TEST(DisplacementViews, StandNextToWhatIsDisplaced) {
    const prep::Scene scene = square();
    const prep::PrepareOptions options = options_with_map();
    const auto displaced = prep::prepare(scene, options);
    ASSERT_TRUE(displaced);
    for (const bool alone : {false, true}) {
        report::Subject subject =
            alone ? report::mesh_subject(*displaced, 0) : report::whole_subject(*displaced, "it");
        subject.beside = views_of(scene, options);
        if (alone) subject.beside = report::views_of_mesh(*subject.beside, 0);
        report::PanelOptions drawn;
        drawn.size = 96;
        drawn.azimuth = 10;
        drawn.elevation = 10;
        drawn.prepare = options;
        const auto set = report::make_panels(std::move(subject), drawn);
        ASSERT_TRUE(set) << to_string(set.error());
        const report::Panel* const bumped = find(*set, "bump-mapped");
        const report::Panel* const residual = find(*set, "residual");
        const report::Panel* const triangles = find(*set, "displaced");
        ASSERT_TRUE(bumped != nullptr && residual != nullptr && triangles != nullptr);
        EXPECT_LT(apart(*bumped->picture, *triangles->picture), 0.02);
        EXPECT_LT(apart(*residual->picture, *triangles->picture), 0.02);
        // The plane alone.
        prep::PrepareOptions plain = options;
        plain.displacement = {};
        const auto flat = prep::prepare(scene, plain);
        ASSERT_TRUE(flat);
        const auto bare = report::make_panels(report::whole_subject(*flat, "it"), drawn);
        ASSERT_TRUE(bare);
        EXPECT_GT(apart(*find(*bare, "phong")->picture, *triangles->picture), 0.04);
        EXPECT_EQ(find(*bare, "bump-mapped"), nullptr);
    }
}

}  // namespace
