// Scenes as bytes: every member arrives with every bit, and bytes that are no scene are errors.
#include "contained/scene_bytes.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>

#include "contained/member_count.h"
#include "invariants.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "shared_data.h"

namespace {

using prep::Scene;
using prep::detail::scene_bytes;
using prep::detail::scene_of_bytes;

// Something in every member, and no two alike where that can be.
Scene full_scene() {
    Scene s;
    s.name = "scene";
    s.source = "a/b.fbx";
    s.libraries = {"a/b.md5anim", "c"};
    s.library_missing = true;
    prep::Mesh& m = s.meshes.emplace_back();
    m.name = "mesh";
    m.origin = {1e6, -2e6, 0.1};
    m.positions = {{0, 0, 0}, {1, -0.0f, 0}, {1, 1, 0}, {std::nanf("7"), 1, 1e-42f}};
    m.file_vertices = {3, 2, 1, 0};
    m.face_offsets = {0, 4, 7};
    m.corner_vertices = {0, 1, 2, 3, 0, 2, 3};
    m.corner_file_vertices = {4, 3, 2, 1, 0, 0, 1};
    m.normals = {{{0, 0, 1}, {0, 1, 0}}, {0, 1, 0, 1, 0, 1, prep::no_index}};
    m.tangents = {{{1, 0, 0, -1}}, {0, 0, 0, 0, 0, 0, 0}};
    m.uvs = {{{{0.25f, 0.5f}}, {0, 0, 0, 0, 0, 0, 0}}, {{{0.125f, 1}}, {0, 0, 0, 0, 0, 0, 0}}};
    m.colors = {{{{1, 2, 3, 4}}, {0, 0, 0, 0, 0, 0, 0}}};
    m.face_materials = {0, prep::no_index};
    m.variant_materials = {0};
    m.face_smoothing = {6, 7};
    m.smoothing_kind = prep::SmoothingKind::bit_mask;
    m.face_parts = {1, 0};
    m.parts = {"p", "q"};
    const auto deltas = std::make_shared<const std::vector<glm::vec3>>(2, glm::vec3(1, 2, 3));
    m.morph_targets = {{{{0, deltas}, {3, deltas}}, {{1, deltas}}, {}}, {{{0, deltas}}, {}, {}}};
    m.skin_influences = {{{5, {1, 2, 3, 4}}, {5, glm::vec4(0.5f)}}};
    m.vertex_attributes = {{"_HEAT", 2, std::vector<float>(10, 1.5f)}, {"_NONE", 1, {}}};
    m.indexed_by_vertex = true;
    m.tied_to_file = true;
    m.hard_marks = {{0, 3}};
    m.subdivision = {{{0, 1, 2.5f}}, {{3, 1.5f}}, {1}, 2, 3};
    m.line_offsets = {0, 2};
    m.line_vertices = {1, 3};
    m.points = {2};
    m.vertex_colors = {glm::vec4(1), glm::vec4(2), glm::vec4(3), glm::vec4(4)};
    m.loose_parts_with_attributes = 9;
    prep::Node node;
    node.name = "node";
    node.transform = glm::dmat4(2);
    node.trs = prep::Trs{{1, 2, 3}, glm::dquat(0.5, 0.5, -0.5, 0.5), {4, 5, 6}};
    node.mesh = node.camera = node.light = node.skin = 0;
    s.nodes = {node, {}};
    s.nodes[1].parent = 0;
    prep::Material& material = s.materials.emplace_back();
    material.name = "stone";
    material.ambient = {1, 2, 3};
    material.diffuse = {4, 5, 6, 7};
    material.specular = {8, 9, 10};
    material.shininess = 11;
    material.emissive = {12, 13, 14};
    float number = 15;
    for (const prep::MaterialMap& map : prep::material_maps)
        material.*map.ref = {0, std::uint32_t(number), {number, 2}, {3, number}, 4, number++};
    material.normal_map_space = prep::NormalMapSpace::object;
    material.normal_map_flip_green = material.unlit = material.metallic_roughness = true;
    material.metallic = 0.25f;
    material.roughness = 0.75f;
    material.alpha_mode = prep::AlphaMode::blend;
    material.alpha_cutoff = 0.375f;
    material.double_sided = true;
    s.textures = {{0, prep::Wrap::mirror, prep::Wrap::border, prep::Filter::nearest,
                   prep::Filter::nearest, prep::MipFilter::none}};
    s.images = {{"i", "textures/i.png", {std::byte(0), std::byte(255)}, "b/j.png", "image/png"}};
    s.passed_over = {"a/i.png"};
    s.lights = {{"lamp", prep::LightKind::spot, {1, 2, 3}, 4, 5, 6, 7}};
    s.cameras = {{"eye", false, 1, 2, 3, 4, 5, 6}};
    s.skins = {{"skin", {1, 0}, {glm::mat4(3), glm::mat4(4)}}};
    prep::Animation& animation = s.animations.emplace_back();
    animation.name = "walk";
    const auto times = std::make_shared<const std::vector<float>>(std::vector<float>{0, 0.5f});
    const auto values = std::make_shared<const std::vector<float>>(18, 2.0f);
    animation.samplers = {{prep::Interpolation::cubic_spline, times, values},
                          {prep::Interpolation::step, times, times},
                          {prep::Interpolation::linear, nullptr, nullptr}};
    animation.channels = {{0, 1, prep::AnimationPath::scale},
                          {1, 0, prep::AnimationPath::weights},
                          {2, prep::no_index, prep::AnimationPath::other}};
    s.active_camera = 0;
    s.source_bytes = std::uint64_t(1) << 40;
    s.warnings = {"w", ""};
    return s;
}

// The bits of what is no comparison's: NaN and −0.
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}
template <class T>
bool same_layer(const prep::CornerLayer<T>& a, const prep::CornerLayer<T>& b) {
    return same_bits(a.values, b.values) && a.indices == b.indices;
}

TEST(SceneBytes, EveryMemberArrives) {
    const Scene from = full_scene();
    ASSERT_EQ(test::broken_promise(from), "");
    const auto result = scene_of_bytes(scene_bytes(from));
    ASSERT_TRUE(result.has_value()) << result.error().text;
    const Scene& to = *result;
    EXPECT_EQ(to.name, from.name);
    EXPECT_EQ(to.source, from.source);
    EXPECT_EQ(to.libraries, from.libraries);
    EXPECT_EQ(to.library_missing, from.library_missing);
    ASSERT_EQ(to.meshes.size(), 1u);
    const prep::Mesh &a = from.meshes[0], &b = to.meshes[0];
    EXPECT_EQ(b.name, a.name);
    EXPECT_EQ(b.origin, a.origin);
    EXPECT_TRUE(same_bits(b.positions, a.positions));
    EXPECT_EQ(b.file_vertices, a.file_vertices);
    EXPECT_EQ(b.face_offsets, a.face_offsets);
    EXPECT_EQ(b.corner_vertices, a.corner_vertices);
    EXPECT_EQ(b.corner_file_vertices, a.corner_file_vertices);
    EXPECT_TRUE(same_layer(b.normals, a.normals) && same_layer(b.tangents, a.tangents));
    ASSERT_EQ(b.uvs.size(), 2u);
    EXPECT_TRUE(same_layer(b.uvs[0], a.uvs[0]) && same_layer(b.uvs[1], a.uvs[1]));
    ASSERT_EQ(b.colors.size(), 1u);
    EXPECT_TRUE(same_layer(b.colors[0], a.colors[0]));
    EXPECT_EQ(b.face_materials, a.face_materials);
    EXPECT_EQ(b.variant_materials, a.variant_materials);
    EXPECT_EQ(b.face_smoothing, a.face_smoothing);
    EXPECT_EQ(b.smoothing_kind, a.smoothing_kind);
    EXPECT_EQ(b.face_parts, a.face_parts);
    EXPECT_EQ(b.parts, a.parts);
    ASSERT_EQ(b.morph_targets.size(), 2u);
    ASSERT_EQ(b.morph_targets[0].positions.size(), 2u);
    EXPECT_EQ(b.morph_targets[0].positions[1].first_vertex, 3u);
    EXPECT_EQ(*b.morph_targets[0].positions[1].values, *a.morph_targets[0].positions[1].values);
    EXPECT_EQ(b.morph_targets[0].normals.size(), 1u);
    EXPECT_TRUE(b.morph_targets[0].tangents.empty());
    ASSERT_EQ(b.skin_influences.size(), 1u);
    EXPECT_EQ(b.skin_influences[0].joints, a.skin_influences[0].joints);
    EXPECT_EQ(b.skin_influences[0].weights, a.skin_influences[0].weights);
    ASSERT_EQ(b.vertex_attributes.size(), 2u);
    EXPECT_EQ(b.vertex_attributes[0].name, "_HEAT");
    EXPECT_EQ(b.vertex_attributes[0].width, 2u);
    EXPECT_EQ(b.vertex_attributes[0].values, a.vertex_attributes[0].values);
    EXPECT_TRUE(b.indexed_by_vertex && b.tied_to_file);
    EXPECT_EQ(b.hard_marks, a.hard_marks);
    EXPECT_EQ(b.subdivision, a.subdivision);
    EXPECT_EQ(b.line_offsets, a.line_offsets);
    EXPECT_EQ(b.line_vertices, a.line_vertices);
    EXPECT_EQ(b.points, a.points);
    EXPECT_EQ(b.vertex_colors, a.vertex_colors);
    EXPECT_EQ(b.loose_parts_with_attributes, 9u);

    ASSERT_EQ(to.nodes.size(), 2u);
    EXPECT_EQ(to.nodes[0].name, "node");
    EXPECT_EQ(to.nodes[0].transform, from.nodes[0].transform);
    ASSERT_TRUE(to.nodes[0].trs.has_value() && !to.nodes[1].trs.has_value());
    EXPECT_EQ(to.nodes[0].trs->translation, glm::dvec3(1, 2, 3));
    EXPECT_EQ(to.nodes[0].trs->rotation, from.nodes[0].trs->rotation);
    EXPECT_EQ(to.nodes[0].trs->scale, glm::dvec3(4, 5, 6));
    EXPECT_EQ(to.nodes[0].mesh + to.nodes[0].camera + to.nodes[0].light + to.nodes[0].skin, 0u);
    EXPECT_EQ(to.nodes[1].parent, 0u);
    ASSERT_EQ(to.materials.size(), 1u);
    const prep::Material &m = to.materials[0], &n = from.materials[0];
    EXPECT_EQ(m.name, n.name);
    EXPECT_EQ(m.ambient, n.ambient);
    EXPECT_EQ(m.diffuse, n.diffuse);
    EXPECT_EQ(m.specular, n.specular);
    EXPECT_EQ(m.shininess, n.shininess);
    EXPECT_EQ(m.emissive, n.emissive);
    for (const prep::MaterialMap& map : prep::material_maps) {
        const prep::TextureRef &x = m.*map.ref, &y = n.*map.ref;
        EXPECT_TRUE(x.texture == y.texture && x.uv_set == y.uv_set && x.offset == y.offset &&
                    x.scale == y.scale && x.rotation == y.rotation && x.strength == y.strength)
            << map.name;
    }
    EXPECT_EQ(m.normal_map_space, prep::NormalMapSpace::object);
    EXPECT_TRUE(m.normal_map_flip_green && m.unlit && m.metallic_roughness && m.double_sided);
    EXPECT_EQ(m.metallic, 0.25f);
    EXPECT_EQ(m.roughness, 0.75f);
    EXPECT_EQ(m.alpha_mode, prep::AlphaMode::blend);
    EXPECT_EQ(m.alpha_cutoff, 0.375f);
    ASSERT_EQ(to.textures.size(), 1u);
    EXPECT_EQ(to.textures[0].wrap_u, prep::Wrap::mirror);
    EXPECT_EQ(to.textures[0].wrap_v, prep::Wrap::border);
    EXPECT_EQ(to.textures[0].mag, prep::Filter::nearest);
    EXPECT_EQ(to.textures[0].min, prep::Filter::nearest);
    EXPECT_EQ(to.textures[0].mip, prep::MipFilter::none);
    ASSERT_EQ(to.images.size(), 1u);
    EXPECT_EQ(to.images[0].path, from.images[0].path);
    EXPECT_EQ(to.images[0].bytes, from.images[0].bytes);
    EXPECT_EQ(to.images[0].read_from, from.images[0].read_from);
    EXPECT_EQ(to.passed_over, from.passed_over);
    EXPECT_EQ(to.images[0].name + to.images[0].mime_type, "iimage/png");
    ASSERT_EQ(to.lights.size(), 1u);
    const prep::Light& light = to.lights[0];
    EXPECT_EQ(light.name, "lamp");
    EXPECT_EQ(light.kind, prep::LightKind::spot);
    EXPECT_EQ(light.color, glm::vec3(1, 2, 3));
    EXPECT_EQ(glm::vec4(light.intensity, light.range, light.inner_cone, light.outer_cone),
              glm::vec4(4, 5, 6, 7));
    ASSERT_EQ(to.cameras.size(), 1u);
    const prep::Camera& camera = to.cameras[0];
    EXPECT_TRUE(camera.name == "eye" && !camera.perspective);
    EXPECT_EQ(glm::dvec3(camera.yfov, camera.aspect, camera.xmag), glm::dvec3(1, 2, 3));
    EXPECT_EQ(glm::dvec3(camera.ymag, camera.znear, camera.zfar), glm::dvec3(4, 5, 6));
    ASSERT_EQ(to.skins.size(), 1u);
    EXPECT_EQ(to.skins[0].name, "skin");
    EXPECT_EQ(to.skins[0].joints, from.skins[0].joints);
    EXPECT_EQ(to.skins[0].inverse_bind, from.skins[0].inverse_bind);
    ASSERT_EQ(to.animations.size(), 1u);
    const prep::Animation& animation = to.animations[0];
    EXPECT_EQ(animation.name, "walk");
    ASSERT_EQ(animation.samplers.size(), 3u);
    EXPECT_EQ(animation.samplers[0].interpolation, prep::Interpolation::cubic_spline);
    EXPECT_EQ(*animation.samplers[0].times, (std::vector<float>{0, 0.5f}));
    EXPECT_EQ(animation.samplers[0].values->size(), 18u);
    EXPECT_TRUE(!animation.samplers[2].times && !animation.samplers[2].values);
    ASSERT_EQ(animation.channels.size(), 3u);
    EXPECT_EQ(animation.channels[0].node, 1u);
    EXPECT_EQ(animation.channels[1].sampler, 1u);
    EXPECT_EQ(animation.channels[1].path, prep::AnimationPath::weights);
    EXPECT_EQ(to.active_camera, 0u);
    EXPECT_EQ(to.source_bytes, from.source_bytes);
    EXPECT_EQ(to.warnings, from.warnings);
    EXPECT_EQ(to.retained_file, nullptr);
}

TEST(SceneBytes, WhatSharesValuesSharesThemAfterwards) {
    const auto to = scene_of_bytes(scene_bytes(full_scene()));
    ASSERT_TRUE(to.has_value());
    const auto& targets = to->meshes[0].morph_targets;
    EXPECT_EQ(targets[0].positions[0].values, targets[0].positions[1].values);
    EXPECT_EQ(targets[0].positions[0].values, targets[1].positions[0].values);
    const auto& samplers = to->animations[0].samplers;
    EXPECT_EQ(samplers[0].times, samplers[1].times);
    EXPECT_EQ(samplers[1].times, samplers[1].values);
    EXPECT_NE(samplers[0].times, samplers[0].values);
}

TEST(SceneBytes, EveryTruncationIsAnError) {
    const std::vector<std::byte> bytes = scene_bytes(full_scene());
    for (std::size_t size = 0; size < bytes.size(); ++size)
        ASSERT_FALSE(scene_of_bytes(std::span(bytes).first(size)).has_value()) << size;
    std::vector<std::byte> longer = bytes;
    longer.push_back(std::byte(0));
    EXPECT_FALSE(scene_of_bytes(longer).has_value());
}

// Whatever is made of them keeps what loaders promise. Each byte with two other values, and each
// with a count that cannot be.
TEST(SceneBytes, DamagedBytesAreAnErrorOrAScene) {
    const std::vector<std::byte> bytes = scene_bytes(full_scene());
    std::size_t errors = 0, scenes = 0;
    const auto judge = [&](const std::vector<std::byte>& damaged) {
        const auto scene = scene_of_bytes(damaged);
        ++(scene ? scenes : errors);
        if (scene) {
            ASSERT_EQ(test::broken_promise(*scene), "");
        }
    };
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        for (const int bits : {0x01, 0x80}) {
            std::vector<std::byte> damaged = bytes;
            damaged[i] ^= std::byte(bits);
            judge(damaged);
        }
        std::vector<std::byte> damaged = bytes;
        for (std::size_t k = i; k < std::min(i + 8, bytes.size()); ++k)
            damaged[k] = std::byte(0xff);
        judge(damaged);
    }
    EXPECT_GT(errors, bytes.size() / 2);
    EXPECT_GT(scenes, bytes.size() / 10);  // many are numbers, of which any will do
}

struct Broken {
    const char* what;
    void (*breaks)(Scene&);
};

TEST(SceneBytes, ScenesThatBreakAPromiseAreErrors) {
    using prep::no_index;
    const Broken all[] = {
        {"corner", [](Scene& s) { s.meshes[0].corner_vertices[2] = 4; }},
        {"face of two",
         [](Scene& s) {
             s.meshes[0].face_offsets = {0, 5, 7};
         }},
        {"no offsets", [](Scene& s) { s.meshes[0].face_offsets = {}; }},
        {"normal", [](Scene& s) { s.meshes[0].normals.indices[0] = 2; }},
        {"normals", [](Scene& s) { s.meshes[0].normals.indices.pop_back(); }},
        {"tangent", [](Scene& s) { s.meshes[0].tangents.indices[0] = 1; }},
        {"uv", [](Scene& s) { s.meshes[0].uvs[1].indices[0] = 1; }},
        {"colour", [](Scene& s) { s.meshes[0].colors[0].indices[0] = 1; }},
        {"material", [](Scene& s) { s.meshes[0].face_materials[0] = 1; }},
        {"variant", [](Scene& s) { s.meshes[0].variant_materials[0] = 1; }},
        {"smoothing", [](Scene& s) { s.meshes[0].face_smoothing = {1}; }},
        {"part", [](Scene& s) { s.meshes[0].face_parts[0] = 2; }},
        {"file vertex", [](Scene& s) { s.meshes[0].file_vertices[0] = 5; }},
        {"corner's file vertex", [](Scene& s) { s.meshes[0].corner_file_vertices[0] = 5; }},
        {"targets overlap",
         [](Scene& s) { s.meshes[0].morph_targets[0].positions[1].first_vertex = 1; }},
        {"target at the end",
         [](Scene& s) { s.meshes[0].morph_targets[0].positions[1].first_vertex = no_index - 1; }},
        {"joints", [](Scene& s) { s.meshes[0].skin_influences[0].joints.pop_back(); }},
        {"attribute", [](Scene& s) { s.meshes[0].vertex_attributes[0].values.pop_back(); }},
        {"attribute of no width", [](Scene& s) { s.meshes[0].vertex_attributes[0].width = 0; }},
        {"mark", [](Scene& s) { s.meshes[0].hard_marks[0].y = 4; }},
        {"crease", [](Scene& s) { s.meshes[0].subdivision.creases[0].v1 = 4; }},
        {"sharp vertex", [](Scene& s) { s.meshes[0].subdivision.corners[0].vertex = 4; }},
        {"hole", [](Scene& s) { s.meshes[0].subdivision.holes[0] = 2; }},
        {"line", [](Scene& s) { s.meshes[0].line_vertices[0] = 4; }},
        {"line of one",
         [](Scene& s) {
             s.meshes[0].line_offsets = {0, 1, 2};
         }},
        {"point", [](Scene& s) { s.meshes[0].points[0] = 4; }},
        {"vertex colours", [](Scene& s) { s.meshes[0].vertex_colors.pop_back(); }},
        {"node's mesh", [](Scene& s) { s.nodes[0].mesh = 1; }},
        {"node's camera", [](Scene& s) { s.nodes[0].camera = 1; }},
        {"node's light", [](Scene& s) { s.nodes[0].light = 1; }},
        {"node's skin", [](Scene& s) { s.nodes[0].skin = 1; }},
        {"parent", [](Scene& s) { s.nodes[1].parent = 2; }},
        {"own parent", [](Scene& s) { s.nodes[1].parent = 1; }},
        {"cycle", [](Scene& s) { s.nodes[0].parent = 1; }},
        {"active camera", [](Scene& s) { s.active_camera = 2; }},
        {"texture", [](Scene& s) { s.textures[0].image = 1; }},
        {"map", [](Scene& s) { s.materials[0].displacement_map.texture = 1; }},
        {"joint", [](Scene& s) { s.skins[0].joints[0] = 2; }},
        {"inverse bind", [](Scene& s) { s.skins[0].inverse_bind.pop_back(); }},
        {"sampler", [](Scene& s) { s.animations[0].channels[0].sampler = 3; }},
        {"channel's node", [](Scene& s) { s.animations[0].channels[0].node = 2; }},
        {"keys",
         [](Scene& s) { s.animations[0].channels[0].path = prep::AnimationPath::rotation; }},
        {"half a sampler", [](Scene& s) { s.animations[0].samplers[0].times = nullptr; }},
    };
    for (const Broken& broken : all) {
        Scene scene = full_scene();
        broken.breaks(scene);
        const auto result = scene_of_bytes(scene_bytes(scene));
        ASSERT_FALSE(result.has_value()) << broken.what;
        EXPECT_NE(result.error().text.find("out of range"), std::string::npos) << broken.what;
    }
}

TEST(SceneBytes, LongChainsOfParentsAreJudgedInLinearTime) {
    Scene scene;
    scene.nodes.resize(300000);
    for (std::uint32_t n = 0; n + 1 < scene.nodes.size(); ++n) scene.nodes[n].parent = n + 1;
    EXPECT_TRUE(scene_of_bytes(scene_bytes(scene)).has_value());
    scene.nodes.back().parent = 17;
    EXPECT_FALSE(scene_of_bytes(scene_bytes(scene)).has_value());
}

// A struct that grows does not compile before the new member is listed: this is what tells.
struct Three {
    std::string a;
    std::vector<glm::vec3> b;
    float c = 1;
};
static_assert(prep::detail::member_count<Three>() == 3);
static_assert(prep::detail::member_count<prep::EdgeMark>() == 3);
static_assert(prep::detail::member_count<prep::Texture>() == 6);

TEST(SceneBytes, TheSharedCorpusArrivesByBits) {
    MESHPREP_REQUIRE_SHARED(shared);
    std::size_t meshes = 0;
    for (const char* name : {"corpus/spot.obj", "corpus/fandisk.obj", "corpus/CesiumMan.glb",
                             "corpus/MorphStressTest.gltf/MorphStressTest.gltf"}) {
        auto from = prep::load_scene(shared / name);
        if (!from) continue;
        const auto to = scene_of_bytes(scene_bytes(*from));
        ASSERT_TRUE(to.has_value()) << name << ": " << to.error().text;
        ASSERT_EQ(to->meshes.size(), from->meshes.size());
        for (std::size_t m = 0; m < to->meshes.size(); ++m, ++meshes)
            EXPECT_EQ(test::exact_difference(to->meshes[m], from->meshes[m]), "") << name;
    }
    EXPECT_GE(meshes, 3u);
}

}  // namespace
