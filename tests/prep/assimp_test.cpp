// Formats that Assimp reads for us, on small files written here.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "invariants.h"
#include "mesh_files.h"
#include "prep/io.h"

namespace {

prep::Result<prep::Scene> load(const test::TempDir& dir, const std::string& name,
                               const std::string& text) {
    test::write_text(dir / name, text);
    auto scene = prep::load_scene(dir / name);
    if (scene) {
        EXPECT_EQ(test::broken_promise(*scene), "");
    }
    return scene;
}

const char* const collada = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset>
<library_images><image id="i"><init_from>wood.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON>
<newparam sid="s"><surface type="2D"><init_from>i</init_from></surface></newparam>
<newparam sid="t"><sampler2D><source>s</source></sampler2D></newparam>
<technique sid="common"><phong><diffuse><texture texture="t" texcoord="UV"/></diffuse>
<specular><color>0.5 0.25 0.125 1</color></specular><shininess><float>20</float></shininess>
</phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="wood"><instance_effect url="#e"/></material>
</library_materials>
<library_geometries><geometry id="g" name="quad"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="u"><float_array id="ua" count="8">0 0 1 0 1 0.75 0 1</float_array>
<technique_common><accessor source="#ua" count="4" stride="2"><param name="S" type="float"/>
<param name="T" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#u" offset="1" set="0"/><vcount>4</vcount>
<p>0 0 1 1 2 2 3 3</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node id="n" name="n">
<translate>1 2 3</translate>
<instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="m" target="#m"><bind_vertex_input semantic="UV"
input_semantic="TEXCOORD" input_set="0"/></instance_material></technique_common></bind_material>
</instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>
)";

TEST(Assimp, ColladaQuadWithMaterialAndTransform) {
    const test::TempDir dir;
    const auto scene = load(dir, "quad.dae", collada);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->meshes.size(), 1u);
    const prep::Mesh& m = scene->meshes[0];
    EXPECT_EQ(m.face_offsets, (std::vector<std::uint32_t>{0, 4}));  // a quad stays a quad
    ASSERT_EQ(m.uvs.size(), 1u);
    EXPECT_EQ(m.uvs[0].values[m.uvs[0].indices[2]], glm::vec2(1, 0.25f));  // top-left origin
    ASSERT_FALSE(m.face_materials.empty());
    const prep::Material& material = scene->materials[m.face_materials[0]];
    EXPECT_EQ(material.specular, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(material.shininess, 20.0f);
    ASSERT_TRUE(bool(material.diffuse_map));
    const auto& image = scene->images[scene->textures[material.diffuse_map.texture].image];
    EXPECT_EQ(image.path, dir / "wood.png");
    const auto world = prep::world_transforms(*scene);
    bool moved = false;
    for (std::size_t n = 0; n < scene->nodes.size(); ++n)
        if (scene->nodes[n].mesh == 0)
            moved = glm::dvec3(world[n] * glm::dvec4(0, 0, 0, 1)) == glm::dvec3(1, 2, 3);
    EXPECT_TRUE(moved);
}

TEST(Assimp, TruncationsAreErrorsOrScenes) {
    const test::TempDir dir;
    const std::string whole = collada;
    std::size_t refused = 0, cut = 0;
    for (std::size_t n = 1; n < whole.size(); n += 97, ++cut) {
        const auto scene = load(dir, "cut.dae", whole.substr(0, n));
        if (scene) continue;
        ++refused;
        EXPECT_EQ(scene.error().place, (dir / "cut.dae").string());
        EXPECT_EQ(scene.error().text.rfind("Assimp: ", 0), 0u) << scene.error().text;
    }
    EXPECT_GT(refused, cut / 2);
}

TEST(Assimp, NonsenseIsASyntaxErrorWithItsFile) {
    const test::TempDir dir;
    for (const char* name : {"a.fbx", "a.3ds", "a.dae", "a.blend", "a.x", "a.lwo"}) {
        const auto scene = load(dir, name, "this is no scene of any kind\n");
        ASSERT_FALSE(scene.has_value()) << name;
        EXPECT_EQ(scene.error().code, prep::ErrorCode::syntax) << name;
        EXPECT_EQ(scene.error().place, (dir / name).string());
    }
}

}  // namespace
