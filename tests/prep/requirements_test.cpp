#include "prep/requirements.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "prep/calls/calls_for.h"

namespace {

prep::Scene textured_triangle() {
    prep::Scene scene;
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.face_offsets = {0, 3};
    mesh.corner_vertices = {0, 1, 2};
    mesh.uvs.push_back({{{0, 0}, {1, 0}, {0, 1}}, {0, 1, 2}});
    mesh.face_materials = {0};
    scene.meshes.push_back(mesh);
    scene.materials.resize(1);
    scene.materials[0].name = "brick";
    scene.textures.resize(1);
    return scene;
}

TEST(Requirements, EmptySceneNeedsNothing) {
    EXPECT_TRUE(prep::requirements({}).empty());
}

TEST(Requirements, LitFacesNeedNormalsOnly) {
    const auto r = prep::requirements(textured_triangle());
    ASSERT_EQ(r.size(), 1u);
    EXPECT_TRUE(r[0].normals.needed);
    EXPECT_EQ(r[0].normals.reason, "material 'brick' is lit");
    EXPECT_FALSE(r[0].tangents.needed);
    EXPECT_FALSE(r[0].uvs.needed);
}

TEST(Requirements, NormalMapCallsForTangentsAndNamesTheMaterial) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].normal_map.texture = 0;
    const auto r = prep::requirements(scene);
    EXPECT_TRUE(r[0].tangents.needed);
    EXPECT_EQ(r[0].tangents.reason, "material 'brick' has a tangent-space normal map");
    EXPECT_TRUE(r[0].uvs.needed);
}

TEST(Requirements, MaterialsOfVariantsAreInUse) {
    prep::Scene scene = textured_triangle();
    scene.materials.push_back(scene.materials[0]);
    scene.materials[1].name = "plaster";
    scene.materials[1].normal_map.texture = 0;
    EXPECT_FALSE(prep::requirements(scene)[0].tangents.needed);
    scene.meshes[0].variant_materials = {1};
    EXPECT_EQ(prep::requirements(scene)[0].tangents.reason,
              "material 'plaster' has a tangent-space normal map");
    scene.meshes[0].variant_materials = {7};  // the file has no such one
    EXPECT_FALSE(prep::requirements(scene)[0].tangents.needed);
}

TEST(Requirements, ObjectSpaceMapNeedsNoTangents) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].normal_map.texture = 0;
    scene.materials[0].normal_map_space = prep::NormalMapSpace::object;
    EXPECT_FALSE(prep::requirements(scene)[0].tangents.needed);
}

TEST(Requirements, NormalMapWithoutItsUvSetSaysSo) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].normal_map.texture = 0;
    scene.materials[0].normal_map.uv_set = 3;
    const auto r = prep::requirements(scene);
    EXPECT_FALSE(r[0].tangents.needed);
    EXPECT_EQ(r[0].tangents.reason,
              "material 'brick' has a tangent-space normal map, but UV set 3 is missing");
}

TEST(Requirements, UnusedMaterialCallsForNothing) {
    prep::Scene scene = textured_triangle();
    scene.materials.resize(2);
    scene.materials[1].normal_map.texture = 0;
    EXPECT_FALSE(prep::requirements(scene)[0].tangents.needed);
}

TEST(Requirements, PointsAndLinesNeedNoNormals) {
    prep::Scene scene;
    scene.meshes.resize(1);
    scene.meshes[0].positions = {{0, 0, 0}};
    scene.meshes[0].points = {0};
    const auto r = prep::requirements(scene);
    EXPECT_FALSE(r[0].normals.needed);
    EXPECT_EQ(r[0].normals.reason, "no faces: points and lines carry no normals");
}

TEST(Requirements, UnlitMaterialsNeedNoNormals) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].unlit = true;
    EXPECT_FALSE(prep::requirements(scene)[0].normals.needed);
}

TEST(Requirements, AskedTangentsBringNormalsAlong) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].unlit = true;
    prep::Request request;
    request.tangents = prep::Request::Level::always;
    const auto r = prep::requirements(scene, request);
    EXPECT_TRUE(r[0].tangents.needed);
    EXPECT_TRUE(r[0].normals.needed);
    EXPECT_EQ(r[0].normals.reason, "tangents need normals");
}

TEST(Requirements, AskedTangentsWithoutUvsAreRefusedWithTheReason) {
    prep::Scene scene = textured_triangle();
    scene.meshes[0].uvs.clear();
    prep::Request request;
    request.tangents = prep::Request::Level::always;
    const auto r = prep::requirements(scene, request);
    EXPECT_FALSE(r[0].tangents.needed);
    EXPECT_EQ(r[0].tangents.reason, "asked for by the request, but the mesh has no UVs");
}

TEST(Requirements, FaceWithoutMaterialIsLitByTheDefaultOne) {
    prep::Scene scene = textured_triangle();
    scene.meshes[0].face_materials = {prep::no_index};
    EXPECT_EQ(prep::requirements(scene)[0].normals.reason,
              "faces without a material are lit by the default one");
}

// A second UV set, and none in the first.
prep::Scene with_second_set_only() {
    prep::Scene scene = textured_triangle();
    prep::Mesh& mesh = scene.meshes[0];
    mesh.uvs.insert(mesh.uvs.begin(), prep::CornerLayer<glm::vec2>());
    return scene;
}

TEST(Requirements, AMapCallsForUvsWhereTheSetThatItSamplesExists) {
    const std::pair<const char*, prep::TextureRef prep::Material::*> maps[] = {
        {"diffuse map", &prep::Material::diffuse_map},
        {"specular map", &prep::Material::specular_map},
        {"emissive map", &prep::Material::emissive_map},
        {"occlusion map", &prep::Material::occlusion_map},
        {"normal map", &prep::Material::normal_map},
        {"bump map", &prep::Material::bump_map},
        {"displacement map", &prep::Material::displacement_map},
        {"metallic-roughness map", &prep::Material::metallic_roughness_map}};
    for (const auto& [name, map] : maps) {
        for (const std::uint32_t set : {0u, 1u, 2u}) {
            prep::Scene scene = with_second_set_only();
            prep::TextureRef& ref = scene.materials[0].*map;
            ref.texture = 0;
            ref.uv_set = set;
            const prep::Need uvs = prep::requirements(scene)[0].uvs;
            EXPECT_EQ(uvs.needed, set == 1) << name << ", set " << set;
            EXPECT_EQ(uvs.reason, set == 1 ? std::string("material 'brick' has a ") + name
                                           : "no material in use samples a texture on this mesh");
        }
    }
}

TEST(Requirements, TangentsFollowTheSetOfTheFirstNormalMapThatHasOne) {
    prep::Scene scene = with_second_set_only();
    scene.materials.resize(3);
    scene.meshes[0].face_materials = {2};
    scene.meshes[0].variant_materials = {0, 1};
    for (prep::Material& m : scene.materials) m.normal_map.texture = 0;
    scene.materials[1].name = "plaster";
    scene.materials[2].name = "tile";
    scene.materials[2].normal_map.uv_set = 3;
    scene.materials[0].normal_map.uv_set = 0;
    scene.materials[1].normal_map.uv_set = 1;
    auto r = prep::requirements(scene)[0];
    EXPECT_TRUE(r.tangents.needed);
    EXPECT_EQ(r.tangents.reason, "material 'plaster' has a tangent-space normal map");
    EXPECT_EQ(r.tangent_uv_set, 1u);
    EXPECT_FALSE(r.tangents.asked);
    // Without it the first that lacks its set is named: the mesh's own before the variants'.
    scene.materials[1].normal_map.uv_set = 2;
    r = prep::requirements(scene)[0];
    EXPECT_FALSE(r.tangents.needed);
    EXPECT_EQ(r.tangents.reason,
              "material 'tile' has a tangent-space normal map, but UV set 3 is missing");
    // A material without a name is told by its number.
    scene.materials[2].name.clear();
    EXPECT_EQ(prep::requirements(scene)[0].tangents.reason,
              "material 2 has a tangent-space normal map, but UV set 3 is missing");
}

// What other renderers draw in the tangent frame: a clearcoat's normal map, anisotropy.
TEST(Requirements, LayersInTheTangentFrameCallForTangents) {
    prep::Scene scene = with_second_set_only();
    prep::Material& m = scene.materials[0];
    m = {};
    m.name = "paint";
    EXPECT_FALSE(prep::requirements(scene)[0].tangents.needed);
    m.layer_normal_map = {.texture = 0, .uv_set = 1};
    auto r = prep::requirements(scene)[0];
    EXPECT_TRUE(r.tangents.needed);
    EXPECT_EQ(r.tangent_uv_set, 1u);
    EXPECT_EQ(r.tangents.reason, "material 'paint' has a map in the tangent frame: layer normal");
    m.layer_normal_map = {};
    m.anisotropy_map = {.texture = 0, .uv_set = 1};
    EXPECT_EQ(prep::requirements(scene)[0].tangents.reason,
              "material 'paint' has a map in the tangent frame: anisotropy");
    // Anisotropy without a map follows the first set, which this mesh lacks.
    m.anisotropy_map = {};
    m.anisotropy = 0.5f;
    r = prep::requirements(scene)[0];
    EXPECT_FALSE(r.tangents.needed);
    EXPECT_EQ(r.tangents.reason, "material 'paint' has anisotropy, but UV set 0 is missing");
    m.unlit = true;
    EXPECT_EQ(prep::requirements(scene)[0].tangents.reason,
              "no material in use has a tangent-space normal map");
}

TEST(Requirements, AnUnlitMaterialsNormalMapCallsForNothing) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].normal_map.texture = 0;
    scene.materials[0].unlit = true;
    const auto r = prep::requirements(scene)[0];
    EXPECT_FALSE(r.tangents.needed);
    EXPECT_EQ(r.tangents.reason, "no material in use has a tangent-space normal map");
    EXPECT_FALSE(r.normals.needed);
    EXPECT_EQ(r.normals.reason, "every material used is unlit");
}

TEST(Requirements, TheRequestDecidesBeforeTheMaterials) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].unlit = true;
    prep::Request request;
    request.normals = prep::Request::Level::always;
    auto r = prep::requirements(scene, request)[0];
    EXPECT_TRUE(r.normals.needed);
    EXPECT_EQ(r.normals.reason, "asked for by the request");
    scene.materials[0].unlit = false;
    scene.materials[0].normal_map.texture = 0;
    request = {prep::Request::Level::never, prep::Request::Level::never};
    r = prep::requirements(scene, request)[0];
    EXPECT_FALSE(r.normals.needed || r.tangents.needed);
    EXPECT_EQ(r.normals.reason, "switched off by the request");
    EXPECT_EQ(r.tangents.reason, "switched off by the request");
}

TEST(Requirements, WhatIsAskedForIsAskedOnlyWhereItCanBeMade) {
    prep::Scene scene = textured_triangle();
    prep::Request request;
    request.tangents = prep::Request::Level::always;
    EXPECT_TRUE(prep::requirements(scene, request)[0].tangents.asked);
    scene.meshes[0].uvs.clear();
    EXPECT_FALSE(prep::requirements(scene, request)[0].tangents.asked);
    EXPECT_FALSE(prep::requirements(textured_triangle())[0].tangents.asked);
}

TEST(Requirements, TangentsGoWithTheFilesNormalsWhereNoneAreComputed) {
    prep::Scene scene = textured_triangle();
    scene.materials[0].normal_map.texture = 0;
    prep::Request request;
    request.normals = prep::Request::Level::never;
    EXPECT_EQ(prep::requirements(scene, request)[0].tangents.reason,
              "tangents need normals, which are switched off");
    EXPECT_FALSE(prep::requirements(scene, request)[0].tangents.needed);
    scene.meshes[0].normals = {{{0, 0, 1}}, {0, 0, 0}};
    const auto r = prep::requirements(scene, request)[0];
    EXPECT_TRUE(r.tangents.needed);
    EXPECT_EQ(r.normals.reason, "tangents need normals");
}

// Every reason of a mesh's requirements: what brings it, and which go for it.
using Names = std::set<std::string>;
struct ReasonCase {
    void (*base)(prep::Scene&, prep::Request&);
    void (*change)(prep::Scene&, prep::Request&);
    Names come, go;
};
void none(prep::Scene&, prep::Request&) {}
void with_normal_map(prep::Scene& s, prep::Request&) {
    s.materials[0].normal_map.texture = 0;
}
void with_tangent_map(prep::Scene& s, prep::Request&) {
    s.materials[0].layer_normal_map.texture = 0;
}
void with_anisotropy(prep::Scene& s, prep::Request&) {
    s.materials[0].anisotropy = 0.5f;
}
void without_uvs(prep::Scene& s, prep::Request&) {
    s.meshes[0].uvs.clear();
}
void exact(prep::Scene&, prep::Request& r) {
    r.consumer.exact = true;
}
using Level = prep::Request::Level;
const std::vector<ReasonCase>& reason_cases() {
    using prep::Request, prep::Scene;
    static const std::vector<ReasonCase> all = {
        {none,
         [](Scene& s, Request&) {
             s.meshes[0] = {};
             s.meshes[0].positions.resize(1);
             s.meshes[0].points = {0};
         },
         {"no_faces_normals", "no_faces_tangents", "no_faces_uvs"},
         {"material_lit", "no_map", "no_tangent_map"}},
        {none, [](Scene&, Request& r) { r.normals = Level::never; }, {"request_off"}, {}},
        {none, [](Scene&, Request& r) { r.normals = Level::always; }, {"request_on"}, {}},
        {none,
         [](Scene&, Request& r) { r.tangents = Level::never; },
         {"request_off"},
         {"no_tangent_map"}},
        {none,
         [](Scene&, Request& r) { r.tangents = Level::always; },
         {"request_on"},
         {"no_tangent_map"}},
        {without_uvs,
         [](Scene&, Request& r) { r.tangents = Level::always; },
         {"request_on_without_uvs"},
         {"no_tangent_map"}},
        {none,
         [](Scene& s, Request&) { s.meshes[0].face_materials.clear(); },
         {"default_material_lit"},
         {"material_lit"}},
        {none,
         [](Scene& s, Request&) { s.materials[0].unlit = true; },
         {"all_unlit"},
         {"material_lit"}},
        {exact,
         [](Scene&, Request& r) { r.consumer.shading = prep::Shading::flat; },
         {"flat_shading"},
         {"material_lit"}},
        {exact,
         [](Scene&, Request& r) { r.consumer.lights = false; },
         {"no_directed_light"},
         {"material_lit"}},
        {exact,
         [](Scene&, Request& r) { r.consumer.colors = false; },
         {"no_colors_kept"},
         {"material_lit"}},
        {exact, [](Scene&, Request& r) { r.consumer.normals = true; }, {"normal_buffer"}, {}},
        {exact, [](Scene&, Request& r) { r.consumer.uvs = true; }, {"uv_buffer"}, {}},
        {none,
         [](Scene& s, Request&) {
             s.meshes[0].colors.push_back({{{1, 1, 1, 1}}, {0, 0, 0}});
         },
         {"vertex_colors"},
         {}},
        {none,
         [](Scene& s, Request&) { s.materials[0].diffuse_map.texture = 0; },
         {"map"},
         {"no_map"}},
        {without_uvs,
         [](Scene& s, Request&) { s.materials[0].diffuse_map.texture = 0; },
         {"map_without_uvs"},
         {}},
        {none, with_normal_map, {"map", "tangent_normal_map"}, {"no_map", "no_tangent_map"}},
        {without_uvs,
         with_normal_map,
         {"map_without_uvs", "tangent_normal_map_without_uvs"},
         {"no_tangent_map"}},
        {none, with_tangent_map, {"map", "tangent_map"}, {"no_map", "no_tangent_map"}},
        {without_uvs,
         with_tangent_map,
         {"map_without_uvs", "tangent_map_without_uvs"},
         {"no_tangent_map"}},
        {none, with_anisotropy, {"anisotropy"}, {"no_tangent_map"}},
        {without_uvs, with_anisotropy, {"anisotropy_without_uvs"}, {"no_tangent_map"}},
        {with_normal_map,
         [](Scene& s, Request&) { s.materials[0].unlit = true; },
         {"all_unlit", "no_tangent_map"},
         {"material_lit", "tangent_normal_map"}},
        {with_anisotropy,
         [](Scene&, Request& r) { r.normals = Level::never; },
         {"request_off", "tangents_without_normals"},
         {}},
        {[](Scene& s, Request&) { s.materials[0].unlit = true; },
         [](Scene&, Request& r) { r.tangents = Level::always; },
         {"request_on", "tangents_need_normals"},
         {"all_unlit", "no_tangent_map"}},
    };
    return all;
}

Names codes_of(const prep::Scene& scene, const prep::Request& request) {
    Names codes;
    const auto add = [&](const prep::Reason& why) { codes.insert(std::string(name_of(why.code))); };
    for (const prep::MeshRequirements& r : prep::requirements(scene, request))
        for (const prep::Need* need : {&r.normals, &r.uvs, &r.tangents}) add(need->why);
    for (const auto& calls : prep::calls_for(scene, request.consumer))
        for (const prep::Call& call : calls) add(call.why);
    return codes;
}
Names less(const Names& a, const Names& b) {
    Names out;
    std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::inserter(out, out.end()));
    return out;
}

TEST(Requirements, EveryReasonComesAndGoes) {
    Names found;
    std::size_t number = 0;
    for (const ReasonCase& c : reason_cases()) {
        prep::Scene scene = textured_triangle();
        prep::Request request;
        c.base(scene, request);
        const Names old = codes_of(scene, request);
        c.change(scene, request);
        const Names now = codes_of(scene, request);
        EXPECT_EQ(less(now, old), c.come) << "row " << number;
        EXPECT_EQ(less(old, now), c.go) << "row " << number;
        found.insert(c.come.begin(), c.come.end());
        found.insert(c.go.begin(), c.go.end());
        ++number;
    }
    // Of surfaces, while they are made: PrepareForDocument.ResidualMapsSayWhatTheyCallFor.
    found.insert("residual_map");
    for (const prep::ReasonRow& row : prep::reason_rows())
        if (row.code != prep::ReasonCode::none && row.code < prep::ReasonCode::view_given) {
            EXPECT_EQ(found.count(std::string(row.key)), 1u) << row.key << " is in no row";
        }
}

}  // namespace
