// glTF files written in formats that hold less: what is kept has its values, what is not is told.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "gltf_maker.h"
#include "gltf_source.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace {

using Json = test::GltfSource::Json;
using Notes = std::vector<std::string>;

// A triangle on a node that turns x → y → −x, doubles and moves by (10, 20, 30); beside it whatever
// other formats do not hold.
test::GltfSource rich() {
    test::GltfSource d;
    const std::size_t positions = d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    Json attributes{{"POSITION", positions},
                    {"NORMAL", d.add_floats("VEC3", {1, 0, 0, 0, 1, 0, 0, 0, 1})},
                    {"TEXCOORD_0", d.add_floats("VEC2", {0, 0.25f, 1, 0.5f, 0, 1})},
                    {"_PAIN", d.add_floats("SCALAR", {1, 2, 3})},
                    {"JOINTS_0", d.add("VEC4", std::vector<std::uint8_t>(12, 0))},
                    {"WEIGHTS_0", d.add_floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})}};
    Json points = attributes;
    points.erase("JOINTS_0");
    points.erase("WEIGHTS_0");
    points.erase("_PAIN");
    points.erase("TEXCOORD_0");
    const Json target{{"POSITION", positions}};
    d.json["meshes"] = {{{"primitives",
                          {{{"attributes", attributes}, {"targets", {target, target}}},
                           {{"attributes", points}, {"mode", 0}, {"targets", {target, target}}}}}}};
    d.json["nodes"] = {
        {{"mesh", 0}, {"matrix", {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 10, 20, 30, 1}}},
        {{"name", "bone"}, {"skin", 0}, {"mesh", 0}}};
    d.json["skins"] = {{{"joints", {1}}}};
    const std::size_t times = d.add_floats("SCALAR", {0, 1});
    d.json["animations"] = {
        {{"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}},
         {"samplers", {{{"input", times}, {"output", d.add_floats("VEC3", {0, 0, 0, 1, 1, 1})}}}}}};
    d.json["animations"].push_back(d.json["animations"][0]);
    return d;
}

Notes notes_of(test::GltfSource d, const std::string& name, std::string* text = nullptr) {
    const test::TempDir dir;
    d.write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    if (!scene) return {};
    const auto notes = prep::save_scene(test::untouched(*std::move(scene)), dir / name);
    EXPECT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    if (text) *text = test::file_text(dir / name);
    return notes ? *notes : Notes{};
}

bool told(const Notes& notes, const std::string& note) {
    return std::count(notes.begin(), notes.end(), note) == 1;
}

TEST(GltfLost, OtherFormatsTellWhatTheyDoNotHold) {
    for (const auto& [ending, format] : std::vector<std::pair<std::string, std::string>>{
             {"ply", "PLY"}, {"stl", "STL"}, {"off", "OFF"}, {"obj", "OBJ"}, {"OBJ", "OBJ"}}) {
        const Notes notes = notes_of(rich(), "out." + ending);
        EXPECT_TRUE(told(notes,
                         "normals, UVs and materials of lines and points are kept from glTF to "
                         "glTF only: those of 1 primitive were left out"))
            << ending;
        EXPECT_TRUE(told(notes, format + " holds no attributes of other names: _PAIN left out"));
        EXPECT_TRUE(told(notes, format + " holds no morph targets: 2 left out")) << ending;
        EXPECT_TRUE(told(notes, format + " holds no animations: 2 left out")) << ending;
        EXPECT_TRUE(told(notes, format + " holds no skins: left out")) << ending;
    }
}

// Of a primitive: as it is in glTF, told of what has one list for all.
TEST(GltfLost, UvsThatPrimitivesLackAreTold) {
    test::GltfSource d;
    const std::size_t positions = d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    const Json bare{{"attributes", {{"POSITION", positions}}}};
    Json mapped = bare;
    mapped["attributes"]["TEXCOORD_0"] = d.add_floats("VEC2", {0, 0, 1, 0, 0, 1});
    d.json["meshes"] = {{{"primitives", {mapped, bare}}}};
    d.json["nodes"] = {{{"mesh", 0}}};
    const auto uvs = [](const Notes& notes) {
        Notes out;
        for (const std::string& note : notes)
            if (note.find("UVs of all corners") != std::string::npos) out.push_back(note);
        return out;
    };
    EXPECT_EQ(uvs(notes_of(d, "out.glb")), Notes{});
    EXPECT_EQ(uvs(notes_of(d, "out.ply")),
              Notes{"PLY holds UVs of all corners or of none: 3 corners without one got zeros"});
}

// Lines stand before the faces of their mesh, for behind them they would have their material.
TEST(GltfLost, LinesInObjHaveNoMaterialOfFaces) {
    test::GltfSource d;
    const std::size_t positions = d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    const Json attributes{{"POSITION", positions}};
    const Json face{{"attributes", attributes}, {"material", 0}};
    const Json points{{"attributes", attributes}, {"mode", 0}, {"material", 1}};
    d.json["materials"] = {{{"name", "red"}}, {{"name", "blue"}}};
    d.json["meshes"] = {{{"name", "solid"}, {"primitives", {face}}},
                        {{"name", "marks"}, {"primitives", {points, face}}}};
    d.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}}};
    std::string obj;
    const Notes notes = notes_of(d, "out.obj", &obj);
    EXPECT_TRUE(told(notes,
                     "normals, UVs and materials of lines and points are kept from glTF to glTF "
                     "only: those of 1 primitive were left out"));
    std::vector<std::string> states;
    std::istringstream lines(obj);
    for (std::string line; std::getline(lines, line);)
        if (line[0] == 'o' || line[0] == 'u' || line[0] == 'p' || line[0] == 'f')
            states.push_back(line.substr(0, line.find("//")));
    EXPECT_EQ(states, (Notes{"o solid", "usemtl red", "f 1 2 3", "o marks", "usemtl default", "p 4",
                             "p 5", "p 6", "usemtl red", "f 7 8 9"}));
    // What they name is in the library, also where no face is without a material.
    const test::TempDir dir;
    d.write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    ASSERT_TRUE(scene.has_value());
    ASSERT_TRUE(prep::save_scene(test::untouched(*std::move(scene)), dir / "out.obj").has_value());
    EXPECT_NE(test::file_text(dir / "out.mtl").find("newmtl default\n"), std::string::npos);
}

TEST(GltfLost, CamerasAndLightsAreTold) {
    test::GltfSource d = rich();
    d.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
    d.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    d.json["extensionsUsed"].push_back("KHR_lights_punctual");
    d.json["nodes"].push_back({{"camera", 0}});
    d.json["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    for (const auto& [ending, format] : std::vector<std::pair<std::string, std::string>>{
             {"ply", "PLY"}, {"stl", "STL"}, {"off", "OFF"}, {"obj", "OBJ"}})
        EXPECT_TRUE(told(notes_of(d, "out." + ending),
                         format + " holds no cameras, lights, skins: left out"))
            << ending;
}

// A face's map reads the set that it read, though OBJ has one for each corner; a map that reads
// another is left out. A face without a material stays one that the library says all of.
TEST(GltfLost, FacesOfObjHaveTheUvsThatTheirMapsRead) {
    test::GltfSource d;
    Json triangle{{"attributes",
                   {{"POSITION", d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0})},
                    {"TEXCOORD_0", d.add_floats("VEC2", {0, 0, 1, 0, 0, 1})},
                    {"TEXCOORD_1", d.add_floats("VEC2", {0.25f, 0.5f, 0.5f, 0.5f, 0.5f, 0.25f})}}}};
    Json plain = triangle, second = triangle;
    plain["material"] = 0;
    second["material"] = 1;
    d.json["meshes"] = {{{"primitives", {plain, second, triangle}}}};
    d.json["images"] = {{{"uri", "a.png"}}, {{"uri", "b.png"}}};
    d.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
    const auto colour = [](int set) {
        return Json{{"baseColorTexture", {{"index", 0}, {"texCoord", set}}}};
    };
    d.json["materials"] = {{{"name", "plain"}, {"pbrMetallicRoughness", colour(0)}},
                           {{"name", "second"},
                            {"pbrMetallicRoughness", colour(1)},
                            {"normalTexture", {{"index", 1}, {"texCoord", 0}}},
                            {"extensions",
                             {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                              {"KHR_materials_sheen", {{"sheenRoughnessFactor", 0.5}}},
                              {"KHR_materials_clearcoat",
                               {{"clearcoatFactor", 1}, {"clearcoatTexture", {{"index", 1}}}}}}}}};
    d.json["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_sheen",
                                "KHR_materials_clearcoat"};
    d.json["nodes"] = {{{"mesh", 0}}};
    const test::TempDir dir;
    d.write(dir / "in.gltf");
    auto scene = prep::load_scene(dir / "in.gltf");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const auto notes = prep::save_scene(test::untouched(*std::move(scene)), dir / "out.obj");
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    EXPECT_TRUE(told(*notes,
                     "OBJ holds one UV set: maps that read another than their material's first "
                     "are left out"));
    EXPECT_TRUE(told(*notes,
                     "OBJ holds nothing of these extensions of materials: "
                     "KHR_materials_transmission, maps of KHR_materials_clearcoat: left out"));
    EXPECT_EQ(test::file_text(dir / "out.mtl").find("b.png"), std::string::npos);
    const auto again = prep::load_scene(dir / "out.obj");
    ASSERT_TRUE(again.has_value()) << prep::to_string(again.error());
    for (const std::string& warning : again->warnings)
        EXPECT_EQ(warning.find("material"), std::string::npos) << warning;
    const prep::Mesh& mesh = again->meshes[0];
    ASSERT_EQ(mesh.face_count(), 3u);
    for (std::size_t f = 0; f < 3; ++f) {
        const glm::vec2 first = mesh.uvs[0].values[mesh.uvs[0].indices[mesh.face_offsets[f]]];
        EXPECT_EQ(first, f == 1 ? glm::vec2(0.25f, 0.5f) : glm::vec2(0)) << f;
    }
}

// Heights keep to the points, which are written where the node puts them.
TEST(GltfLost, HeightsOfObjAreScaledAsThePointsAre) {
    prep::Scene scene;
    scene.meshes.emplace_back();
    prep::Mesh& mesh = scene.meshes[0];
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.corner_vertices = {0, 1, 2};
    mesh.face_offsets = {0, 3};
    mesh.face_materials = {0};
    scene.images.emplace_back();
    scene.images[0].path = "h.png";
    scene.textures.push_back({.image = 0});
    prep::Material material;
    material.name = "m";
    material.displacement_map.texture = 0;
    material.displacement_scale = 0.25f;
    material.displacement_midlevel = 0.5f;
    scene.materials = {material};
    for (const glm::dvec3& scale : {glm::dvec3(10), glm::dvec3(10, 10, 5)}) {
        scene.nodes.clear();
        scene.nodes.emplace_back();
        scene.nodes[0].mesh = 0;
        scene.nodes[0].trs.emplace();
        scene.nodes[0].trs->scale = scale;
        scene.nodes[0].transform = scene.nodes[0].trs->matrix();
        const test::TempDir dir;
        const auto notes = prep::save_scene(test::untouched(scene), dir / "a.obj");
        ASSERT_TRUE(notes) << prep::to_string(notes.error());
        EXPECT_NE(test::file_text(dir / "a.mtl").find("disp -mm -1.25 2.5 "), std::string::npos)
            << test::file_text(dir / "a.mtl");
        EXPECT_EQ(told(*notes,
                       "MTL has one scale of heights for a material: where nodes scale it "
                       "differently, it is that of the first"),
                  scale.z == 5);
    }
}

TEST(GltfLost, NothingIsToldOfWhatIsNotThere) {
    test::GltfSource d;
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0})}}}},
           {{"attributes",
             {{"POSITION", d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0})}}},
            {"mode", 0}}}}}};
    d.json["nodes"] = {{{"mesh", 0}}};
    EXPECT_EQ(notes_of(d, "out.obj"), Notes{});
}

// What the file's scene does not show, no other format has a place for.
test::GltfSource two_scenes() {
    test::GltfSource d;
    for (const float z : {0.0f, 5.0f})
        d.push("meshes",
               Json{{"primitives",
                     {{{"attributes",
                        {{"POSITION", d.add_positions({0, 0, z, 1, 0, z, 0, 1, z})}}}}}}});
    d.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}}};
    d.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
    d.json["scene"] = 0;
    return d;
}

TEST(GltfLost, MeshesOfOtherScenesAreTold) {
    std::string text;
    const Notes notes = notes_of(two_scenes(), "out.obj", &text);
    EXPECT_EQ(notes, Notes{"1 mesh that the file's scene does not show was left out"});
    EXPECT_EQ(text.find(" 5\n"), std::string::npos) << text;
    EXPECT_EQ(notes_of(two_scenes(), "out.glb"), Notes{});
}

// Nodes with a mesh, in a scene file that names the glTF as its only mesh.
std::size_t shown_by_scene_file(const test::GltfSource& d) {
    const test::TempDir dir;
    d.write(dir / "in.glb");
    test::write_text(dir / "a.json", R"({"meshprep":1,"meshes":{"m":{"file":"in.glb"}}})");
    const auto scene = prep::load_scene(dir / "a.json");
    EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    if (!scene) return 0;
    return std::size_t(
        std::count_if(scene->nodes.begin(), scene->nodes.end(),
                      [](const prep::Node& node) { return node.mesh != prep::no_index; }));
}

TEST(GltfLost, ScenesOfJsonShowWhatTheGltfShows) {
    EXPECT_EQ(shown_by_scene_file(two_scenes()), 1u);
    // A collection without nodes shows nothing by itself: a scene that names it does.
    test::GltfSource collection = two_scenes();
    for (const char* key : {"nodes", "scenes", "scene"}) collection.json.erase(key);
    EXPECT_EQ(shown_by_scene_file(collection), 2u);
}

// The files beside a glTF document are its buffers: no OBJ file reads its materials from them.
TEST(GltfLost, ObjInThePlaceOfItsSourceHasItsMaterials) {
    const test::TempDir dir;
    test::GltfSource d = two_scenes();
    d.json["materials"] = {{{"name", "red"}}};
    d.json["meshes"][0]["primitives"][0]["material"] = 0;
    d.write(dir / "a.gltf");
    auto scene = prep::load_scene(dir / "a.gltf");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    scene->libraries = {dir / "a.bin"};
    prep::SaveOptions options;
    options.replace_sources = true;
    ASSERT_TRUE(prep::save_scene(test::untouched(*scene), dir / "b.obj", options).has_value());
    EXPECT_NE(test::file_text(dir / "b.obj").find("mtllib b.mtl\n"), std::string::npos);
    EXPECT_NE(test::file_text(dir / "b.mtl").find("newmtl red\n"), std::string::npos);
}

TEST(GltfLost, ObjHasThePlacesNormalsAndUvsOfItsNodes) {
    test::GltfSource d = rich();
    d.json["nodes"].erase(1);
    for (const char* key : {"skins", "animations"}) d.json.erase(key);
    d.json["meshes"][0]["primitives"].erase(1);
    d.json["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0");
    d.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
    std::string text;
    notes_of(d, "out.obj", &text);
    std::vector<std::vector<double>> v, vn, vt;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string key;
        words >> key;
        std::vector<double> numbers;
        for (double x; words >> x;) numbers.push_back(x);
        if (key == "v") v.push_back(numbers);
        if (key == "vn") vn.push_back(numbers);
        if (key == "vt") vt.push_back(numbers);
        if (key == "f") {
            EXPECT_EQ(line, "f 1/1/1 2/2/2 3/3/3");
        }
    }
    using Rows = std::vector<std::vector<double>>;
    EXPECT_EQ(v, (Rows{{10, 20, 30}, {10, 22, 30}, {8, 20, 30}}));
    EXPECT_EQ(vn, (Rows{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}));
    EXPECT_EQ(vt, (Rows{{0, 0.75}, {1, 0.5}, {0, 0}}));  // v counts from the bottom
}

// A .bin beside the output must not take the place of what the scene still reads.
TEST(GltfLost, FilesThatTheSceneWasReadFromAreSpared) {
    const test::TempDir dir;
    test::write_text(dir / "out.bin", "a picture, whatever its name");
    test::write_text(dir / "in.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    auto scene = prep::load_scene(dir / "in.obj");
    ASSERT_TRUE(scene.has_value());
    scene->images.resize(2);
    scene->images[0].path = dir / "out.bin";
    const prep::PreparedScene prepared = test::untouched(*scene);
    const auto refused = prep::save_scene(prepared, dir / "out.gltf");
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().place, (dir / "out.bin").string());
    EXPECT_NE(refused.error().text.find("read for the result"), std::string::npos);
    EXPECT_EQ(test::file_text(dir / "out.bin"), "a picture, whatever its name");
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"in.obj", "out.bin"}));
    prep::SaveOptions options;
    options.replace_sources = true;
    EXPECT_TRUE(prep::save_scene(prepared, dir / "out.gltf", options).has_value());
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"in.obj", "out.bin", "out.gltf"}));
}

// A triangle; what its file says of the buffer, of the bufferView and of the accessor.
TEST(GltfLost, WhatIsSaidOfDataStaysOrIsTold) {
    test::GltfMaker maker;
    maker.mesh({{{"attributes",
                  {{"POSITION", maker.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")},
                   {"NORMAL", maker.accessor<float>({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3")}}}}});
    Json document = Json::parse(maker.gltf());
    document["buffers"][0]["name"] = "scan 7";
    document["buffers"][0]["extras"] = {{"licence", "CC0"}};
    for (const char* list : {"accessors", "bufferViews"})
        for (Json& item : document[list]) item["extras"] = {{"of", list}};
    Json two = document;
    two["buffers"].push_back(two["buffers"][0]);
    two["bufferViews"][1]["buffer"] = 1;
    // A buffer that stands for what meshopt has compressed is none of several.
    document["extensionsUsed"] = {"EXT_meshopt_compression"};
    document["buffers"].push_back(
        {{"byteLength", 4}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    const std::string dropped =
        "extras of accessors and bufferViews whose data was replaced were left out";
    const std::string merged =
        "the file's buffers became one: their names and extras were left out";
    for (const bool replaced : {false, true})
        for (const bool several : {false, true})
            for (const char* name : {"out.glb", "out.gltf"}) {
                const test::TempDir dir;
                test::write_text(dir / "in.gltf", (several ? two : document).dump());
                auto scene = prep::load_scene(dir / "in.gltf");
                ASSERT_TRUE(scene) << prep::to_string(scene.error());
                prep::PrepareOptions options;
                if (replaced) options.normals = prep::Authored::replace;
                const auto prepared = prep::prepare(*std::move(scene), options);
                ASSERT_TRUE(prepared) << prep::to_string(prepared.error());
                const auto notes = prep::save_scene(*prepared, dir / name);
                ASSERT_TRUE(notes) << prep::to_string(notes.error());
                EXPECT_EQ(told(*notes, dropped), replaced);
                EXPECT_EQ(told(*notes, merged), several);
                const test::GltfFile file(dir / name);
                const test::GltfFile::Json& buffer = file.json["buffers"][0];
                EXPECT_EQ(buffer.value("name", ""), several ? "" : "scan 7");
                EXPECT_EQ(buffer.contains("extras"), !several);
                if (replaced) continue;
                const auto& primitive = file.primitive(0, 0);
                const std::size_t points = primitive["attributes"]["POSITION"];
                EXPECT_EQ(file.json["accessors"][points]["extras"]["of"], "accessors");
                const std::size_t view = file.json["accessors"][points]["bufferView"];
                EXPECT_EQ(file.json["bufferViews"][view]["extras"]["of"], "bufferViews");
            }
}

TEST(GltfLost, SecondColoursAndVariantsAreTold) {
    test::GltfSource d;
    const std::vector<float> red = {1, 0, 0, 1, 0, 0, 1, 0, 0}, green = {0, 1, 0, 0, 1, 0, 0, 1, 0};
    d.json["extensionsUsed"] = {"KHR_materials_variants"};
    d.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "other"}}};
    d.json["materials"] = {{{"name", "a"}}, {{"name", "b"}}};
    const Json mapping{{"material", 1}, {"variants", {0}}};
    d.json["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", d.add_positions(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0})},
              {"COLOR_0", d.add_floats("VEC3", red)},
              {"COLOR_1", d.add_floats("VEC3", green)}}},
            {"material", 0},
            {"extensions", {{"KHR_materials_variants", {{"mappings", {mapping}}}}}}}}}}};
    d.json["nodes"] = {{{"mesh", 0}}};
    for (const std::string format : {"PLY", "OFF", "OBJ", "STL"}) {
        std::string name = "out." + format;
        for (char& c : name) c = char(std::tolower(c));
        const Notes notes = notes_of(d, name);
        EXPECT_EQ(told(notes, format + " holds one set of colours: the others are left out"),
                  format != "STL")
            << format;
        EXPECT_TRUE(told(notes, format + " holds no material variants: left out")) << format;
    }
}

// Tangents are of a mesh here, of primitives there: what one has, another need not.
TEST(GltfLost, PrimitivesWithoutTangentsAreNotSplitForThem) {
    test::GltfSource d;
    const auto strip = [&](float far, bool tangents) {
        std::vector<float> positions;
        for (const float y : {0.0f, 1.0f})
            for (const float x : {0.0f, 1.0f, 2.0f})
                positions.insert(positions.end(), {x + far, y, 0});
        // Mirrored in the middle.
        Json attributes{{"POSITION", d.add_positions(positions)},
                        {"NORMAL", d.add_floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1,  //
                                                         0, 0, 1, 0, 0, 1, 0, 0, 1})},
                        {"TEXCOORD_0", d.add_floats("VEC2", {0, 0, 1, 0, 0, 0, 0, 1, 1, 1, 0, 1})}};
        if (tangents)
            attributes["TANGENT"] = d.add_floats("VEC4", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1,  //
                                                          1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
        return Json{{"attributes", attributes},
                    {"indices", d.add("SCALAR", std::vector<std::uint16_t>{0, 1, 4, 0, 4, 3,  //
                                                                           1, 2, 5, 1, 5, 4})}};
    };
    const Json with = strip(0, true), without = strip(5, false);
    d.json["meshes"] = {{{"primitives", {with, without}}}};
    d.json["nodes"] = {{{"mesh", 0}}};
    const test::TempDir dir;
    d.write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    prep::PrepareOptions options;
    options.document_stays = true;
    const auto prepared = prep::prepare(*std::move(scene), options);
    ASSERT_TRUE(prepared.has_value()) << prep::to_string(prepared.error());
    for (const prep::Finding& finding : prepared->findings)
        EXPECT_NE(finding.kind, "missing-tangent");
    EXPECT_EQ(prepared->meshes.at(0).vertex_count(), 12u);
    EXPECT_EQ(prepared->splits.mirrored_uv, 0u);
}

}  // namespace
