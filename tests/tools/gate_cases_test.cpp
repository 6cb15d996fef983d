// Small scenes that are hard to judge, each for one reason.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "judge/judgement.h"
#include "judge/material_looks.h"
#include "shapes.h"

namespace {

using judge::Limits;
using judge::Measured;
using prep::Mesh;
using prep::no_index;
using prep::Scene;

Mesh mesh_of(const std::vector<glm::vec3>& points,
             const std::vector<std::vector<std::uint32_t>>& faces) {
    Mesh mesh;
    mesh.positions = points;
    mesh.face_offsets = {0};
    for (const auto& face : faces) {
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), face.begin(), face.end());
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    return mesh;
}

Scene scene_of(Mesh mesh) {
    Scene scene;
    scene.meshes = {std::move(mesh)};
    prep::Node node;
    node.mesh = 0;
    scene.nodes = {node};
    return scene;
}

template <class T, class F>
prep::CornerLayer<T> layer_of(const Mesh& mesh, const F& value) {
    prep::CornerLayer<T> layer;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        layer.values.push_back(value(mesh.positions[mesh.corner_vertices[c]]));
        layer.indices.push_back(c);
    }
    return layer;
}

judge::Judgement judged(const Scene& a, const Scene& b, const judge::JudgeOptions& options = {}) {
    auto out = judge::judge(a, b, options);
    EXPECT_TRUE(out) << prep::to_string(out.error());
    return out ? *std::move(out) : judge::Judgement{};
}

const Measured& row(const judge::Judgement& judgement, const std::string& name) {
    for (const Measured& m : judgement.measured)
        if (m.row->name == name) return m;
    static const Measured none;
    ADD_FAILURE() << name;
    return none;
}

std::string beyond(const judge::Judgement& judgement) {
    std::string names;
    for (const Measured& m : judgement.measured)
        if (!m.within) names += std::string(m.row->name) + " ";
    return names;
}

bool noted(const judge::Judgement& judgement, const std::string& words) {
    for (const std::string& note : judgement.notes)
        if (note.find(words) != std::string::npos) return true;
    return false;
}

Mesh ball_with_normals() {
    Mesh mesh = shapes::icosphere(2);
    mesh.normals = layer_of<glm::vec3>(mesh, [](const glm::vec3& p) { return glm::normalize(p); });
    return mesh;
}

// Positions that moved within their limit are no cause of a normal that turned.
TEST(GateCases, WhatIsWithinItsLimitIsNoCause) {
    const Scene a = scene_of(ball_with_normals());
    Scene b = a;
    for (glm::vec3& p : b.meshes[0].positions) p = glm::round(p * 1e5f) / 1e5f;
    glm::vec3& n = b.meshes[0].normals.values[7];
    const glm::vec3 side = glm::normalize(glm::cross(n, glm::vec3(0.3f, 0.5f, -0.8f)));
    n = std::cos(0.5f) * n + std::sin(0.5f) * side;
    const judge::Judgement found = judged(a, b);
    EXPECT_GT(row(found, "positions").value, 0);
    EXPECT_EQ(beyond(found), "normals ");
    EXPECT_EQ(row(found, "normals").follows, "");
    // Not judged at all, they are none either.
    for (glm::vec3& p : b.meshes[0].positions) p *= 1.01f;
    judge::JudgeOptions options;
    options.limits.positions = {};
    options.limits.silhouettes = {};
    EXPECT_EQ(row(judged(a, b, options), "normals").follows, "");
    EXPECT_EQ(row(judged(a, b, options), "distance").follows, "");
    EXPECT_EQ(row(judged(a, b), "normals").follows, "positions");
}

// A search that has to end leaves two bounds; a limit between them is not shown to hold.
TEST(GateCases, OfTwoBoundsTheUpperOneDecides) {
    const Scene a = scene_of(shapes::icosphere(2)), b = scene_of(shapes::icosphere(3));
    judge::JudgeOptions options;
    options.limits.faces = options.limits.silhouettes = {};
    options.limits.distance = 0;
    options.most_pieces = 1;
    const Measured wide = row(judged(a, b, options), "distance");
    ASSERT_TRUE(wide.high.has_value());
    ASSERT_LT(wide.value, *wide.high);
    options.limits.distance = 0.5 * (wide.value + *wide.high);
    const judge::Judgement cut_short = judged(a, b, options);
    EXPECT_FALSE(row(cut_short, "distance").within);
    EXPECT_TRUE(noted(cut_short, "the search for the distance from the first file ended after"));
    EXPECT_FALSE(cut_short.within());
    options.most_pieces = 2'000'000;
    const Measured found = row(judged(a, b, options), "distance");
    EXPECT_EQ(found.within, found.high.value_or(found.value) <= *options.limits.distance);
    EXPECT_FALSE(noted(judged(a, b, options), "ended after"));
}

// The same corners, begun at another one: of a saddle the other diagonal, which is half as high.
TEST(GateCases, PolygonsThatAreCutDifferentlyAreApart) {
    const float h = 0.2f;
    const std::vector<glm::vec3> saddle = {{0, 0, 0}, {1, 0, h}, {1, 1, 0}, {0, 1, h}};
    const Scene a = scene_of(mesh_of(saddle, {{0, 1, 2, 3}})),
                b = scene_of(mesh_of(saddle, {{1, 2, 3, 0}}));
    judge::JudgeOptions options;
    options.limits.silhouettes = {};
    const judge::Judgement found = judged(a, b, options);
    EXPECT_EQ(beyond(found), "distance ");
    EXPECT_EQ(row(found, "positions").value, 0);
    const Measured& distance = row(found, "distance");
    EXPECT_FALSE(distance.proved);
    // From (0.5, 0.5, 0) to the plane z = h (x + y).
    EXPECT_NEAR(distance.value * found.diagonal, h / std::sqrt(1 + 2 * h * h), 1e-6);
    EXPECT_EQ(beyond(judged(a, a, options)), "");
}

// A plane of squares, each begun at another corner, is cut along other diagonals and is the same.
TEST(GateCases, SquaresBegunElsewhereAreTheSame) {
    std::vector<glm::vec3> points;
    std::vector<std::vector<std::uint32_t>> faces, begun;
    for (int y = 0; y <= 20; ++y)
        for (int x = 0; x <= 20; ++x) points.push_back(glm::vec3(x, y, 0.25f * float(x)));
    for (std::uint32_t y = 0; y < 20; ++y)
        for (std::uint32_t x = 0; x < 20; ++x) {
            const std::uint32_t c[4] = {21 * y + x, 21 * y + x + 1, 21 * y + x + 22,
                                        21 * y + x + 21};
            faces.push_back({c[0], c[1], c[2], c[3]});
            const std::uint32_t k = (x + 3 * y) % 4;
            begun.push_back({c[k], c[(k + 1) % 4], c[(k + 2) % 4], c[(k + 3) % 4]});
        }
    // A hexagon, cut alike or not.
    const auto first = std::uint32_t(points.size());
    for (int k = 0; k < 6; ++k)
        points.push_back(
            glm::vec3(30 + std::cos(k + 0.1 * k * k), 5 + std::sin(k + 0.1 * k * k), 0));
    faces.push_back({first, first + 1, first + 2, first + 3, first + 4, first + 5});
    begun.push_back({first + 2, first + 3, first + 4, first + 5, first, first + 1});
    judge::JudgeOptions options;
    options.limits.distance = options.limits.positions = 0;
    const judge::Judgement found =
        judged(scene_of(mesh_of(points, faces)), scene_of(mesh_of(points, begun)), options);
    EXPECT_EQ(beyond(found), "");
    EXPECT_EQ(row(found, "distance").value, 0);
}

TEST(GateCases, LastBitsAreNoneOfALimitOf0) {
    const Scene a = scene_of(shapes::icosphere(2));
    Scene b = a;
    for (glm::vec3& p : b.meshes[0].positions) p.x = std::nextafter(p.x, INFINITY);
    judge::JudgeOptions options;
    options.limits.distance = options.limits.positions = options.limits.silhouettes = 0;
    const judge::Judgement found = judged(a, b, options);
    EXPECT_EQ(beyond(found), "");
    EXPECT_EQ(row(found, "distance").value, 0);
}

// What stands far away has coarse floats; what stands near has its own.
TEST(GateCases, LastBitsAreThoseOfThePlace) {
    Mesh mesh = shapes::icosphere(1);
    const Mesh far = mesh;
    const auto first = std::uint32_t(mesh.positions.size());
    for (std::uint32_t c = 0; c < far.corner_count(); ++c) {
        mesh.corner_vertices.push_back(far.corner_vertices[c] + first);
        if (c % 3 == 2) mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    for (const glm::vec3& p : far.positions) mesh.positions.push_back(1e4f * p + 1e6f);
    const Scene a = scene_of(mesh);
    Scene b = a;
    b.meshes[0].positions[0] += glm::vec3(0.01f);  // a last bit of the far one is 0.06
    const double moved = row(judged(a, b), "positions").value * judged(a, b).diagonal;
    EXPECT_NEAR(moved, 0.01 * std::sqrt(3.0), 1e-5);
}

// Where a last bit is a part of the mesh that a limit would hold, it is no excuse.
TEST(GateCases, WhatMovesFarFromTheOriginIsSeen) {
    Mesh mesh = shapes::icosphere(1);
    for (glm::vec3& p : mesh.positions) p = p * 20.0f + glm::vec3(5e5f, 0, 4.6e6f);
    const Scene a = scene_of(mesh);
    for (const float step : {0.5f, 1.0f}) {  // one last bit and two
        Scene b = a;
        b.meshes[0].positions[3].z += step;
        const judge::Judgement found = judged(a, b);
        EXPECT_FALSE(found.within());
        EXPECT_NEAR(row(found, "positions").value * found.diagonal, step, 1e-9);
        EXPECT_GT(row(found, "distance").value, 0);
    }
    EXPECT_TRUE(judged(a, a).within());
}

TEST(GateCases, FacesAboutOneMiddleFindTheirPartners) {
    // 12,000 needles through one point, and 12,000 triangles in one place.
    std::vector<glm::vec3> points = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    std::vector<std::vector<std::uint32_t>> faces;
    for (int k = 0; k < 12000; ++k) {
        const double angle = 3.14159 * k / 12000;
        const glm::vec3 p(std::cos(angle), std::sin(angle), 0);
        const auto at = std::uint32_t(points.size());
        points.insert(points.end(), {p, -p, 0.5f * p});
        faces.push_back({at, at + 1, at + 2});
        faces.push_back({0, 1, 2});
    }
    Mesh mesh = mesh_of(points, faces);
    mesh.uvs.push_back(layer_of<glm::vec2>(mesh, [](const glm::vec3& p) { return glm::vec2(p); }));
    mesh.uvs[0].values[3] = glm::vec2(NAN, 0);  // the first of those in one place
    judge::JudgeOptions options;
    options.limits.distance = options.limits.silhouettes = {};
    const Scene a = scene_of(mesh);
    std::reverse(faces.begin(), faces.end());
    Scene b = scene_of(mesh_of(points, faces));
    const judge::Judgement same = judged(a, a, options);
    EXPECT_EQ(beyond(same), "");
    EXPECT_FALSE(noted(same, "ended early"));
    Scene bare = a;
    bare.meshes[0].uvs.clear();
    b.meshes[0].name = "another name";
    EXPECT_EQ(beyond(judged(bare, b, options)), "");
}

TEST(GateCases, AFaceWithoutAreaHasNoSide) {
    const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {0, 1, 0}};
    const Scene a = scene_of(mesh_of(points, {{0, 1, 3}, {0, 1, 2}})),
                b = scene_of(mesh_of(points, {{0, 1, 3}, {0, 2, 1}})),
                c = scene_of(mesh_of(points, {{0, 3, 1}, {0, 1, 2}}));
    EXPECT_EQ(beyond(judged(a, b)), "");
    EXPECT_EQ(row(judged(a, c), "faces").value, 1);
}

// Two triangles in one place, told apart by how they look or by their second UV set alone.
TEST(GateCases, FacesInOnePlaceAreToldApartByWhatTheyAre) {
    const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    Scene a = scene_of(mesh_of(points, {{0, 1, 2}, {0, 1, 2}}));
    a.materials.resize(2);
    a.materials[0].name = "x";
    a.materials[1].name = "y";
    a.materials[0].diffuse = glm::vec4(1, 0, 0, 1);
    a.materials[1].diffuse = glm::vec4(0, 0, 1, 1);
    a.meshes[0].face_materials = {0, 1};
    Scene b = a;
    std::swap(b.materials[0].diffuse, b.materials[1].diffuse);  // what names say is now wrong
    b.meshes[0].face_materials = {1, 0};
    EXPECT_EQ(beyond(judged(a, b)), "");
    a.materials.clear();
    a.meshes[0].face_materials.clear();
    for (int set = 0; set < 2; ++set)
        a.meshes[0].uvs.push_back(
            layer_of<glm::vec2>(a.meshes[0], [](const glm::vec3& p) { return glm::vec2(p); }));
    for (std::size_t c = 0; c < 3; ++c) a.meshes[0].uvs[1].values[c] += glm::vec2(0.5f);
    b = a;
    std::rotate(b.meshes[0].uvs[1].indices.begin(), b.meshes[0].uvs[1].indices.begin() + 3,
                b.meshes[0].uvs[1].indices.end());
    EXPECT_EQ(beyond(judged(a, b)), "");
    b.meshes[0].uvs[1].values[4].x += 0.25f;
    EXPECT_EQ(beyond(judged(a, b)), "uvs ");
}

// Two faces in one place whose normals are opposite, moved unequally, as by rounding to two grids:
// each finds its own, though the other's is nearer.
TEST(GateCases, FacesBackToBackKeepTheirNormals) {
    const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                           {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    Mesh mesh = mesh_of(points, {{0, 1, 2}, {3, 4, 5}});
    mesh.normals.values = {{0, 0, 1}, {0, 0, -1}};
    mesh.normals.indices = {0, 0, 0, 1, 1, 1};
    Mesh moved = mesh;
    for (std::size_t v = 0; v < 6; ++v) moved.positions[v].x += v < 3 ? 1e-4f : 5e-5f;
    const judge::Judgement found = judged(scene_of(mesh), scene_of(moved));
    EXPECT_EQ(row(found, "normals").value, 0);
    EXPECT_NEAR(row(found, "positions").value * found.diagonal, 1e-4, 1e-7);
    // One that is turned away alone is found all the same.
    Mesh turned = mesh_of({points[0], points[1], points[2]}, {{0, 1, 2}}), other = turned;
    turned.normals.values = {{0, 0, 1}};
    other.normals.values = {{0, 0, -1}};
    turned.normals.indices = other.normals.indices = {0, 0, 0};
    EXPECT_EQ(row(judged(scene_of(turned), scene_of(other)), "normals").value, 180);
}

// --- Materials

judge::MaterialLooks looks_of(const Scene& a, const Scene& b) {
    return {a, b};
}

TEST(GateCases, EachNumberOfAMaterialIsALook) {
    Scene plain;
    prep::Material m;
    m.metallic_roughness = true;
    m.sheen = glm::vec3(0.5f);
    m.anisotropy = 0.5f;
    m.normal_map.texture = m.displacement_map.texture = m.diffuse_map.texture = 0;
    plain.materials = {m};
    plain.textures.resize(1);
    const std::vector<void (*)(Scene&)> changes = {
        [](Scene& s) { s.materials[0].normal_map_space = prep::NormalMapSpace::object; },
        [](Scene& s) { s.materials[0].displacement_scale = 1.01f; },
        [](Scene& s) { s.materials[0].displacement_midlevel = 0.49f; },
        [](Scene& s) { s.materials[0].displacement_kind = prep::DisplacementKind::vector_tangent; },
        [](Scene& s) { s.materials[0].sheen_roughness = 0.1f; },
        [](Scene& s) { s.materials[0].anisotropy_rotation = 0.1f; },
        [](Scene& s) { s.textures[0].mag = prep::Filter::nearest; },
        [](Scene& s) { s.textures[0].min = prep::Filter::nearest; },
        [](Scene& s) { s.textures[0].mip = prep::MipFilter::none; },
        // Of a picture of 4096 texels four of them, of a dark linear colour three levels.
        [](Scene& s) { s.materials[0].diffuse_map.offset.x = 0.001f; },
        [](Scene& s) { s.materials[0].diffuse_map.rotation = 0.001f; },
        [](Scene& s) { s.materials[0].diffuse.x += 0.001f; },
    };
    for (std::size_t k = 0; k < changes.size(); ++k) {
        Scene changed = plain;
        changes[k](changed);
        auto looks = looks_of(plain, changed);
        EXPECT_FALSE(looks.differences(0, 0).empty()) << k;
    }
    Scene last = plain;
    last.materials[0].diffuse.x = std::nextafter(last.materials[0].diffuse.x, 2.0f);
    auto same = looks_of(plain, last);
    EXPECT_TRUE(same.differences(0, 0).empty());
}

TEST(GateCases, APictureWithoutAlphaIsOpaque) {
    Scene scenes[3];
    for (int k = 0; k < 3; ++k) {  // red green blue; the same with an alpha of 1; of 0.5
        prep::Image picture{2, 2, k == 0 ? 3u : 4u, {}, true};
        for (int p = 0; p < 4; ++p) {
            for (int c = 0; c < 3; ++c) picture.pixels.push_back(float(51 * c) / 255.0f);
            if (k > 0) picture.pixels.push_back(k == 1 ? 1.0f : 0.5f);
        }
        prep::ImageRef image;
        image.bytes = *prep::encode_png(picture);
        scenes[k].images = {image};
        scenes[k].textures.resize(1);
        scenes[k].textures[0].image = 0;
        scenes[k].materials.resize(1);
        scenes[k].materials[0].diffuse_map.texture = 0;
    }
    EXPECT_TRUE(looks_of(scenes[0], scenes[1]).differences(0, 0).empty());
    EXPECT_TRUE(looks_of(scenes[1], scenes[0]).differences(0, 0).empty());
    EXPECT_FALSE(looks_of(scenes[0], scenes[2]).differences(0, 0).empty());
    Scene nan;
    nan.materials.resize(1);
    nan.materials[0].diffuse.y = NAN;
    EXPECT_TRUE(looks_of(nan, nan).differences(0, 0).empty());
    EXPECT_FALSE(looks_of(nan, scenes[0]).differences(0, 0).empty());
}

// --- Skins, and what one file alone has

// A triangle on two joints, at x = ±1, which pose it as it stands.
Scene skinned() {
    Scene scene = scene_of(mesh_of({{0, 0, 0}, {3, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}));
    prep::Skin skin;
    for (int j = 0; j < 2; ++j) {
        prep::Node joint;
        joint.transform[3] = glm::dvec4(2.0 * j - 1, 0, 0, 1);
        scene.nodes.push_back(joint);
        skin.joints.push_back(std::uint32_t(scene.nodes.size() - 1));
        glm::mat4 inverse(1.0f);
        inverse[3] = glm::vec4(1 - 2 * j, 0, 0, 1);
        skin.inverse_bind.push_back(inverse);
    }
    scene.skins = {skin};
    scene.nodes[0].skin = 0;
    prep::SkinInfluences set;
    set.joints.assign(3, {0, 1, 0, 0});
    set.weights.assign(3, glm::vec4(0.5f, 0.5f, 0, 0));
    scene.meshes[0].skin_influences = {set};
    return scene;
}

TEST(GateCases, SkinsAreWeightsJointsAndPoses) {
    const Scene a = skinned();
    EXPECT_EQ(beyond(judged(a, a)), "");
    Scene b = a;  // a quarter of the weight, over a way of 2; the diagonal is 5
    b.meshes[0].skin_influences[0].weights[1] = glm::vec4(0.25f, 0.75f, 0, 0);
    EXPECT_EQ(beyond(judged(a, b)), "skins ");
    EXPECT_NEAR(row(judged(a, b), "skins").value, 0.25 * 2 / 5, 1e-6);
    b = a;  // half of the weight, by another inverse bind matrix
    b.skins[0].inverse_bind[1][3].y += 0.5f;
    EXPECT_EQ(beyond(judged(a, b)), "skins ");
    EXPECT_NEAR(row(judged(a, b), "skins").value, 0.5 * 0.5 / 5, 1e-6);
    b = a;  // of the corner at 0, by joints at ±1, both sums stay 0
    b.meshes[0].skin_influences[0].weights[0] = glm::vec4(0.25f, 0.25f, 0, 0);
    EXPECT_EQ(beyond(judged(a, b)), "skins ");
    EXPECT_NEAR(row(judged(a, b), "skins").value, 0.5, 1e-6);
    // All under a node that doubles: ways double with the diagonal only where they are the world's.
    Scene big = a, moved = a;
    moved.meshes[0].skin_influences[0].weights[1] = glm::vec4(0.25f, 0.75f, 0, 0);
    for (Scene* scene : {&big, &moved}) {
        prep::Node root;
        root.transform = glm::dmat4(2.0);
        root.transform[3] = glm::dvec4(0, 0, 0, 1);
        scene->nodes.push_back(root);
        for (std::size_t n = 0; n < 3; ++n) scene->nodes[n].parent = 3;
    }
    EXPECT_NEAR(row(judged(big, moved), "skins").value, 0.25 * 2 / 5, 1e-6);
}

TEST(GateCases, MorphTargetsHaveWeightsAtRest) {
    Scene a = scene_of(shapes::icosphere(1));
    prep::MorphTarget target;
    target.positions = {
        {0, std::make_shared<const std::vector<glm::vec3>>(2, glm::vec3(0, 0.1f, 0))}};
    a.meshes[0].morph_targets = {target};
    Scene b = a;
    EXPECT_EQ(beyond(judged(a, b)), "");
    b.meshes[0].morph_targets[0].weight = 0.5f;
    EXPECT_EQ(beyond(judged(a, b)), "morphs ");
    EXPECT_EQ(row(judged(a, b), "morphs").value, 0.5);
}

TEST(GateCases, WhatTheSecondFileAloneHasIsCounted) {
    const Scene rich = skinned();
    Scene bare = rich;
    bare.meshes[0].skin_influences.clear();
    Scene all = rich;
    Mesh& mesh = all.meshes[0];
    mesh.normals = layer_of<glm::vec3>(mesh, [](const glm::vec3&) { return glm::vec3(0, 0, 1); });
    mesh.uvs.push_back(layer_of<glm::vec2>(mesh, [](const glm::vec3& p) { return glm::vec2(p); }));
    mesh.colors.push_back(layer_of<glm::vec4>(mesh, [](const glm::vec3&) { return glm::vec4(1); }));
    mesh.morph_targets.resize(1);
    all.animations.resize(2);
    const judge::Judgement found = judged(bare, all);
    EXPECT_EQ(beyond(found), "");
    EXPECT_EQ(row(found, "lost").value, 0);
    EXPECT_EQ(row(found, "added").value, 6);  // normals, UVs, colours, skin, morph, animations
    judge::JudgeOptions options;
    options.limits.added = 5;
    EXPECT_EQ(beyond(judged(bare, all, options)), "added ");
    const judge::Judgement back = judged(all, bare);
    EXPECT_EQ(row(back, "lost").value, 6);
    EXPECT_EQ(row(back, "added").value, 0);
    // Of named meshes alone, what belongs to no mesh is not asked for.
    all.meshes[0].name = bare.meshes[0].name = "part";
    options.meshes = {"part"};
    EXPECT_EQ(row(judged(all, bare, options), "lost").value, 5);
}

// --- Numbers that are none, and too many

TEST(GateCases, SignsThatAreNoneAreNoSigns) {
    Mesh mesh = shapes::icosphere(1);
    mesh.tangents =
        layer_of<glm::vec4>(mesh, [](const glm::vec3&) { return glm::vec4(1, 0, 0, 1); });
    const Scene a = scene_of(mesh);
    for (const float none : {0.0f, NAN}) {
        Scene b = a;
        b.meshes[0].tangents.values[5].w = none;
        EXPECT_EQ(beyond(judged(a, b)), "tangent_signs ");
        EXPECT_EQ(row(judged(a, b), "tangent_signs").value, 1);
        EXPECT_EQ(beyond(judged(b, b)), "");
    }
}

TEST(GateCases, FacesThatAreNowhereAreTold) {
    const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}};
    const Scene a = scene_of(mesh_of(points, {{0, 1, 2}, {0, 1, 3}})),
                b = scene_of(mesh_of(points, {{0, 1, 2}}));
    EXPECT_EQ(beyond(judged(a, a)), "");
    EXPECT_TRUE(noted(judged(a, a), "not finite: 1 and 1; only their number is compared"));
    EXPECT_EQ(row(judged(a, b), "faces").value, 1);
    Scene named = scene_of(mesh_of({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}, {{0, 1, 2}}));
    named.meshes[0].name = "hub";
    judge::JudgeOptions options;
    options.limits.silhouettes = options.limits.distance = {};
    const judge::Judgement found = judged(b, named, options);
    bool told = false;
    for (const judge::Finding& f : row(found, "faces").findings)
        told |= f.text.find("its mesh 'hub', face 0") != std::string::npos;
    EXPECT_TRUE(told);
}

TEST(GateCases, CornersUnderAllNodesHaveALimit) {
    Scene scene = scene_of(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}));
    Mesh& mesh = scene.meshes[0];
    for (std::uint32_t f = 1; f <= 10000; ++f) {
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), {0, 1, 2});
        mesh.face_offsets.push_back(3 * f);
    }
    scene.nodes.resize(10000, scene.nodes[0]);
    const auto refused = judge::judge(scene, scene);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, prep::ErrorCode::limit);
}

// A mesh that no node shows is not drawn: it is in neither file's comparison, but where no file
// shows any.
TEST(GateCases, MeshesThatNoNodeShowsAreNotThere) {
    const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    Scene both = scene_of(mesh_of(points, {{0, 1, 2}}));
    both.meshes.push_back(
        mesh_of({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}, {{0, 1, 2}, {1, 3, 2}}));
    both.nodes.push_back(both.nodes[0]);
    both.nodes[1].mesh = 1;
    Scene one = both;
    one.nodes.pop_back();
    EXPECT_EQ(beyond(judged(one, one)), "");
    EXPECT_EQ(row(judged(both, one), "faces").value, 2);
    EXPECT_EQ(row(judged(one, both), "faces").value, 2);
    EXPECT_TRUE(noted(judged(both, one),
                      "1 mesh of the second file that its scene does not show was not compared"));
    // A gate for the mesh that neither shows is about that mesh.
    judge::JudgeOptions scoped;
    scoped.meshes = {"spare"};
    Scene left = one, right = one;
    left.meshes[1].name = right.meshes[1].name = "spare";
    EXPECT_EQ(beyond(judged(left, right, scoped)), "");
    right.meshes[1].positions[3].z = 2;
    EXPECT_NE(beyond(judged(left, right, scoped)), "");
    EXPECT_EQ(beyond(judged(left, right)), "");
    Scene none = both;
    none.nodes.clear();
    EXPECT_EQ(row(judged(both, none), "faces").value, 3);
    EXPECT_EQ(beyond(judged(none, none)), "");
    Scene other = none;
    other.meshes[1].positions[3].z = 2;
    EXPECT_NE(beyond(judged(none, other)), "");
}

// Normals under a node without thickness are those that its plane leaves: of the cofactors, so that
// they are the side that the corners run around.
TEST(GateCases, NormalsUnderFlatNodesAreThoseOfTheirPlane) {
    const std::vector<glm::vec3> points = {{0, 0, 0}, {0, 0, 1}, {1, 0.5F, 0}, {1, 0.5F, 1}};
    for (const double flip : {1.0, -1.0}) {
        Mesh mesh = mesh_of(points, {{0, 1, 2}, {1, 3, 2}});
        const glm::vec3 slope = glm::normalize(glm::vec3(-0.5F, 1, 0));
        mesh.normals = layer_of<glm::vec3>(mesh, [&](const glm::vec3&) { return slope; });
        Scene flat = scene_of(mesh);
        flat.nodes[0].transform[0][0] = flip;
        flat.nodes[0].transform[1][1] = 0;
        // What it comes to, without a node: the plane y = 0, seen as before.
        for (glm::vec3& p : mesh.positions) p = {float(flip) * p.x, 0, p.z};
        mesh.normals = layer_of<glm::vec3>(
            mesh, [&](const glm::vec3&) { return glm::vec3(0, float(flip), 0); });
        const Scene plane = scene_of(mesh);
        EXPECT_LT(row(judged(flat, plane), "normals").value, 1e-4) << flip;
    }
    // A mirror with thickness turns winding and normals.
    Mesh slope = mesh_of(points, {{0, 1, 2}, {1, 3, 2}});
    slope.normals = layer_of<glm::vec3>(
        slope, [](const glm::vec3&) { return glm::normalize(glm::vec3(-0.5F, 1, 0)); });
    Scene mirrored = scene_of(slope);
    mirrored.nodes[0].transform[0][0] = -1;
    for (glm::vec3& p : slope.positions) p.x = -p.x;
    for (std::size_t f = 0; f < 2; ++f)
        std::swap(slope.corner_vertices[3 * f + 1], slope.corner_vertices[3 * f + 2]);
    slope.normals = layer_of<glm::vec3>(
        slope, [](const glm::vec3&) { return glm::normalize(glm::vec3(0.5F, 1, 0)); });
    EXPECT_LT(row(judged(mirrored, scene_of(slope)), "normals").value, 1e-4);
    // Where the node leaves none, the mesh's own are meant, as files without nodes have them.
    Mesh wall = mesh_of(points, {{0, 1, 2}, {1, 3, 2}});
    wall.normals = layer_of<glm::vec3>(wall, [](const glm::vec3&) { return glm::vec3(0, 0, 1); });
    Scene flat = scene_of(wall);
    flat.nodes[0].transform[1][1] = 0;
    for (glm::vec3& p : wall.positions) p.y = 0;
    EXPECT_LT(row(judged(flat, scene_of(wall)), "normals").value, 1e-4);
}

}  // namespace
