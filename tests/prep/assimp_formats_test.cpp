// FBX, DAE and 3DS, as another program writes them: Assimp's exporters, on a mesh made here.
#include <assimp/scene.h>
#include <assimp/version.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <assimp/Exporter.hpp>
#include <cmath>
#include <memory>

#include "formats/assimp/texts/x3d_text.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/version.h"

namespace {

// A tetrahedron with a UV at each corner, whose v counts from the bottom as Assimp has it.
const std::array<std::array<float, 3>, 4> points = {{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}}};
const std::array<std::array<unsigned, 3>, 4> faces = {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
std::array<float, 2> uv_of(unsigned face, unsigned corner) {
    return {0.125f * float(face), 0.25f * float(corner)};
}

std::unique_ptr<aiScene> tetrahedron() {
    auto scene = std::make_unique<aiScene>();
    scene->mMaterials = new aiMaterial* [1] { new aiMaterial() };
    scene->mNumMaterials = 1;
    aiString name("stone");
    scene->mMaterials[0]->AddProperty(&name, AI_MATKEY_NAME);
    auto* mesh = new aiMesh();
    scene->mMeshes = new aiMesh* [1] { mesh };
    scene->mNumMeshes = 1;
    mesh->mName = "m";
    mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
    mesh->mNumVertices = 12;
    mesh->mVertices = new aiVector3D[12];
    mesh->mTextureCoords[0] = new aiVector3D[12];
    mesh->mNumUVComponents[0] = 2;
    mesh->mNumFaces = 4;
    mesh->mFaces = new aiFace[4];
    for (unsigned f = 0; f < 4; ++f) {
        mesh->mFaces[f].mNumIndices = 3;
        mesh->mFaces[f].mIndices = new unsigned[3];
        for (unsigned c = 0; c < 3; ++c) {
            const unsigned i = 3 * f + c;
            const auto& p = points[faces[f][c]];
            mesh->mVertices[i] = {p[0], p[1], p[2]};
            mesh->mTextureCoords[0][i] = {uv_of(f, c)[0], uv_of(f, c)[1], 0};
            mesh->mFaces[f].mIndices[c] = i;
        }
    }
    scene->mRootNode = new aiNode();
    scene->mRootNode->mNumMeshes = 1;
    scene->mRootNode->mMeshes = new unsigned[1]{0};
    return scene;
}

// Triangles in the world, each turned so that its least corner comes first, and sorted.
struct Corner {
    glm::dvec3 position;
    glm::dvec2 uv;
};
using TriangleCorners = std::array<Corner, 3>;
bool before(const Corner& a, const Corner& b) {
    for (int k = 0; k < 3; ++k)
        if (std::abs(a.position[k] - b.position[k]) > 1e-4) return a.position[k] < b.position[k];
    return false;
}
std::vector<TriangleCorners> sorted(std::vector<TriangleCorners> triangles) {
    for (TriangleCorners& t : triangles)
        std::rotate(t.begin(), std::min_element(t.begin(), t.end(), before), t.end());
    std::sort(
        triangles.begin(), triangles.end(), [](const TriangleCorners& a, const TriangleCorners& b) {
            return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), before);
        });
    return triangles;
}

// What was exported, as we count: v from the top. In 3DS files z is up, which Assimp turns to y
// when it reads, not when it writes.
std::vector<TriangleCorners> exported(bool z_is_up) {
    std::vector<TriangleCorners> out;
    for (unsigned f = 0; f < 4; ++f) {
        TriangleCorners t;
        for (unsigned c = 0; c < 3; ++c) {
            const auto& p = points[faces[f][c]];
            t[c].position = z_is_up ? glm::dvec3(p[0], p[2], -p[1]) : glm::dvec3(p[0], p[1], p[2]);
            t[c].uv = {uv_of(f, c)[0], 1 - uv_of(f, c)[1]};
        }
        out.push_back(t);
    }
    return sorted(out);
}

TEST(AssimpFormats, TrianglesAndUvsOfFbxDaeAnd3dsAreThoseThatWereExported) {
    const std::unique_ptr<aiScene> source = tetrahedron();
    const test::TempDir dir;
    for (const auto& [format, name] :
         {std::pair{"fbxa", "a.fbx"}, {"collada", "a.dae"}, {"3ds", "a.3ds"}, {"x", "a.x"}}) {
        SCOPED_TRACE(name);
        Assimp::Exporter exporter;
        ASSERT_EQ(exporter.Export(source.get(), format, (dir / name).string()), aiReturn_SUCCESS)
            << exporter.GetErrorString();
        const auto scene = prep::load_scene(dir / name);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        const auto world = prep::world_transforms(*scene);
        // FBX counts in centimetres unless it says otherwise; what is loaded is metres.
        const double unit = name == std::string("a.fbx") ? 0.01 : 1;
        EXPECT_NEAR(scene->placement.factor(), unit, 1e-12);
        std::vector<TriangleCorners> found;
        for (std::size_t n = 0; n < scene->nodes.size(); ++n) {
            if (scene->nodes[n].mesh == prep::no_index) continue;
            const prep::Mesh& mesh = scene->meshes.at(scene->nodes[n].mesh);
            ASSERT_EQ(mesh.uvs.size(), 1u);
            for (std::size_t f = 0; f < mesh.face_count(); ++f) {
                ASSERT_EQ(mesh.face_offsets[f + 1] - mesh.face_offsets[f], 3u);
                TriangleCorners t;
                for (std::uint32_t c = 0; c < 3; ++c) {
                    const std::uint32_t corner = mesh.face_offsets[f] + c;
                    const glm::dvec3 p =
                        mesh.origin + glm::dvec3(mesh.positions[mesh.corner_vertices[corner]]);
                    t[c] = {glm::dvec3(world[n] * glm::dvec4(p, 1)) / unit,
                            mesh.uvs[0].values[mesh.uvs[0].indices[corner]]};
                }
                found.push_back(t);
            }
        }
        found = sorted(found);
        const std::vector<TriangleCorners> expected = exported(name == std::string("a.3ds"));
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t t = 0; t < 4; ++t)
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_LT(glm::length(found[t][c].position - expected[t][c].position), 1e-5)
                    << t << " " << c;
                EXPECT_LT(glm::length(found[t][c].uv - expected[t][c].uv), 1e-6) << t << " " << c;
            }
    }
}

// A surface of a quad for each of `surfaces`: flags and material.
std::string ac3d(const std::vector<std::pair<std::string, int>>& surfaces, const char* end) {
    std::string text = "AC3Db\n";
    for (const char* name : {"\"one\"", "\"the other\"", "bare", "\"\""})
        text += "MATERIAL " + std::string(name) +
                " rgb 1 0 0  amb 1 1 1  emis 0 0 0  spec 0 0 0  shi 64  trans 0\n";
    text +=
        "OBJECT world\nkids 1\nOBJECT poly\nname \"q\"\nnumvert 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    text += "numsurf " + std::to_string(surfaces.size()) + "\n";
    for (const auto& [flags, material] : surfaces)
        text += "SURF " + flags + "\nmat " + std::to_string(material) +
                "\nrefs 4\n0 0 0\n1 1 0\n2 1 1\n3 0 1\n";
    text += "kids 0\n";
    std::string out;
    for (const char c : text) c == '\n' ? out += end : out += c;
    return out;
}

// 0x10 is smooth, 0x20 seen from both sides.
TEST(AssimpFormats, SidesOfAc3dSurfacesAreTheirMaterials) {
    const test::TempDir dir;
    using Sides = std::map<std::string, bool>;
    const auto sides = [&](const std::vector<std::pair<std::string, int>>& surfaces,
                           const char* end = "\n") {
        test::write_text(dir / "a.ac", ac3d(surfaces, end));
        const auto scene = prep::load_scene(dir / "a.ac");
        EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        Sides out;
        if (scene)
            for (const prep::Material& material : scene->materials)
                out[material.name] = material.double_sided;
        return out;
    };
    for (const char* end : {"\n", "\r\n"}) {
        EXPECT_EQ(sides({{"0x10", 0}, {"0x30", 1}}, end),
                  (Sides{{"one", false}, {"the other", true}}));
        EXPECT_EQ(sides({{"0X20", 0}, {"0x00", 1}, {"0X10", 0}}, end),
                  (Sides{{"one", true}, {"the other", false}}));
    }
    EXPECT_EQ(sides({{"0x10", 0}, {"0x10", 1}}), (Sides{{"one", false}, {"the other", false}}));
}

// The package says which version it is, not its headers.
TEST(Dependencies, NameTheAssimpThatIsLoaded) {
    const std::string loaded = std::to_string(aiGetVersionMajor()) + "." +
                               std::to_string(aiGetVersionMinor()) + "." +
                               std::to_string(aiGetVersionPatch());
    std::string named;
    for (const prep::Dependency& dependency : prep::dependencies())
        if (dependency.name == "Assimp") named = dependency.version;
    EXPECT_EQ(named, loaded);
}

bool any_says(const std::vector<std::string>& texts, const std::string& text) {
    return std::find(texts.begin(), texts.end(), text) != texts.end();
}

TEST(AssimpFormats, WhatItMisreadsIsTold) {
    using prep::detail::misread_of_x3d;
    EXPECT_TRUE(misread_of_x3d("<X3D><IndexedFaceSet ccw=\"true\"/></X3D>").empty());
    for (const char* text : {"<IndexedLineSet >", "<S ccw = 'false'/>",
                             "<S\ncolorPerVertex=\"false\">", "<S colorIndex='0 1 -1'>", "<LOD>"})
        EXPECT_EQ(misread_of_x3d(text).size(), 1u) << text;
    for (const char* text : {"<IndexedLineSets>", "<S xccw='false'/>", "<S ccw='falsely'/>",
                             "ccw false", "<S ccw=", "<LO D>"})
        EXPECT_TRUE(misread_of_x3d(text).empty()) << text;
    EXPECT_TRUE(misread_of_x3d("a<!-- <LOD> -->b<!----><!-- <LOD> c").empty());
    const test::TempDir dir;
    test::write_text(
        dir / "a.amf",
        "<?xml version=\"1.0\"?><amf><object id=\"0\"><mesh><vertices>"
        "<vertex><coordinates><x>0</x><y>0</y><z>0</z></coordinates></vertex>"
        "<vertex><coordinates><x>1</x><y>0</y><z>0</z></coordinates></vertex>"
        "<vertex><coordinates><x>0</x><y>1</y><z>0</z></coordinates></vertex></vertices><volume>"
        "<triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume></mesh></object>"
        "<constellation id=\"3\"><instance objectid=\"0\"><deltax>5</deltax><rz>90</rz>"
        "</instance></constellation></amf>");
    const auto scene = prep::load_scene(dir / "a.amf");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_TRUE(any_says(scene->warnings, "Assimp reads rotations of instances as translations"));
}

TEST(AssimpFormats, LightsOfX3dHaveNoNamesOfMemory) {
    const test::TempDir dir;
    test::write_text(dir / "a.x3d",
                     "<?xml version=\"1.0\" encoding=\"UTF-8\"?><X3D profile=\"Immersive\" "
                     "version=\"3.2\"><Scene><Shape><Sphere radius=\"2\"/></Shape>"
                     "<DirectionalLight direction=\"0 0 -1\"/><PointLight location=\"0 9 0\"/>"
                     "<SpotLight DEF=\"SpotLight_7\" location=\"0 8 0\"/></Scene></X3D>");
    const auto scene = prep::load_scene(dir / "a.x3d");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->nodes[0].name, "a.x3d");
    std::vector<std::string> names;
    for (const prep::Node& node : scene->nodes)
        if (node.light != prep::no_index) names.push_back(node.name);
    EXPECT_EQ(names, (std::vector<std::string>{"DirectionalLight", "PointLight", "SpotLight_7"}));
    for (const prep::Light& light : scene->lights)
        EXPECT_LT(light.name.size(), std::string("DirectionalLight_").size()) << light.name;
}

TEST(AssimpFormats, MeshesOfMorphControllersAreToldAsMissing) {
    const auto geometry = [](const char* id, const char* z) {
        const std::string own = id;
        const auto at = [&](const char* xy) { return std::string(xy) + ' ' + z + ' '; };
        return "<geometry id=\"" + own + "\"><mesh><source id=\"" + own +
               "-p\"><float_array id=\"" + own + "-a\" count=\"9\">" + at("0 0") + at("1 0") +
               at("0 1") + "</float_array><technique_common><accessor source=\"#" + own +
               "-a\" count=\"3\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" "
               "type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common>"
               "</source><vertices id=\"" +
               own + "-v\"><input semantic=\"POSITION\" source=\"#" + own +
               "-p\"/></vertices><triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#" +
               own + "-v\" offset=\"0\"/><p>0 1 2</p></triangles></mesh></geometry>";
    };
    const test::TempDir dir;
    test::write_text(
        dir / "a.dae",
        "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
        "version=\"1.4.1\"><library_geometries>" +
            geometry("base", "0") + geometry("up", "1") +
            "</library_geometries><library_controllers><controller id=\"c\"><morph "
            "source=\"#base\" method=\"NORMALIZED\"><source id=\"t\"><IDREF_array id=\"t-a\" "
            "count=\"1\">up</IDREF_array><technique_common><accessor source=\"#t-a\" count=\"1\" "
            "stride=\"1\"><param name=\"MORPH_TARGET\" type=\"IDREF\"/></accessor>"
            "</technique_common></source><source id=\"w\"><float_array id=\"w-a\" count=\"1\">0.5"
            "</float_array><technique_common><accessor source=\"#w-a\" count=\"1\" stride=\"1\">"
            "<param name=\"MORPH_WEIGHT\" type=\"float\"/></accessor></technique_common></source>"
            "<targets><input semantic=\"MORPH_TARGET\" source=\"#t\"/><input "
            "semantic=\"MORPH_WEIGHT\" source=\"#w\"/></targets></morph></controller>"
            "</library_controllers><library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">"
            "<instance_controller url=\"#c\"/></node></visual_scene></library_visual_scenes><scene>"
            "<instance_visual_scene url=\"#s\"/></scene></COLLADA>");
    const auto scene = prep::load_scene(dir / "a.dae");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const bool kept = !scene->meshes.empty() && !scene->meshes[0].morph_targets.empty();
    EXPECT_NE(kept,
              any_says(scene->warnings,
                       "Assimp reads nothing of morph controllers: their meshes are missing"));
}

TEST(AssimpFormats, AxesThatTheyTurnAreTold) {
    const test::TempDir dir;
    std::string dxf;
    for (const char* line :
         {"0",  "SECTION", "2",  "ENTITIES", "0",  "3DFACE", "8",      "L",  "10",
          "0",  "20",      "0",  "30",       "0",  "11",     "4",      "21", "0",
          "31", "0",       "12", "4",        "22", "3",      "32",     "0",  "13",
          "0",  "23",      "3",  "33",       "0",  "0",      "ENDSEC", "0",  "EOF"})
        dxf += std::string("  ") + line + "\n";
    test::write_text(dir / "a.dxf", dxf);
    auto scene = prep::load_scene(dir / "a.dxf");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_TRUE(any_says(scene->remarks, "DXF files have z up: turned to y"));
    test::write_text(dir / "a.ase",
                     "*3DSMAX_ASCIIEXPORT 200\n*GEOMOBJECT {\n*NODE_NAME \"T\"\n*MESH {\n"
                     "*MESH_NUMVERTEX 3\n*MESH_NUMFACES 1\n*MESH_VERTEX_LIST {\n"
                     "*MESH_VERTEX 0 0 0 0\n*MESH_VERTEX 1 1 0 0\n*MESH_VERTEX 2 0 1 7\n}\n"
                     "*MESH_FACE_LIST {\n*MESH_FACE 0: A: 0 B: 1 C: 2 AB: 1 BC: 1 CA: 1\n}\n}\n"
                     "}\n");
    scene = prep::load_scene(dir / "a.ase");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_TRUE(any_says(scene->remarks, "ASE files have z up: turned to y"));
}

}  // namespace
