// load_scene: which reader gets a file, what is refused before any reader, and the whole corpus
// against the counts of its list.
#include "prep/load.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <thread>

#include "formats/gltf/gltf.h"
#include "formats/obj/obj.h"
#include "invariants.h"
#include "mesh_files.h"
#include "prep/files.h"
#include "prep/mesh.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;

std::string error_of(const fs::path& path) {
    const auto scene = prep::load_scene(path);
    return scene ? "no error" : scene.error().text;
}

const char* const obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const char* const off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const char* const stl =
    "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
    "endfacet\nendsolid\n";
const char* const ply =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
    "3 0 1 2\n";

TEST(LoadScene, EndingsInAnyCase) {
    const test::TempDir dir;
    const std::pair<const char*, const char*> files[] = {
        {"a.obj", obj}, {"a.OBJ", obj}, {"b.Off", off}, {"c.STL", stl}, {"d.pLy", ply}};
    for (const auto& [name, text] : files) {
        test::write_text(dir / name, text);
        const auto scene = prep::load_scene(dir / name);
        ASSERT_TRUE(scene.has_value()) << name << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].face_count(), 1u);
        EXPECT_EQ(scene->source, dir / name);
        EXPECT_EQ(scene->nodes.size(), 1u);
    }
}

TEST(LoadScene, UnknownEndingsAreReadByTheirFirstBytes) {
    const test::TempDir dir;
    int n = 0;
    for (const char* text : {obj, off, stl, ply}) {
        for (const char* ending : {"", ".dat"}) {
            const fs::path path = dir / ("file" + std::to_string(n++) + ending);
            test::write_text(path, text);
            const auto scene = prep::load_scene(path);
            ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
            EXPECT_EQ(scene->meshes[0].face_count(), 1u);
        }
    }
    std::string loud = stl;
    loud.replace(loud.find("solid"), 5, "SoLID");
    test::write_text(dir / "loud.dat", loud);
    EXPECT_TRUE(prep::load_scene(dir / "loud.dat"));
    test::write_text(dir / "x.dat", "neither this nor that");
    EXPECT_EQ(error_of(dir / "x.dat"),
              "unknown file type '.dat': GLB, glTF, OBJ, PLY, STL, OFF, OM, JSON scenes and the "
              "formats of Assimp (FBX, DAE, 3DS, …) are read");
}

TEST(LoadScene, OffIsRecognisedWithAnyPrefix) {
    const test::TempDir dir;
    const std::pair<const char*, const char*> files[] = {
        {"OFF", "0 0 0"},
        {"COFF", "0 0 0 255 0 0"},
        {"NOFF", "0 0 0 0 0 1"},
        {"STOFF", "0 0 0 0.5 0.5"},
        {"STCN4OFF", "0 0 0 1 0 0 1 255 0 0 0.5 0.5"}};
    for (const auto& [word, vertex] : files) {
        std::string text = std::string(word) + "\n3 1 0\n";
        for (int k = 0; k < 3; ++k) text += std::string(vertex) + "\n";
        test::write_text(dir / "mesh.data", text + "3 0 1 2\n");
        const auto scene = prep::load_scene(dir / "mesh.data");
        ASSERT_TRUE(scene.has_value()) << word << prep::to_string(scene.error());
        EXPECT_EQ(scene->meshes[0].face_count(), 1u) << word;
    }
}

TEST(LoadScene, CoordinatesBeyondFloatsAreToldWhateverTheirAxis) {
    const test::TempDir dir;
    test::write_text(dir / "a.obj",
                     "v 0 1e39 0\nv 0 0 -1e39\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\nf 2 3 4\n");
    const auto scene = prep::load_scene(dir / "a.obj");
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(std::count(scene->warnings.begin(), scene->warnings.end(),
                         "3 vertices are infinite, or beyond the range of float (3.4e38)"),
              1);
}

// Of pipes nobody knows how much will come.
TEST(ReadFile, PipesAreReadToTheirEnd) {
    const test::TempDir dir;
    std::string text = "v 1 2 3\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    while (text.size() < 200000) text += "# " + std::to_string(text.size()) + "\n";
    for (const bool as_mesh : {false, true}) {
        const auto pipe = dir / (as_mesh ? "pipe.obj" : "pipe");
        ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
        std::thread writer([&] { test::write_text(pipe, text); });
        if (as_mesh) {
            const auto scene = prep::load_obj(pipe);
            writer.join();
            ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
            ASSERT_EQ(scene->meshes[0].face_count(), 1u);
            EXPECT_EQ(scene->meshes[0].positions[0], glm::vec3(1, 2, 3));
        } else {
            const auto bytes = prep::read_file(pipe);
            writer.join();
            ASSERT_TRUE(bytes.has_value()) << prep::to_string(bytes.error());
            EXPECT_TRUE(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) ==
                        text);
        }
    }
}

TEST(LoadScene, GltfInstancesThatAreNotDrawnAreToldOf) {
    const std::string text = R"({"asset": {"version": "2.0"},
  "extensionsUsed": ["EXT_mesh_gpu_instancing"],
  "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                 "min": [0, 0, 0], "max": [1, 1, 0]}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
  "nodes": [{"mesh": 0},
            {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {
                "attributes": {"TRANSLATION": 0}}}}],
  "scenes": [{"nodes": [0, 1]}]})";
    const auto scene = prep::parse_gltf(std::as_bytes(std::span(text.data(), text.size())));
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_NE(scene->warnings[0].find("(nodes 1)"), std::string::npos) << scene->warnings[0];
}

TEST(LoadScene, WhatIsNoFileIsRefused) {
    const test::TempDir dir;
    test::write_text(dir / "empty.ply", "");
    EXPECT_EQ(error_of(dir / "empty.ply"), "the file is empty");
    EXPECT_EQ(error_of(dir.path()), "this is a directory; name a file");
    EXPECT_EQ(error_of(dir / "gone.obj"), "no such file");
    const auto missing = prep::load_scene(dir / "gone.obj");
    EXPECT_EQ(missing.error().place, (dir / "gone.obj").string());
}

TEST(LoadScene, TheWrongEndingIsAnErrorThatSaysWhatWasExpected) {
    const test::TempDir dir;
    test::write_text(dir / "a.ply", obj);
    EXPECT_EQ(error_of(dir / "a.ply"), "expected \"ply\": not a PLY file in 'v 0 0 0'");
    test::write_text(dir / "a.stl", obj);
    EXPECT_EQ(error_of(dir / "a.stl"),
              "neither \"solid\" at the beginning nor a binary header of 84 bytes: not STL");
    test::write_text(dir / "a.off", ply);
    EXPECT_EQ(error_of(dir / "a.off"),
              "expected OFF and the numbers of vertices, faces and edges in 'ply'");
    test::write_text(dir / "a.om", ply);
    EXPECT_EQ(error_of(dir / "a.om"), "expected \"OM\" at the beginning: not an OM file");
}

TEST(SetPositions, OriginOnlyWhereFloatsWouldLoseDigits) {
    prep::Mesh mesh;
    const glm::dvec3 near[] = {{0.1, 0.2, 0.3}, {1.1, 0.2, 0.3}};
    prep::set_positions(mesh, near);
    EXPECT_EQ(mesh.origin, glm::dvec3(0.0));
    EXPECT_EQ(mesh.positions[0], glm::vec3(0.1f, 0.2f, 0.3f));
    const glm::dvec3 far_floats[] = {{5e6, 0, 0}, {5e6 + 1, 0, 0}};
    prep::set_positions(mesh, far_floats);
    EXPECT_EQ(mesh.origin, glm::dvec3(0.0));
    const glm::dvec3 far[] = {{1e9 + 0.1, 0, 0}, {1e9 + 1.1, 0, 0}};
    prep::set_positions(mesh, far);
    EXPECT_EQ(mesh.origin, glm::dvec3(1e9 + 0.625, 0, 0));  // on the grid of 1/16
    // The error of a coordinate is a float's rounding at the mesh's size, not at its distance.
    EXPECT_NEAR(mesh.origin.x + double(mesh.positions[0].x), 1e9 + 0.1, 1e-7);
    EXPECT_EQ(mesh.origin.x + double(mesh.positions[1].x), 1e9 + 1.1);
}

// Their sum would be infinite, their centre is not.
TEST(SetPositions, TheCentreOfTwoOfTheLargestIsFinite) {
    prep::Mesh mesh;
    const std::vector<glm::dvec3> far{{1.6e308, 0, 0}, {1.6e308, 1, 0.1}};
    prep::set_positions(mesh, far);
    EXPECT_EQ(mesh.origin.x, 1.6e308);
    EXPECT_EQ(mesh.positions[0].x, 0);
    EXPECT_EQ(mesh.positions[1].x, 0);
}

// docs/conventions.md: further from zero than 8 times the extent, here a diagonal of 1.
TEST(SetPositions, OriginBeginsBeyondEightExtents) {
    for (const double at : {7.95, 8.05})
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 corners[2] = {glm::dvec3(0.1), glm::dvec3(0.1)};  // no floats
            corners[0][axis] = at - 0.5;
            corners[1][axis] = at + 0.5;
            prep::Mesh mesh;
            prep::set_positions(mesh, corners);
            EXPECT_EQ(mesh.origin != glm::dvec3(0), at > 8) << at << " " << axis;
        }
}

TEST(SetPositions, ExtremesStayFinite) {
    const double largest = std::numeric_limits<double>::max(), nan = std::nan("");
    prep::Mesh mesh;
    const glm::dvec3 huge[] = {{largest, largest, largest}, {-largest, 0.1, 0}};
    prep::set_positions(mesh, huge);
    EXPECT_TRUE(std::isfinite(mesh.origin.x));
    const glm::dvec3 far[] = {{largest, 0.1, 0}, {largest * (1 - 1e-9), 0.1, 0}};
    prep::set_positions(mesh, far);
    EXPECT_TRUE(std::isfinite(mesh.origin.x));
    const glm::dvec3 tiny[] = {{1e-300, 0, 0}, {1.00001e-300, 0, 0}};
    prep::set_positions(mesh, tiny);
    EXPECT_TRUE(std::isfinite(mesh.origin.x));
    const glm::dvec3 point[] = {{0.1, 0.2, 0.3}};
    prep::set_positions(mesh, point);
    EXPECT_EQ(mesh.origin + glm::dvec3(mesh.positions[0]), point[0]);
    const glm::dvec3 broken[] = {{nan, 0, 0}, {1e9 + 0.1, 0, 0}, {1e9 + 1.3, 0, 0}};
    prep::set_positions(mesh, broken);
    EXPECT_TRUE(std::isnan(mesh.positions[0].x));
    EXPECT_GT(mesh.origin.x, 9e8);
    prep::set_positions(mesh, {});
    EXPECT_TRUE(mesh.positions.empty());
}

// "{v: 3932, f: 7880, …}" → 3932 for "v"; −1 where it is not said.
long measured(const std::string& text, const std::string& key) {
    for (const char* before : {"{", ", "}) {
        const std::size_t at = text.find(before + key + ": ");
        if (at != std::string::npos)
            return std::atol(text.c_str() + at + std::string(before).size() + key.size() + 2);
    }
    return -1;
}

TEST(LoadScene, TheCorpusHasTheCountsOfItsList) {
    MESHPREP_REQUIRE_SHARED(shared);
    std::ifstream list(shared / "corpus/MANIFEST.tsv");
    std::string line;
    std::getline(list, line);
    int checked = 0;
    while (std::getline(list, line)) {
        const std::string file = line.substr(0, line.find('\t'));
        std::string ending = fs::path(file).extension().string();
        for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
        if (ending != ".obj" && ending != ".ply" && ending != ".stl" && ending != ".off") continue;
        const auto scene = prep::load_scene(shared / "corpus" / file);
        ASSERT_TRUE(scene.has_value()) << file << ": " << prep::to_string(scene.error());
        EXPECT_EQ(test::broken_promise(*scene), "") << file;
        const std::string counts = line.substr(line.rfind('\t') + 1);
        const long vertices = measured(counts, "v"), triangles = measured(counts, "f");
        if (vertices < 0 || triangles < 0) continue;
        const prep::Mesh& mesh = scene->meshes[0];
        // The list counts triangles and the different positions.
        EXPECT_EQ(long(mesh.corner_count() - 2 * mesh.face_count()), triangles) << file;
        std::set<std::array<float, 3>> different;
        for (const glm::vec3& p : mesh.positions) different.insert({p.x, p.y, p.z});
        // Two vertices of this one are one when rounded to float.
        const bool close = file == "openscad-nonmanifold-crash.obj";
        EXPECT_EQ(long(different.size()), vertices - (close ? 1 : 0)) << file;
        const long quads = measured(counts, "quads");
        if (quads >= 0) {
            long found = 0;
            for (std::size_t f = 0; f < mesh.face_count(); ++f)
                found += mesh.face_offsets[f + 1] - mesh.face_offsets[f] == 4;
            EXPECT_EQ(found, quads) << file;
        }
        const long uvs = measured(counts, "vt");
        if (uvs > 0) {
            EXPECT_EQ(long(mesh.uvs.at(0).values.size()), uvs) << file;
        }
        const long normals = measured(counts, "vn");
        if (normals > 0) {
            EXPECT_EQ(long(mesh.normals.values.size()), normals) << file;
        }
        ++checked;
    }
    EXPECT_GE(checked, 20);
}

}  // namespace
