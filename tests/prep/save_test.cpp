#include "prep/save.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "formats/obj/obj.h"
#include "invariants.h"
#include "mesh_files.h"
#include "prep/files.h"
#include "prep/load.h"
#include "saved_in_memory.h"
#include "shapes.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

prep::Scene parse(const std::string& text) {
    prep::ObjOptions options;
    options.name = "test.obj";
    auto scene = prep::parse_obj(bytes_of(text), options);
    if (!scene) ADD_FAILURE() << prep::to_string(scene.error());
    return scene ? std::move(*scene) : prep::Scene{};
}

prep::Scene triangle() {
    return parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
}

// Saved as OBJ and loaded again: the mesh must be the same in every list, and so must the file the
// second time.
void expect_obj_round_trip(const std::string& text) {
    const prep::Scene scene = parse(text);
    const test::TempDir dir;
    const auto saved = prep::save_scene(test::untouched(scene), dir / "test.obj");
    ASSERT_TRUE(saved.has_value()) << prep::to_string(saved.error());
    const auto again = prep::load_scene(dir / "test.obj");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    EXPECT_EQ(test::broken_promise(*again), "");
    EXPECT_EQ(test::exact_difference(scene.meshes[0], again->meshes[0]), "")
        << test::file_text(dir / "test.obj");
    const std::string first = test::file_text(dir / "test.obj");
    ASSERT_TRUE(prep::save_scene(test::untouched(*again), dir / "test.obj").has_value());
    EXPECT_EQ(test::file_text(dir / "test.obj"), first);
}

TEST(WriteFile, ReplacesWholeAndLeavesNothingBeside) {
    const test::TempDir dir;
    test::write_text(dir / "a", "old");
    fs::permissions(dir / "a", fs::perms::owner_read | fs::perms::owner_write);
    ASSERT_TRUE(prep::write_file(dir / "a", bytes_of("new text")).has_value());
    EXPECT_EQ(test::file_text(dir / "a"), "new text");
    EXPECT_EQ(fs::status(dir / "a").permissions(), fs::perms::owner_read | fs::perms::owner_write);
    ASSERT_TRUE(prep::write_file(dir / "b", {}).has_value());
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"a", "b"}));
}

TEST(WriteFile, ErrorsNameTheFile) {
    const test::TempDir dir;
    const auto nowhere = prep::write_file(dir / "no", bytes_of("x"));
    ASSERT_TRUE(nowhere.has_value());
    const auto missing = prep::write_file(dir / "gone/file.ply", bytes_of("x"));
    ASSERT_FALSE(missing.has_value());
    EXPECT_EQ(prep::to_string(missing.error()),
              (dir / "gone/file.ply").string() +
                  ": cannot create a file here: No such file or directory");
    fs::create_directory(dir / "folder");
    const auto folder = prep::write_file(dir / "folder", bytes_of("x"));
    ASSERT_FALSE(folder.has_value());
    EXPECT_EQ(folder.error().text, "cannot write the file: this is a directory");
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"folder", "no"}));
}

TEST(WriteFile, DevicesAreWrittenNotReplaced) {
    if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
    ASSERT_TRUE(prep::write_file("/dev/null", bytes_of("x")).has_value());
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    const auto full = prep::write_file("/dev/full", bytes_of("x"));
    ASSERT_FALSE(full.has_value());
    EXPECT_EQ(full.error().text, "cannot write the file: No space left on device");
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(ReadFile, ErrorsNameTheFile) {
    const test::TempDir dir;
    const auto missing = prep::read_file(dir / "gone");
    ASSERT_FALSE(missing.has_value());
    EXPECT_EQ(prep::to_string(missing.error()),
              (dir / "gone").string() + ": cannot open the file: No such file or directory");
    const auto folder = prep::read_file(dir.path());
    ASSERT_FALSE(folder.has_value());
    EXPECT_EQ(folder.error().text, "this is a directory; name a file");
}

TEST(Save, UnknownEndingIsUnsupported) {
    const auto saved = prep::save_scene(test::untouched(triangle()), "x.fbx");
    ASSERT_FALSE(saved.has_value());
    EXPECT_EQ(prep::to_string(saved.error()),
              "x.fbx: cannot write '.fbx': GLB, glTF, OBJ, PLY, STL and OFF are written");
}

TEST(Save, EveryFormatWritesAndReadsAnEmptySceneAndATriangle) {
    const test::TempDir dir;
    for (const char* ending : {".obj", ".ply", ".stl", ".off", ".glb", ".gltf", ".OBJ", ".PLY"}) {
        for (const bool empty : {true, false}) {
            prep::Scene scene = empty ? parse("") : triangle();
            const fs::path path = dir / (std::string("x") + ending);
            const auto saved = prep::save_scene(test::untouched(scene), path);
            ASSERT_TRUE(saved.has_value()) << ending << prep::to_string(saved.error());
            const auto again = prep::load_scene(path);
            ASSERT_TRUE(again.has_value()) << ending << prep::to_string(again.error());
            EXPECT_EQ(test::broken_promise(*again), "") << ending;
            std::size_t faces = 0;
            for (const auto& mesh : again->meshes) faces += mesh.face_count();
            EXPECT_EQ(faces, empty ? 0u : 1u) << ending;
        }
    }
}

TEST(Save, AFailedWriteLeavesTheOldFilesAsTheyWere) {
    const test::TempDir dir;
    // The second file of each pair cannot be written: its name is a folder's.
    fs::create_directory(dir / "a.gltf");
    test::write_text(dir / "a.bin", "old");
    auto saved = prep::save_scene(test::untouched(triangle()), dir / "a.gltf");
    ASSERT_FALSE(saved.has_value());
    EXPECT_EQ(saved.error().code, prep::ErrorCode::io);
    EXPECT_EQ(test::file_text(dir / "a.bin"), "old");

    prep::Scene with_material = triangle();
    with_material.materials.emplace_back();
    fs::create_directory(dir / "b.obj");
    test::write_text(dir / "b.mtl", "old");
    saved = prep::save_scene(test::untouched(with_material), dir / "b.obj");
    ASSERT_FALSE(saved.has_value());
    EXPECT_EQ(test::file_text(dir / "b.mtl"), "old");

    fs::create_directory(dir / "c.mtl");
    test::write_text(dir / "c.obj", "old");
    saved = prep::save_scene(test::untouched(with_material), dir / "c.obj");
    ASSERT_FALSE(saved.has_value());
    EXPECT_EQ(test::file_text(dir / "c.obj"), "old");
    EXPECT_EQ(dir.names(),
              (std::vector<std::string>{"a.bin", "a.gltf", "b.mtl", "b.obj", "c.mtl", "c.obj"}));
}

TEST(Save, GltfAndItsBinaryAppearTogether) {
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(test::untouched(triangle()), dir / "a.gltf").has_value());
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"a.bin", "a.gltf"}));
    const auto again = prep::load_scene(dir / "a.gltf");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    EXPECT_EQ(again->meshes[0].face_count(), 1u);
}

TEST(Save, GlbInMemoryIsTheFile) {
    const test::TempDir dir;
    const prep::PreparedScene prepared =
        test::untouched(parse("g a b\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    const auto notes = prep::save_scene(prepared, dir / "a.glb");
    ASSERT_TRUE(notes) << prep::to_string(notes.error());
    test::expect_same_in_memory(prepared, {}, dir / "a.glb", *notes);
    prep::SaveOptions bits;
    bits.quantization.uvs = 17;
    const auto none = prep::save_glb(prepared, bits);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, prep::ErrorCode::invalid);
    EXPECT_NE(none.error().text.find("not 17"), std::string::npos);
}

TEST(Save, NotesSayWhatTheFormatCannotHold) {
    prep::Scene scene = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n");
    scene.materials.emplace_back();
    const test::TempDir dir;
    const auto notes = prep::save_scene(test::untouched(scene), dir / "a.stl");
    ASSERT_TRUE(notes.has_value());
    EXPECT_EQ(*notes, (std::vector<std::string>{
                          "STL holds no materials: left out", "STL holds no UVs: left out",
                          "STL holds facet normals only: vertex normals left out"}));
}

TEST(Save, NotesSayWhatBecomesOfPointsAndUnusedVertices) {
    const test::TempDir dir;
    const auto notes = [&](const std::string& text, const std::string& name) {
        const auto saved = prep::save_scene(test::untouched(parse(text)), dir / name);
        EXPECT_TRUE(saved.has_value());
        return saved ? *saved : std::vector<std::string>{};
    };
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    using Notes = std::vector<std::string>;
    EXPECT_EQ(notes(three + "curv 0 1 1 2\nend\n", "a.ply"),
              Notes{"3 vertices that no face, line or point uses left out"});
    EXPECT_EQ(notes(three + "p 1 3\n", "a.ply"),
              Notes{"1 vertex that no face, line or point uses left out"});
    const auto again = prep::load_scene(dir / "a.ply");
    ASSERT_TRUE(again.has_value());
    EXPECT_EQ(again->meshes[0].positions, (std::vector<glm::vec3>{{0, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(again->meshes[0].points.size(), 2u);
    EXPECT_EQ(notes(three + "f 1 2 3\np 1 2 3\n", "a.stl"),
              Notes{"STL holds no points: 3 left out"});
    EXPECT_EQ(notes(three + "v 5 5 5\nf 1 2 3\np 4\n", "a.off"),
              Notes{"OFF has no points beside faces or lines: 1 written as vertices that nothing "
                    "uses"});
    EXPECT_EQ(notes(three + "p 1 2 3\n", "a.obj"), Notes{});
}

std::string mtl_of(const test::TempDir& dir, const prep::Material& material) {
    prep::Scene scene = triangle();
    scene.materials = {material};
    scene.meshes[0].face_materials = {0};
    const auto saved = prep::save_scene(test::untouched(scene), dir / "test.obj");
    EXPECT_TRUE(saved.has_value());
    return test::file_text(dir / "test.mtl");
}

TEST(Save, UnlitMaterialsKeepTheirColourInMtl) {
    const test::TempDir dir;
    prep::Material material;
    material.diffuse = {1, 0.5f, 0.25f, 1};
    material.metallic_roughness = material.unlit = true;
    material.metallic = 1;  // glTF's default, of which unlit materials know nothing
    const std::string mtl = mtl_of(dir, material);
    EXPECT_NE(mtl.find("Kd 1 0.5 0.25\nKs 0 0 0\n"), std::string::npos) << mtl;
    EXPECT_NE(mtl.find("illum 0\n"), std::string::npos) << mtl;
    // What MTL itself holds of an unlit one is kept, though nothing draws it.
    material.metallic_roughness = false;
    material.specular = glm::vec3(0.5f);
    EXPECT_NE(mtl_of(dir, material).find("Ks 0.5 0.5 0.5\n"), std::string::npos);
}

TEST(Save, DisplacementComesBackFromMtl) {
    const test::TempDir dir;
    prep::Scene scene = triangle();
    scene.materials.resize(1);
    prep::Material& m = scene.materials[0];
    m.name = "a";
    scene.meshes[0].face_materials = {0};
    scene.images.emplace_back();
    scene.images[0].path = dir / "height.png";
    test::write_text(dir / "height.png", "no picture yet");
    scene.textures.emplace_back();
    scene.textures[0].image = 0;
    m.displacement_map.texture = 0;
    for (const glm::vec2& values : {glm::vec2(1, 0), glm::vec2(0.1f, 0.5f), glm::vec2(-3, 0.25f),
                                    glm::vec2(1, 0.7f), glm::vec2(2, 0)}) {
        m.displacement_scale = values.x;
        m.displacement_midlevel = values.y;
        ASSERT_TRUE(prep::save_scene(test::untouched(scene), dir / "a.obj"));
        const auto again = prep::load_scene(dir / "a.obj");
        ASSERT_TRUE(again);
        ASSERT_EQ(again->materials.size(), 1u);
        EXPECT_TRUE(again->materials[0].displacement_map);
        EXPECT_EQ(again->materials[0].displacement_scale, values.x);
        EXPECT_EQ(again->materials[0].displacement_midlevel, values.y);
    }
    m.displacement_kind = prep::DisplacementKind::vector_object;
    const auto notes = prep::save_scene(test::untouched(scene), dir / "a.obj");
    ASSERT_TRUE(notes);
    EXPECT_EQ(std::count(notes->begin(), notes->end(), "MTL has no vector displacement: left out"),
              1);
    EXPECT_EQ(test::file_text(dir / "a.mtl").find("disp"), std::string::npos);
}

TEST(Save, OpaqueMaterialsStayOpaqueInMtl) {
    const test::TempDir dir;
    prep::Material material;
    material.diffuse.a = 0.5f;
    EXPECT_NE(mtl_of(dir, material).find("\nd 1\n"), std::string::npos);
    material.alpha_mode = prep::AlphaMode::blend;
    EXPECT_NE(mtl_of(dir, material).find("\nd 0.5\n"), std::string::npos);
    // What a mask leaves is as opaque.
    material.alpha_mode = prep::AlphaMode::mask;
    EXPECT_NE(mtl_of(dir, material).find("\nd 1\n"), std::string::npos);
}

TEST(Save, WhatMtlAndColoursOfObjLoseIsTold) {
    const test::TempDir dir;
    prep::Scene scene = triangle();
    scene.materials.resize(1);
    scene.materials[0].alpha_mode = prep::AlphaMode::mask;
    scene.materials[0].double_sided = true;
    scene.meshes[0].face_materials = {0};
    scene.meshes[0].colors.assign(2, {{{1, 1, 1, 0.5f}}, {0, 0, 0}});
    const auto notes = prep::save_scene(test::untouched(scene), dir / "test.obj");
    ASSERT_TRUE(notes.has_value());
    for (const char* text : {"MTL has no alpha masks: what they cut out is drawn",
                             "MTL has no double-sided materials: left out",
                             "OBJ holds colours without alpha: left out",
                             "OBJ holds one set of colours: the others are left out"})
        EXPECT_EQ(std::count(notes->begin(), notes->end(), text), 1) << text;
}

TEST(Save, ValuesThatAreNotFiniteAreTold) {
    prep::Scene scene = triangle();
    scene.meshes[0].positions[1].x = std::numeric_limits<float>::quiet_NaN();
    scene.meshes[0].uvs.push_back(
        {{{0, 0}, {std::numeric_limits<float>::infinity(), 0}}, {0, 0, 1}});
    const test::TempDir dir;
    for (const char* name : {"a.obj", "a.ply", "a.off", "a.stl"}) {
        const auto notes = prep::save_scene(test::untouched(scene), dir / name);
        ASSERT_TRUE(notes.has_value()) << name;
        const auto told = [&](const std::string& what) {
            return std::count(notes->begin(), notes->end(),
                              what + " not finite and written so: many programs refuse the file");
        };
        EXPECT_EQ(told("1 vertex is"), 1) << name;
        EXPECT_EQ(told("1 UV is"), std::string(name) == "a.stl" ? 0 : 1) << name;
    }
}

TEST(Save, StlIsTheSameTheSecondTime) {
    // A facet along the axes: its normal has zeros of either sign, as chance has it.
    const prep::Scene scene =
        parse("v 0 0 0\nv -1 0 0\nv 0 1 0\nv 0 0 -1\nf 1 2 3\nf 1 3 4\nf 4 2 1\nf 2 4 3\n");
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(test::untouched(scene), dir / "a.stl").has_value());
    const auto again = prep::load_scene(dir / "a.stl");
    ASSERT_TRUE(again.has_value());
    ASSERT_TRUE(prep::save_scene(test::untouched(*again), dir / "b.stl").has_value());
    const std::string bytes = test::file_text(dir / "a.stl");
    EXPECT_EQ(test::file_text(dir / "b.stl"), bytes);
    for (std::size_t f = 0; f < 4; ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            float x = 0;
            std::memcpy(&x, bytes.data() + 84 + 50 * f + 4 * k, 4);
            EXPECT_FALSE(x == 0 && std::signbit(x));
        }
}

// What would be an empty file is none.
TEST(Save, NothingIsWrittenWhereNothingWouldBeInIt) {
    const test::TempDir dir;
    prep::Scene unseen = triangle();
    unseen.nodes.clear();
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.off"}) {
        const auto saved = prep::save_scene(test::untouched(unseen), dir / name);
        ASSERT_FALSE(saved) << name;
        EXPECT_NE(saved.error().text.find("shows no mesh"), std::string::npos);
    }
    EXPECT_TRUE(prep::save_scene(test::untouched(unseen), dir / "a.glb"));
    for (const char* text : {"v 0 0 0\nv 1 0 0\nl 1 2\n", "v 0 0 0\np 1\n"}) {
        const auto saved = prep::save_scene(test::untouched(parse(text)), dir / "a.stl");
        ASSERT_FALSE(saved) << text;
        EXPECT_NE(saved.error().text.find("STL holds triangles alone"), std::string::npos);
    }
    EXPECT_EQ(dir.names(), std::vector<std::string>{"a.glb"});
}

TEST(Save, RoundingIsTold) {
    const test::TempDir dir;
    for (const double along : {2.0, 1e-9}) {
        prep::Scene scene = triangle();
        scene.nodes[0].transform[3].x = along;
        const auto notes = prep::save_scene(test::untouched(scene), dir / "a.stl");
        ASSERT_TRUE(notes) << prep::to_string(notes.error());
        const bool told = std::any_of(notes->begin(), notes->end(), [](const std::string& note) {
            return note.find("rounded") != std::string::npos;
        });
        EXPECT_EQ(told, along != 2.0);
    }
}

TEST(Save, ColoursThatAreNoBytesAreTold) {
    const test::TempDir dir;
    for (const float red : {0.5f, 2.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()}) {
        prep::Scene scene = triangle();
        auto& colors = scene.meshes[0].colors.emplace_back();
        colors.values = {glm::vec4(red, 0, 1, 1)};
        colors.indices = {0, 0, 0};
        const auto notes = prep::save_scene(test::untouched(scene), dir / "a.ply");
        ASSERT_TRUE(notes) << prep::to_string(notes.error());
        EXPECT_EQ(
            std::count(notes->begin(), notes->end(), "vertex colours outside 0 … 1 were clamped"),
            red == 0.5f ? 0 : 1);
        const auto read = prep::load_scene(dir / "a.ply");
        ASSERT_TRUE(read) << prep::to_string(read.error());
        const float found = read->meshes[0].colors[0].values[0].r;
        EXPECT_NEAR(found, red > 1 ? 1 : red > 0 ? red : 0, 0.004) << red;
    }
}

// Groups are names: they cut no vertex and make no primitive. Two triangles that share an edge,
// each in a group of its own, and a third of another material.
TEST(Save, GroupsBecomeNeitherVerticesNorPrimitives) {
    const prep::Scene scene = parse(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\ng left\nf 1 2 3\ng right\nf 1 3 4\n"
        "o other\nusemtl red\nf 2 5 3\n");
    const test::TempDir dir;
    const std::string note = " holds no groups within a mesh: 3 names were left out";
    const prep::PreparedScene prepared = test::untouched(scene);
    EXPECT_EQ(prepared.meshes[0].vertex_count(), 7u);  // 2 and 3 have two materials
    EXPECT_EQ(prepared.splits.material, 2u);
    const auto notes = prep::save_scene(prepared, dir / "a.glb");
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    EXPECT_EQ(*notes, std::vector<std::string>{"glTF" + note});
    const auto again = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    EXPECT_EQ(again->meshes[0].parts.size(), 2u);  // primitives
    EXPECT_EQ(again->meshes[0].vertex_count(), 7u);
    for (const auto& [ending, format] :
         std::vector<std::pair<std::string, std::string>>{{"ply", "PLY"}, {"off", "OFF"}}) {
        const auto said = prep::save_scene(prepared, dir / ("a." + ending));
        ASSERT_TRUE(said.has_value());
        EXPECT_EQ(*said, (std::vector<std::string>{format + " holds no materials: left out",
                                                   format + note}));
    }
    const auto obj = prep::save_scene(prepared, dir / "a.obj");
    ASSERT_TRUE(obj.has_value());
    EXPECT_EQ(*obj, std::vector<std::string>{});
    const auto obj_again = prep::load_scene(dir / "a.obj");
    ASSERT_TRUE(obj_again.has_value());
    EXPECT_EQ(obj_again->meshes[0].parts, (std::vector<std::string>{"left", "right", "other"}));
}

// A material with a texture on one mesh with UVs and one without: the second gets a copy without.
TEST(Save, TexturesNeedUvs) {
    const test::TempDir dir;
    const std::string png(
        "\211PNG\015\012\032\012\000\000\000\015IHDR\000\000\000\001\000\000\000\001\010\000\000"
        "\000\000:~\233U\000\000\000\012IDATx\332c`\000\000\000\002\000\001\345'"
        "\336\374\000\000\000\000IEND\256B`\202",
        67);
    test::write_text(dir / "a.png", png);
    test::write_text(dir / "a.mtl", "newmtl skin\nKd 0.5 0.25 1\nmap_Kd a.png\n");
    const std::string head = "mtllib a.mtl\nusemtl skin\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
    test::write_text(dir / "with.obj", head + "vt 0 0\nf 1/1 2/1 3/1\n");
    test::write_text(dir / "without.obj", head + "f 1 2 3\n");
    const std::string note = "maps were left out where faces have no UVs for them (1 material)";
    auto with = prep::load_scene(dir / "with.obj");
    const auto without = prep::load_scene(dir / "without.obj");
    ASSERT_TRUE(with.has_value() && without.has_value());

    auto saved = prep::save_scene(test::untouched(*without), dir / "a.glb");
    ASSERT_TRUE(saved.has_value());
    EXPECT_EQ(*saved, std::vector<std::string>{note});
    auto again = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    ASSERT_EQ(again->materials.size(), 1u);
    EXPECT_FALSE(bool(again->materials[0].diffuse_map));
    EXPECT_EQ(again->materials[0].diffuse, glm::vec4(0.5f, 0.25f, 1, 1));
    EXPECT_TRUE(again->images.empty());

    with->meshes.push_back(without->meshes[0]);
    prep::instance_unused_meshes(*with);
    saved = prep::save_scene(test::untouched(*with), dir / "a.glb");
    ASSERT_TRUE(saved.has_value());
    EXPECT_EQ(*saved, std::vector<std::string>{note});
    again = prep::load_scene(dir / "a.glb");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    ASSERT_EQ(again->materials.size(), 2u);
    EXPECT_TRUE(bool(again->materials[0].diffuse_map));
    EXPECT_FALSE(bool(again->materials[1].diffuse_map));
    EXPECT_EQ(again->materials[1].name, "skin");
    EXPECT_EQ(again->meshes[0].face_materials, std::vector<std::uint32_t>{0});
    EXPECT_EQ(again->meshes[1].face_materials, std::vector<std::uint32_t>{1});
}

// A mesh whose only UVs are of set 1: formats that number sets without gaps have zeros before it,
// those that hold one hold it, and nobody is told that it was left out.
TEST(Save, TheOneSetOfUvsThereIsIsWritten) {
    prep::Scene scene = triangle();
    prep::Mesh& mesh = scene.meshes[0];
    mesh.uvs.resize(2);
    mesh.uvs[1].values = {{0.25f, 0.5f}, {0.5f, 0.5f}, {0.25f, 0.75f}};
    mesh.uvs[1].indices = {0, 1, 2};
    const std::vector<glm::vec2> own = mesh.uvs[1].values;
    const auto prepared = prep::prepare(std::move(scene));
    ASSERT_TRUE(prepared);
    const test::TempDir dir;
    for (const char* name : {"a.glb", "a.ply", "a.off", "a.obj"}) {
        const auto notes = prep::save_scene(*prepared, dir / name);
        ASSERT_TRUE(notes) << prep::to_string(notes.error());
        for (const std::string& note : *notes)
            EXPECT_EQ(note.find("UV set"), std::string::npos) << name << ": " << note;
        const auto again = prep::load_scene(dir / name);
        ASSERT_TRUE(again) << prep::to_string(again.error());
        const auto& sets = again->meshes[0].uvs;
        const bool gltf = std::string(name) == "a.glb";
        ASSERT_EQ(sets.size(), gltf ? 2u : 1u) << name;
        EXPECT_EQ(sets.back().values, own) << name;
        if (!gltf) continue;
        for (const glm::vec2& uv : sets[0].values) EXPECT_EQ(uv, glm::vec2(0.0f));
    }
}

TEST(ObjRoundTrip, PolygonsNegativeIndicesAndPartialAttributes) {
    expect_obj_round_trip(
        "v 0.1 -0 1e-42\nv 3.4e38 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 2 0\nv nan inf 0\n"
        "vt 0.1 0.3\nvt 0.7 1e-9\nvt -3.5 12.25\nvn 0.6 0.8 0\nvn 0 0 -1\n"
        "f -6 -5 -4 -3 -2\nf 1/1 2/2 3/3\nf 1//1 2//2 3//-1\nf 1/1/1 2/-1/-1 4/3/2\nf 1 1 2\n"
        "l 1 2 3\nl 4 5\np 5\np 6\n");
}

TEST(ObjRoundTrip, SmoothingGroupsMaterialsAndParts) {
    expect_obj_round_trip(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no body\ns 1\nf 1 2 3\ng lid\ns off\nf 1 2 3\ns 7\n"
        "f 3 2 1\ng a/b c\nf 1 2 3\no other\nf 1 2 3\n");
}

TEST(ObjRoundTrip, SubdivisionTags) {
    expect_obj_round_trip(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 0\nf 1 2 3 4\nf 4 3 5\n"
        "t crease 3/2/0 0 1 2 5.0 0.1\nt corner 1/1/0 3 2.5\nt hole 1/0/0 1\n"
        "t interpolateboundary 1/0/0 2\nt facevaryinginterpolateboundary 1/0/0 3\n");
}

// Where some have one: OBJ alone holds that.
TEST(Save, FormatsOfAllUvsOrNoneTellOfThoseThatAreMissing) {
    const test::TempDir dir;
    const prep::Scene scene =
        parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.5\nf 1/1 2/1 3\nf 1 3 2\nf 1/1 2/1 3/1\n");
    for (const auto& [ending, format] : std::vector<std::pair<std::string, std::string>>{
             {"glb", "glTF"}, {"ply", "PLY"}, {"off", "OFF"}, {"obj", "OBJ"}, {"stl", "STL"}}) {
        const auto notes = prep::save_scene(test::untouched(scene), dir / ("a." + ending));
        ASSERT_TRUE(notes.has_value()) << ending;
        EXPECT_EQ(std::count(notes->begin(), notes->end(),
                             format + " holds UVs of all corners or of none: 4 corners without "
                                      "one got zeros"),
                  ending == "obj" || ending == "stl" ? 0 : 1)
            << ending;
    }
}

TEST(Save, OtherFormatsTellOfSubdivisionTags) {
    const test::TempDir dir;
    const prep::Scene scene = parse(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt crease 2/1/0 0 1 5.0\n"
        "t crease 2/1/0 1 2 5.0\nt corner 1/1/0 3 2.5\nt hole 1/0/0 0\n");
    for (const auto& [ending, format] : std::vector<std::pair<std::string, std::string>>{
             {"glb", "glTF"}, {"ply", "PLY"}, {"stl", "STL"}, {"off", "OFF"}, {"obj", ""}}) {
        const auto notes = prep::save_scene(test::untouched(scene), dir / ("a." + ending));
        ASSERT_TRUE(notes.has_value()) << ending;
        EXPECT_EQ(std::count(notes->begin(), notes->end(),
                             format + " holds no tags of subdivision, creases, corners and holes: "
                                      "4 left out"),
                  format.empty() ? 0 : 1)
            << ending;
    }
}

TEST(ObjRoundTrip, Colours) {
    expect_obj_round_trip(
        "v 0 0 0 0.1 0.2 0.3\nv 1 0 0 1 0 0.7\nv 0 1 0 0 0 1\nf 1 2 3\nf 3 2 1\n");
    expect_obj_round_trip("v 0 0 0 0.1 0.2 0.3\nv 1 0 0 1 0 0.7\np 1\np 2\n");
}

TEST(ObjRoundTrip, FarFromTheOrigin) {
    expect_obj_round_trip(
        "v 5000000.1 -3000000.7 10.3\nv 5000001.1 -3000000.7 10.3\nv 5000001.1 -3000001.9 10.3\n"
        "v 5000000.123456789 -3000001.7 11.3\nf 1 2 3 4\n");
}

TEST(Save, LargeMeshesReadBackWhole) {
    // Of several blocks, so that the writers have some to join.
    prep::Scene scene;
    scene.meshes.push_back(shapes::torus(300, 300));
    prep::instance_unused_meshes(scene);
    const test::TempDir dir;
    const auto prepared = test::untouched(scene);
    for (const char* ending : {".obj", ".ply", ".glb"}) {
        const auto a = dir / (std::string("a") + ending), b = dir / (std::string("b") + ending);
        ASSERT_TRUE(prep::save_scene(prepared, a).has_value());
        ASSERT_TRUE(prep::save_scene(prepared, b).has_value());
        EXPECT_EQ(test::file_text(a), test::file_text(b));
        const auto again = prep::load_scene(a);
        ASSERT_TRUE(again.has_value());
        if (std::string(ending) != ".glb") {
            EXPECT_EQ(test::exact_difference(scene.meshes[0], again->meshes[0]), "") << ending;
        }
    }
}

TEST(ObjRoundTrip, Corpus) {
    MESHPREP_REQUIRE_SHARED(shared);
    for (const char* name : {"beast.obj", "spider/spider.obj", "suzanne.obj", "beetle.obj",
                             "subdiv/catmark_cube_creases1.obj", "tower_holes.obj"}) {
        auto scene = prep::load_scene(shared / "corpus" / name);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        const test::TempDir dir;
        ASSERT_TRUE(prep::save_scene(test::untouched(*scene), dir / "out.obj").has_value());
        const auto again = prep::load_scene(dir / "out.obj");
        ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
        EXPECT_EQ(test::exact_difference(scene->meshes[0], again->meshes[0]), "") << name;
    }
}

}  // namespace
