// What OBJ and MTL make of names: those that would end, join or lose a line, and equal ones.
#include <gtest/gtest.h>

#include <set>

#include "formats/obj/statement_names.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shapes.h"

namespace {

using Strings = std::vector<std::string>;

prep::Mesh triangle(const std::string& name) {
    prep::Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    mesh.name = name;
    return mesh;
}

struct Written {
    Strings notes;
    prep::Scene scene;
    std::string text;
};

Written as_obj(const prep::Scene& scene, const std::string& name = "out.obj") {
    const test::TempDir dir;
    const auto notes = prep::save_scene(test::untouched(scene), dir / name);
    EXPECT_TRUE(notes) << prep::to_string(notes.error());
    auto read = prep::load_scene(dir / name);
    EXPECT_TRUE(read) << prep::to_string(read.error());
    return {*notes, *std::move(read), test::file_text(dir / name)};
}

bool is_noted(const Written& written, const std::string& text) {
    return std::any_of(written.notes.begin(), written.notes.end(), [&](const std::string& note) {
        return note.find(text) != std::string::npos;
    });
}

TEST(ObjNames, AStatementEndsWithItsName) {
    EXPECT_EQ(prep::detail::statement_name("a\nb\r"), "a b");
    EXPECT_EQ(prep::detail::statement_name(" \t a b \v"), "a b");
    EXPECT_EQ(prep::detail::statement_name("C:\\out\\"), "C:\\out_");
    EXPECT_EQ(prep::detail::statement_name(" \n "), "");
}

// Materials whose names readers take for one, and such as would take the line behind them.
TEST(ObjNames, MaterialsStayApart) {
    prep::Scene scene;
    const Strings names{"A", "A ", " A", "A\t", "A\\", "A_2", "", "material_6"};
    for (std::size_t m = 0; m < names.size(); ++m) {
        prep::Material& material = scene.materials.emplace_back();
        material.name = names[m];
        material.diffuse = glm::vec4(float(m) / 16, 0, 0, 1);
    }
    prep::Mesh mesh = triangle("m");
    for (std::uint32_t m = 1; m < names.size(); ++m)
        for (int k = 0; k < 3; ++k) mesh.corner_vertices.push_back(std::uint32_t(k));
    mesh.face_offsets.clear();
    for (std::uint32_t m = 0; m <= names.size(); ++m) mesh.face_offsets.push_back(3 * m);
    for (std::uint32_t m = 0; m < names.size(); ++m) mesh.face_materials.push_back(m);
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    const Written written = as_obj(scene);
    EXPECT_EQ(written.scene.warnings, Strings{});
    const prep::Mesh& read = written.scene.meshes[0];
    ASSERT_EQ(read.face_count(), names.size());
    std::set<std::string> known;
    for (std::uint32_t f = 0; f < names.size(); ++f) {
        const prep::Material& material = written.scene.materials[read.face_materials[f]];
        EXPECT_EQ(material.diffuse.r, float(f) / 16) << f;
        EXPECT_TRUE(known.insert(material.name).second) << material.name;
    }
    EXPECT_EQ(written.scene.materials[read.face_materials[0]].name, "A");
    EXPECT_EQ(written.scene.materials[read.face_materials[5]].name, "A_2");
    EXPECT_TRUE(is_noted(written, "equal ones got a number"));
    EXPECT_TRUE(is_noted(written, "a last '\\' replaced"));
}

TEST(ObjNames, EachMeshThatIsThereIsAnObject) {
    prep::Scene scene;
    scene.meshes = {triangle(""), triangle("b\\"), triangle("c"), triangle("c"), triangle("c_2")};
    prep::instance_unused_meshes(scene);
    for (prep::Node& node : scene.nodes)
        if (node.mesh == 0) node.name = "of the node";
    prep::Node again;
    again.mesh = 3;
    again.transform[3].x = 5;
    scene.nodes.push_back(again);
    const Written written = as_obj(scene);
    const prep::Mesh& read = written.scene.meshes[0];
    ASSERT_EQ(read.face_count(), 6u);
    Strings objects;
    for (const std::uint32_t p : read.face_parts) objects.push_back(read.parts[p]);
    EXPECT_EQ(objects, (Strings{"of the node", "b_", "c", "c_3", "c_2", "c_4"}));
    EXPECT_TRUE(is_noted(written, "OBJ tells objects apart by name"));
}

// The library is found under the name that the file says.
TEST(ObjNames, LibrariesHaveNamesThatCanBeRead) {
    prep::Scene scene;
    scene.materials.emplace_back().name = "red";
    prep::Mesh mesh = triangle("m");
    mesh.face_materials = {0};
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    for (const char* name : {" lead.obj", "two\nlines.obj", "plain.obj"}) {
        const Written written = as_obj(scene, name);
        EXPECT_EQ(written.scene.warnings, Strings{}) << name;
        ASSERT_EQ(written.scene.materials.size(), 1u) << name;
        EXPECT_EQ(written.scene.materials[0].name, "red");
    }
}

// A picture on the machine of the file's author is not looked for beside the output.
TEST(ObjNames, PathsOfPicturesThatAreNotThereStay) {
    const test::TempDir dir;
    test::write_text(dir / "a.obj",
                     "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
    test::write_text(dir / "a.mtl",
                     "newmtl m\nmap_Kd C:\\art\\color.tga\nmap_Ks \\\\server\\share\\x.png\n"
                     "map_Ke /nowhere/y.png\nnorm gone.png\n");
    const auto scene = prep::load_scene(dir / "a.obj");
    ASSERT_TRUE(scene) << prep::to_string(scene.error());
    std::filesystem::create_directory(dir / "out");
    ASSERT_TRUE(prep::save_scene(test::untouched(*scene), dir / "out/b.obj"));
    const std::string mtl = test::file_text(dir / "out/b.mtl");
    EXPECT_NE(mtl.find("map_Kd C:/art/color.tga\n"), std::string::npos) << mtl;
    EXPECT_NE(mtl.find("map_Ks //server/share/x.png\n"), std::string::npos) << mtl;
    EXPECT_NE(mtl.find("map_Ke /nowhere/y.png\n"), std::string::npos) << mtl;
    EXPECT_NE(mtl.find("../gone.png\n"), std::string::npos) << mtl;
}

TEST(ObjNames, WhatIsNoUtf8IsLatin1InGltf) {
    prep::Scene scene;
    for (const char* name : {"gr\xfcn", "gr\xf6n", "gr\xc3\xbcn", "\xed\xa0\x80"})
        scene.materials.emplace_back().name = name;
    prep::Mesh mesh = triangle("m");
    mesh.face_materials = {0};
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(test::untouched(scene), dir / "a.glb"));
    const auto read = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(read) << prep::to_string(read.error());
    ASSERT_EQ(read->materials.size(), 4u);
    EXPECT_EQ(read->materials[0].name, "gr\xc3\xbcn");
    EXPECT_EQ(read->materials[1].name, "gr\xc3\xb6n");
    EXPECT_EQ(read->materials[2].name, "gr\xc3\xbcn");
    EXPECT_EQ(read->materials[3].name, "\xc3\xad\xc2\xa0\xc2\x80");  // a surrogate is none
}

}  // namespace
