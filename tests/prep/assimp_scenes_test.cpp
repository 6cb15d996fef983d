// Cameras, lights and companion files of what Assimp reads, by what the formats say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "formats/assimp/texts/dxf_text.h"
#include "formats/assimp/texts/x3d_text.h"
#include "prep/load.h"
#include "temporary_files.h"

namespace {

namespace fs = std::filesystem;

constexpr double degree = std::numbers::pi / 180;

prep::Scene load(const fs::path& path) {
    auto scene = prep::load_scene(path);
    EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    return scene ? *std::move(scene) : prep::Scene{};
}
prep::Scene load_text(const char* name, const std::string& text) {
    const test::TempDir dir;
    test::write_text(dir / name, text);
    return load(dir / name);
}
bool scene_warns(const prep::Scene& scene, const std::string& part) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(), [&](const std::string& text) {
        return text.find(part) != std::string::npos;
    });
}
// Where the file's own camera stands, and which way it looks.
struct Seen {
    glm::dvec3 from{0.0}, along{0.0};
};
Seen seen(const prep::Scene& scene) {
    if (scene.active_camera == prep::no_index) return {};
    const glm::dmat4 world = prep::world_transforms(scene).at(scene.active_camera);
    return {glm::dvec3(world[3]), -glm::normalize(glm::dvec3(world[2]))};
}
void expect_near(const glm::dvec3& found, const glm::dvec3& expected) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1e-5) << k;
}

TEST(AssimpScenes, TheFilesCameraIsTheOneThatLooks) {
    const Seen view = seen(load_text("a.nff",
                                     "v\nfrom 0 0 10\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\n"
                                     "resolution 64 64\nf 1 0 0 0.7 0.3 20 0 1\ns 0 0 0 1\n"));
    expect_near(view.from, {0, 0, 10});
    expect_near(view.along, {0, 0, -1});
}

// 3ds Max: along −Z of the node, whose rows are x, y and z of the world, z up.
TEST(AssimpScenes, CamerasOfAseLookAlongMinusZ) {
    const Seen view = seen(load_text(
        "a.ase",
        "*3DSMAX_ASCIIEXPORT 200\n*CAMERAOBJECT {\n *NODE_NAME \"Cam\"\n *CAMERA_TYPE Target\n"
        " *NODE_TM {\n  *NODE_NAME \"Cam\"\n  *TM_ROW0 1 0 0\n  *TM_ROW1 0 0 1\n"
        "  *TM_ROW2 0 -1 0\n  *TM_ROW3 0 -10 0\n }\n *CAMERA_SETTINGS {\n  *TIMEVALUE 0\n"
        "  *CAMERA_NEAR 0.1\n  *CAMERA_FAR 100\n  *CAMERA_FOV 0.8\n }\n}\n"));
    expect_near(view.from, {0, 0, 10});  // y up
    expect_near(view.along, {0, 0, -1});
}

std::string lws(const std::string& objects) {
    std::string text = "LWSC\n3\n\nFirstFrame 0\nLastFrame 60\nFramesPerSecond 30\n\n" + objects +
                       "AddCamera 30000000\nCameraName Cam\nCameraMotion\nNumChannels 3\n";
    for (int k = 0; k < 3; ++k)
        text += "Channel " + std::to_string(k) + "\n{ Envelope\n  1\n  Key " +
                (k == 2 ? "-10" : "0") + " 0 0 0 0 0 0 0 0\n  Behaviors 1 1\n}\n";
    return text + "ZoomFactor 3.2\n";
}

// LightWave's z points away from who looks along it.
TEST(AssimpScenes, CamerasOfLightWaveLookAlongItsZ) {
    const Seen view = seen(load_text("a.lws", lws("")));
    expect_near(view.from, {0, 0, 10});
    expect_near(view.along, {0, 0, -1});
}

std::string lwo_triangle(float size) {
    const auto chunk = [](const std::string& id, const std::string& data) {
        const auto n = static_cast<std::uint32_t>(data.size());
        return id + std::string{char(n >> 24), char(n >> 16), char(n >> 8), char(n)} + data;
    };
    std::string points;
    for (const float v : {0.0f, 0.0f, 0.0f, size, 0.0f, 0.0f, 0.0f, size, 0.0f}) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &v, 4);
        for (int k = 24; k >= 0; k -= 8) points += char(bits >> k);
    }
    const std::string faces = std::string("FACE") + std::string("\0\3\0\0\0\1\0\2", 8);
    const std::string tags = "SURF" + std::string(4, '\0');
    return chunk("FORM", "LWO2" + chunk("TAGS", std::string("red\0", 4)) +
                             chunk("LAYR", std::string(18, '\0')) + chunk("PNTS", points) +
                             chunk("POLS", faces) + chunk("PTAG", tags) +
                             chunk("SURF", std::string("red\0\0\0", 6)));
}

// Beside the scene, not where the program was started; those that are not there are told.
TEST(AssimpScenes, FilesThatAModelNamesLieBesideIt) {
    const test::TempDir dir;
    fs::create_directories(dir / "model");
    fs::create_directories(dir / "elsewhere");
    const auto write = [&](const fs::path& path, const std::string& bytes) {
        test::write_text(path, bytes);
    };
    write(dir / "model/a.lwo", lwo_triangle(1));
    write(dir / "elsewhere/a.lwo", lwo_triangle(50));
    write(dir / "elsewhere/b.lwo", lwo_triangle(50));
    write(dir / "model/a.lws", lws("LoadObjectLayer 1 a.lwo\nShowObject 7 3\n"
                                   "LoadObjectLayer 1 b.lwo\nShowObject 7 3\n"));
    const fs::path started = fs::current_path();
    fs::current_path(dir / "elsewhere");
    const prep::Scene scene = load(dir / "model/a.lws");
    const prep::Scene near = load("../model/a.lws");
    fs::current_path(started);
    for (const prep::Scene* s : {&scene, &near}) {
        float largest = 0;
        for (const prep::Mesh& mesh : s->meshes)
            for (const glm::vec3& p : mesh.positions) largest = std::max(largest, p.x);
        EXPECT_EQ(largest, 1);
        EXPECT_TRUE(scene_warns(*s, "not there: b.lwo"));
        EXPECT_TRUE(s->library_missing);
    }
    EXPECT_EQ(scene.libraries, std::vector<fs::path>{dir / "model/a.lwo"});
    EXPECT_EQ(near.libraries, std::vector<fs::path>{"../model/a.lwo"});
}

TEST(AssimpScenes, ConesOfX3dAreFromTheirAxis) {
    const test::TempDir dir;
    test::write_text(dir / "a c.png", "a picture");
    test::write_text(
        dir / "a.x3d",
        "<?xml version=\"1.0\"?><X3D><Scene><SpotLight DEF=\"s\" cutOffAngle=\"0.6\" "
        "beamWidth=\"0.3\"/><Shape><Appearance><Material shininess=\"0.5\"/><ImageTexture "
        "url='\"a c.png\" \"b.png\"'/></Appearance><IndexedFaceSet solid=\"false\" "
        "coordIndex=\"0 1 2 -1\"><Coordinate point=\"0 0 0 1 0 0 0 1 0\"/><TextureCoordinate "
        "point=\"0 0 1 0 0 1\"/></IndexedFaceSet></Shape></Scene></X3D>");
    const prep::Scene scene = load(dir / "a.x3d");
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_NEAR(scene.lights[0].outer_cone, 0.6, 1e-6);
    EXPECT_NEAR(scene.lights[0].inner_cone, 0.3, 1e-6);
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.images[0].path.filename(), "a c.png");
    EXPECT_EQ(scene.nodes.at(0).name, "a.x3d");
    ASSERT_GE(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].shininess, 64);  // ISO/IEC 19775-1, 17.2.2.4: 128 times as much
    EXPECT_TRUE(scene.materials[0].double_sided);
}

TEST(AssimpScenes, UrlsOfX3dAreTheFirstOfTheirLists) {
    using prep::detail::with_plain_urls;
    EXPECT_EQ(with_plain_urls("<A url='\"x y.png\" \"z\"' b='1'/>"), "<A url='x%20y.png' b='1'/>");
    EXPECT_EQ(with_plain_urls("<A b='url' url = \"&quot;x&quot; &quot;z&quot;\"/><B/>"),
              "<A b='url' url = \"x\"/><B/>");
    EXPECT_EQ(with_plain_urls("<A url='\"\"'/>"), "<A url=''/>");
    for (const char* text : {"<A url='x.png'/>", "<A curl='\"x\"'/>", "<A url", "<A url='\"x", "",
                             "url='\"x\"'", "<!-- <A url='\"x\"'/> -->"})
        EXPECT_FALSE(with_plain_urls(text)) << text;
}

TEST(AssimpScenes, WhatX3dLosesIsTold) {
    using prep::detail::misread_of_x3d;
    for (const char* text :
         {"<S normalPerVertex='false'/>", "<S coordIndex='0 1 2' texCoordIndex='0 1 1'/>",
          "<Cone/>", "<Billboard><Shape/></Billboard>",
          "<Shape><Appearance/></Shape><Shape><Box/></Shape>"})
        EXPECT_EQ(misread_of_x3d(text).size(), 1u) << text;
    for (const char* text : {"<S coordIndex='0 1 2' texCoordIndex='0 1 2'/>",
                             "<Shape><Box/></Shape>", "<Shape USE='a'/><Shape USE='b'/>"})
        EXPECT_TRUE(misread_of_x3d(text).empty()) << text;
    EXPECT_EQ(misread_of_x3d("<Text/><Viewpoint/><Text/>"),
              std::vector<std::string>{
                  "elements that Assimp leaves out with what they hold: 2 Text, 1 Viewpoint"});
}

std::string chunk(std::uint16_t id, const std::string& data) {
    const auto n = static_cast<std::uint32_t>(data.size() + 6);
    return std::string{char(id),     char(id >> 8), char(n),
                       char(n >> 8), char(n >> 16), char(n >> 24)} +
           data;
}
std::string floats(std::initializer_list<float> values) {
    std::string out;
    for (const float v : values) out.append(reinterpret_cast<const char*>(&v), 4);
    return out;
}

// A lens of 35 mm shows 2400 / 35 degrees, by lib3ds; hotspot and falloff are from rim to rim.
TEST(AssimpScenes, LensesAndSpotsOf3ds) {
    const std::string camera =
        chunk(0x4000, std::string("cam\0", 4) + chunk(0x4700, floats({0, -5, 0, 0, 0, 0, 0, 35})));
    const std::string spot = chunk(
        0x4000, std::string("spot\0", 5) +
                    chunk(0x4600, floats({0, 0, 5}) + chunk(0x4610, floats({0, 0, 0, 40, 60}))));
    const std::string triangle = chunk(
        0x4000, std::string("t\0", 2) +
                    chunk(0x4100, chunk(0x4110, std::string("\3\0", 2) +
                                                    floats({0, 0, 0, 1, 0, 0, 0, 1, 0})) +
                                      chunk(0x4120, std::string("\1\0\0\0\1\0\2\0\7\0", 10))));
    const prep::Scene scene =
        load_text("a.3ds", chunk(0x4d4d, chunk(0x3d3d, triangle + camera + spot)));
    ASSERT_EQ(scene.cameras.size(), 1u);
    const double across = 2 * std::atan(std::tan(scene.cameras[0].yfov / 2) * 4 / 3);
    EXPECT_NEAR(across, 2400.0 / 35 * degree, 1e-5);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_NEAR(scene.lights[0].inner_cone, 20 * degree, 1e-5);
    EXPECT_NEAR(scene.lights[0].outer_cone, 30 * degree, 1e-5);
}

TEST(AssimpScenes, UnitsOfIfcAreTold) {
    const prep::Scene scene = load_text(
        "a.ifc",
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
        "FILE_NAME('x','2020-01-01T00:00:00',(''),(''),'','','');\nFILE_SCHEMA(('IFC2X3'));\n"
        "ENDSEC;\nDATA;\n#1=IFCPERSON($,'a','b',$,$,$,$,$);\n#2=IFCORGANIZATION($,'o',$,$,$);\n"
        "#3=IFCPERSONANDORGANIZATION(#1,#2,$);\n#4=IFCAPPLICATION(#2,'1','a','a');\n"
        "#5=IFCOWNERHISTORY(#3,#4,$,.ADDED.,$,$,$,0);\n"
        "#6=IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.);\n"
        "#7=IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.);\n#8=IFCUNITASSIGNMENT((#6,#7));\n"
        "#10=IFCCARTESIANPOINT((0.,0.,0.));\n#11=IFCDIRECTION((0.,0.,1.));\n"
        "#12=IFCDIRECTION((1.,0.,0.));\n#13=IFCAXIS2PLACEMENT3D(#10,#11,#12);\n"
        "#14=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#13,$);\n"
        "#15=IFCPROJECT('a',#5,'p',$,$,$,$,(#14),#8);\n#20=IFCLOCALPLACEMENT($,#13);\n"
        "#21=IFCSITE('b',#5,'site',$,$,#20,$,$,.ELEMENT.,$,$,$,$,$);\n"
        "#22=IFCRELAGGREGATES('c',#5,$,$,#15,(#21));\n#33=IFCCARTESIANPOINT((0.,0.));\n"
        "#34=IFCDIRECTION((1.,0.));\n#35=IFCAXIS2PLACEMENT2D(#33,#34);\n"
        "#36=IFCRECTANGLEPROFILEDEF(.AREA.,$,#35,400.,600.);\n"
        "#37=IFCEXTRUDEDAREASOLID(#36,#13,#11,1000.);\n"
        "#38=IFCSHAPEREPRESENTATION(#14,'Body','SweptSolid',(#37));\n"
        "#39=IFCPRODUCTDEFINITIONSHAPE($,$,(#38));\n"
        "#40=IFCBUILDINGELEMENTPROXY('d',#5,'box',$,$,#20,#39,$,$);\n"
        "#41=IFCRELCONTAINEDINSPATIALSTRUCTURE('e',#5,$,$,(#40),#21);\nENDSEC;\n"
        "END-ISO-10303-21;\n");
    EXPECT_NEAR(scene.placement.file_unit, 0.001, 1e-9);
    EXPECT_EQ(scene.placement.file_unit_source, "IFC unit, z up");
}

std::string dxf(const std::string& entities) {
    return "0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n";
}

// DXF Reference: an edge from a negative number is not to be drawn; its face is there all the same.
TEST(AssimpScenes, FacesOfDxfWithHiddenEdgesStayWhole) {
    std::string text = "0\nPOLYLINE\n8\nP\n66\n1\n70\n64\n71\n3\n72\n1\n";
    for (const char* at : {"0.0 0.0", "1.0 0.0", "0.0 1.0"})
        text += "0\nVERTEX\n8\nP\n70\n192\n10\n" + std::string(at, 3) + "\n20\n" + (at + 4) +
                "\n30\n0.0\n";
    text +=
        "0\nVERTEX\n8\nP\n70\n128\n10\n0.0\n20\n0.0\n30\n0.0\n 71\n     1\n 72\n    -2\n 73\n-3\n"
        "0\nSEQEND\n";
    const prep::Scene scene = load_text("a.dxf", dxf(text));
    ASSERT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.meshes[0].face_count(), 1u);
    EXPECT_EQ(scene.meshes[0].face_offsets[1], 3u);
    EXPECT_FALSE(prep::detail::with_positive_corners(dxf("0\nVERTEX\n10\n-1.0\n71\n1\n")));
    EXPECT_FALSE(prep::detail::with_positive_corners(dxf("0\nLINE\n71\n-1\n")));
    EXPECT_EQ(prep::detail::with_positive_corners("0\nVERTEX\n74\n-3"), "0\nVERTEX\n74\n 3");
}

// The AutoCAD Color Index; no material of Assimp's tints it.
TEST(AssimpScenes, ColoursOfDxfAreThoseOfAutocad) {
    const auto face = [](const std::string& color) {
        return "0\n3DFACE\n8\nL" + color + "\n62\n" + color +
               "\n10\n0.0\n20\n0.0\n30\n0.0\n11\n1.0\n21\n0.0\n31\n0.0\n12\n0.0\n22\n1.0\n32\n0.0\n"
               "13\n0.0\n23\n1.0\n33\n0.0\n";
    };
    const std::pair<const char*, glm::vec4> numbers[] = {
        {"1", {1, 0, 0, 1}}, {"2", {1, 1, 0, 1}}, {"3", {0, 1, 0, 1}}, {"4", {0, 1, 1, 1}},
        {"5", {0, 0, 1, 1}}, {"6", {1, 0, 1, 1}}, {"7", {1, 1, 1, 1}}};
    for (const auto& [number, color] : numbers) {
        const prep::Scene scene = load_text("a.dxf", dxf(face(number)));
        ASSERT_EQ(scene.meshes.size(), 1u);
        ASSERT_EQ(scene.meshes[0].colors.size(), 1u);
        EXPECT_EQ(scene.meshes[0].colors[0].values.at(0), color) << number;
        EXPECT_EQ(scene.materials.at(0).diffuse, glm::vec4(1.0f));
        EXPECT_FALSE(scene_warns(scene, "colours"));
    }
    EXPECT_TRUE(scene_warns(load_text("a.dxf", dxf(face("30"))), "above 9"));
    // By layer.
    const prep::Scene scene =
        load_text("a.dxf",
                  "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n0\nLAYER\n2\nL256\n62\n4\n0\n"
                  "ENDTAB\n0\nENDSEC\n" +
                      dxf(face("256")));
    EXPECT_EQ(scene.meshes.at(0).colors.at(0).values.at(0), glm::vec4(0, 1, 1, 1));
}

TEST(AssimpScenes, EntitiesOfDxfThatAreNotReadAreNamed) {
    using prep::detail::misread_of_dxf;
    EXPECT_EQ(misread_of_dxf(dxf("0\nCIRCLE\n0\nTEXT\n0\nCIRCLE\n0\n3DFACE\n")),
              std::vector<std::string>{"entities that Assimp does not read: 2 CIRCLE, 1 TEXT"});
    EXPECT_EQ(misread_of_dxf("0\nSECTION\n2\nBLOCKS\n0\nINSERT\n0\nENDSEC\n").size(), 1u);
    EXPECT_EQ(misread_of_dxf(dxf("0\nINSERT\n70\n3\n0\nINSERT\n230\n-1.0\n")).at(0).substr(103),
              "2 are misplaced");
    EXPECT_TRUE(misread_of_dxf("0\nSECTION\n2\nOBJECTS\n0\nVISUALSTYLE\n420\n1\n").empty());
    EXPECT_EQ(misread_of_dxf("0\rSECTION\r2\rENTITIES\r0\rTEXT\r").size(), 1u);
    EXPECT_TRUE(misread_of_dxf("0\nSECTION\n2\nTABLES\n0\nLAYER\n62\n200\n0\nENDSEC\n").empty());
}

// A camera of a file that says nothing of clip planes shows what is far as well as what is near.
TEST(AssimpScenes, CamerasWithoutClipPlanesCutNothing) {
    const prep::Scene scene = load_text("a.lws", lws(""));
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].zfar, 0);
    EXPECT_LE(scene.cameras[0].znear, 0.01);
}

}  // namespace
