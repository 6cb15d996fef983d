// Meshes of several materials, which Assimp takes apart: files are written, and a scene of Assimp's
// member by member for what few files have.
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "formats/assimp/import.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"

namespace {

using prep::no_index;
using Indices = std::vector<std::uint32_t>;

// A tetrahedron in both files: two faces of one material, two of the other.
std::string collada(bool all_uvs = false) {
    const auto triangles = [](const char* material, const char* corners, bool uvs) {
        return std::string("<triangles material=\"") + material +
               "\" count=\"2\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>" +
               (uvs ? "<input semantic=\"TEXCOORD\" source=\"#t\" offset=\"1\" set=\"0\"/>" : "") +
               "<p>" + corners + "</p></triangles>";
    };
    const auto floats = [](const char* id, const char* values, int count, int stride,
                           const char* names) {
        std::string params;
        for (const char* name = names; *name; ++name)
            params += std::string("<param name=\"") + *name + "\" type=\"float\"/>";
        const std::string own = id;
        return "<source id=\"" + own + "\"><float_array id=\"" + own + "-a\" count=\"" +
               std::to_string(count * stride) + "\">" + values +
               "</float_array><technique_common><accessor source=\"#" + own + "-a\" count=\"" +
               std::to_string(count) + "\" stride=\"" + std::to_string(stride) + "\">" + params +
               "</accessor></technique_common></source>";
    };
    // Of the second UV set, as its number in the material says.
    const auto effect = [](const std::string& name) {
        return "<effect id=\"" + name +
               "-e\"><profile_COMMON><newparam sid=\"s\"><surface type=\"2D\"><init_from>im"
               "</init_from></surface></newparam><newparam sid=\"t\"><sampler2D><source>s</source>"
               "</sampler2D></newparam><technique sid=\"c\"><lambert><diffuse><texture "
               "texture=\"t\" texcoord=\"CHANNEL1\"/></diffuse></lambert></technique>"
               "</profile_COMMON></effect>";
    };
    const auto material = [](const std::string& name) {
        return "<material id=\"" + name + "\" name=\"" + name + "\"><instance_effect url=\"#" +
               name + "-e\"/></material>";
    };
    return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/"
           "COLLADASchema\" version=\"1.4.1\"><asset><up_axis>Y_UP</up_axis></asset>"
           "<library_images><image id=\"im\"><init_from>no.png</init_from></image>"
           "</library_images><library_effects>" +
           effect("red") + effect("blue") + "</library_effects><library_materials>" +
           material("red") + material("blue") +
           "</library_materials><library_geometries><geometry id=\"g\" name=\"shell\"><mesh>" +
           floats("p", "0 0 0 1 0 0 0 1 0 0 0 1", 4, 3, "XYZ") +
           floats("t", "0 0 1 0 0 1", 3, 2, "ST") +
           "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>" +
           triangles("red", "0 0 2 1 1 2 0 0 1 1 3 2", true) +
           (all_uvs ? triangles("blue", "1 0 2 1 3 2 2 0 0 1 3 2", true)
                    : triangles("blue", "1 2 3 2 0 3", false)) +
           "</mesh></geometry></library_geometries><library_visual_scenes>"
           "<visual_scene id=\"s\"><node id=\"n\" name=\"n\"><instance_geometry url=\"#g\">"
           "<bind_material><technique_common><instance_material symbol=\"red\" target=\"#red\"/>"
           "<instance_material symbol=\"blue\" target=\"#blue\"/></technique_common>"
           "</bind_material></instance_geometry></node>"
           "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/>"
           "</scene></COLLADA>";
}

const char* const shell_of_ac3d =
    "AC3Db\n"
    "MATERIAL \"red\" rgb 1 0 0  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 0  trans 0\n"
    "MATERIAL \"blue\" rgb 0 0 1  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 0  trans 0\n"
    "OBJECT world\nkids 1\nOBJECT poly\nname \"shell\"\nnumvert 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    "numsurf 4\n"
    "SURF 0x0\nmat 0\nrefs 3\n0 0 0\n2 0 0\n1 0 0\nSURF 0x0\nmat 0\nrefs 3\n0 0 0\n1 0 0\n3 0 0\n"
    "SURF 0x0\nmat 1\nrefs 3\n1 0 0\n2 0 0\n3 0 0\nSURF 0x0\nmat 1\nrefs 3\n2 0 0\n0 0 0\n3 0 0\n"
    "kids 0\n";

// Without a hierarchy of nodes, as Blender wrote them.
std::string file_3ds() {
    const auto put = [](std::string& to, auto value) {
        to.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const auto chunk = [&](int kind, const std::string& body) {
        std::string out;
        put(out, std::uint16_t(kind));
        put(out, std::uint32_t(6 + body.size()));
        return out + body;
    };
    const auto material = [&](const char* name) {
        return chunk(0xafff, chunk(0xa000, std::string(name) + '\0'));
    };
    const auto used = [&](const char* name, int first) {
        std::string body = std::string(name) + '\0';
        for (const int v : {2, first, first + 1}) put(body, std::uint16_t(v));
        return chunk(0x4130, body);
    };
    std::string points, faces, version;
    put(points, std::uint16_t(4));
    for (const int x : {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) put(points, float(x));
    put(faces, std::uint16_t(4));
    for (const int v : {0, 2, 1, 7, 0, 1, 3, 7, 1, 2, 3, 7, 2, 0, 3, 7})
        put(faces, std::uint16_t(v));
    put(version, std::uint32_t(3));
    return chunk(
        0x4d4d,
        chunk(2, version) +
            chunk(0x3d3d,
                  chunk(0x3d3e, version) + material("red") + material("blue") +
                      chunk(0x4000, std::string("shell") + '\0' +
                                        chunk(0x4100, chunk(0x4110, points) +
                                                          chunk(0x4120, faces + used("red", 0) +
                                                                            used("blue", 2))))));
}

using Point = std::tuple<float, float, float>;
Point point(const prep::Mesh& mesh, std::size_t vertex) {
    const glm::vec3& p = mesh.positions[vertex];
    return {p.x, p.y, p.z};
}

TEST(AssimpSplit, AMeshOfTwoMaterialsStaysOne) {
    const test::TempDir dir;
    test::write_text(dir / "a.dae", collada());
    test::write_text(dir / "a.ac", shell_of_ac3d);
    test::write_text(dir / "a.3ds", file_3ds());
    for (const char* name : {"a.dae", "a.ac", "a.3ds"}) {
        auto scene = prep::load_scene(dir / name);
        ASSERT_TRUE(scene.has_value()) << name << prep::to_string(scene.error());
        ASSERT_EQ(scene->meshes.size(), 1u) << name;
        const prep::Mesh& mesh = scene->meshes[0];
        ASSERT_EQ(mesh.face_count(), 4u) << name;
        const Indices& materials = mesh.face_materials;
        EXPECT_EQ(materials[0], materials[1]) << name;
        EXPECT_EQ(materials[2], materials[3]) << name;
        EXPECT_NE(materials[0], materials[2]) << name;
        std::size_t holders = 0;
        for (const prep::Node& node : scene->nodes) holders += node.mesh != no_index;
        EXPECT_EQ(holders, 1u) << name;
        // Each edge once in each direction.
        std::map<std::pair<Point, Point>, int> edges;
        for (std::size_t c = 0; c < 12; ++c) {
            const std::size_t next = c - c % 3 + (c + 1) % 3;
            ++edges[{point(mesh, mesh.corner_vertices[c]),
                     point(mesh, mesh.corner_vertices[next])}];
        }
        EXPECT_EQ(edges.size(), 12u) << name;
        for (const auto& [edge, count] : edges) {
            EXPECT_EQ(count, 1) << name;
            EXPECT_EQ(edges.count({edge.second, edge.first}), 1u) << name;
        }
        // A normal goes on where the material ends.
        prep::PrepareOptions options;
        options.hard_edges.angle_degrees.reset();
        const auto prepared = prep::prepare(*std::move(scene), options);
        ASSERT_TRUE(prepared.has_value()) << name;
        std::map<Point, glm::vec3> normals;
        const auto& out = prepared->meshes[0];
        for (std::size_t v = 0; v < out.vertex_count(); ++v) {
            const glm::vec3& p = out.positions[v];
            const auto [at, fresh] = normals.emplace(Point(p.x, p.y, p.z), out.normals[v]);
            EXPECT_EQ(at->second, out.normals[v]) << name;
        }
        EXPECT_EQ(normals.size(), 4u) << name;
    }
}

TEST(AssimpSplit, APartWithoutUvsHasNone) {
    const test::TempDir dir;
    test::write_text(dir / "a.dae", collada());
    const auto scene = prep::load_scene(dir / "a.dae");
    ASSERT_TRUE(scene.has_value());
    const prep::Mesh& mesh = scene->meshes[0];
    ASSERT_EQ(mesh.uvs.size(), 1u);
    for (std::size_t c = 0; c < 12; ++c) EXPECT_EQ(mesh.uvs[0].indices[c] == no_index, c >= 6) << c;
    // From the top: Collada counts from below.
    EXPECT_EQ(mesh.uvs[0].values[mesh.uvs[0].indices[1]], glm::vec2(1, 1));
}

TEST(AssimpSplit, MapsOfEachPartFindItsUvs) {
    const test::TempDir dir;
    test::write_text(dir / "a.dae", collada(true));
    const auto scene = prep::load_scene(dir / "a.dae");
    ASSERT_TRUE(scene.has_value());
    ASSERT_EQ(scene->meshes.size(), 1u);
    for (const std::size_t face : {0, 2}) {
        const prep::Material& material = scene->materials[scene->meshes[0].face_materials[face]];
        EXPECT_TRUE(bool(material.diffuse_map)) << face;
        EXPECT_EQ(material.diffuse_map.uv_set, 0u) << face;
    }
}

// A triangle whose corners are 10·x, 10·x + 1, …, with a bone, a target and a material.
aiMesh* part(unsigned x, const char* name, const char* bone) {
    auto* mesh = new aiMesh();
    mesh->mName = name;
    mesh->mMaterialIndex = x;
    mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
    mesh->mNumVertices = 3;
    mesh->mVertices = new aiVector3D[3];
    for (unsigned v = 0; v < 3; ++v)
        mesh->mVertices[v] = {float(10 * x + v), float(v == 1), float(v == 2)};
    mesh->mNumFaces = 1;
    mesh->mFaces = new aiFace[1];
    mesh->mFaces[0].mNumIndices = 3;
    mesh->mFaces[0].mIndices = new unsigned[3]{0, 1, 2};
    auto* of = new aiBone();
    of->mName = bone;
    of->mNumWeights = 2;
    of->mWeights = new aiVertexWeight[2]{{x % 3, 1.0f}, {9, 1.0f}};  // there is no ninth
    mesh->mNumBones = 1;
    mesh->mBones = new aiBone* [1] { of };
    auto* target = new aiAnimMesh();
    target->mName = "up";
    target->mNumVertices = 3;
    if (x != 1) {
        target->mVertices = new aiVector3D[3];
        for (unsigned v = 0; v < 3; ++v)
            target->mVertices[v] = mesh->mVertices[v] + aiVector3D(0, 0, float(x + 1));
    }
    mesh->mNumAnimMeshes = 1;
    mesh->mAnimMeshes = new aiAnimMesh* [1] { target };
    return mesh;
}

aiNode* node(const char* name, const std::vector<unsigned>& meshes) {
    auto* out = new aiNode(name);
    out->mNumMeshes = unsigned(meshes.size());
    out->mMeshes = new unsigned[meshes.size()];
    std::copy(meshes.begin(), meshes.end(), out->mMeshes);
    return out;
}

void give(aiScene& scene, const std::vector<aiMesh*>& meshes, const std::vector<aiNode*>& nodes) {
    scene.mNumMeshes = unsigned(meshes.size());
    scene.mMeshes = new aiMesh*[meshes.size()];
    std::copy(meshes.begin(), meshes.end(), scene.mMeshes);
    scene.mRootNode = new aiNode("root");
    scene.mRootNode->addChildren(unsigned(nodes.size()), const_cast<aiNode**>(nodes.data()));
}

Indices meshes_of(const aiNode& node) {
    return {node.mMeshes, node.mMeshes + node.mNumMeshes};
}

TEST(AssimpSplit, BonesAndTargetsAreThoseOfAllParts) {
    aiScene scene;
    give(scene, {part(0, "a", "left"), part(1, "a", "left"), part(2, "a", "right")},
         {node("one", {0, 1, 2})});
    const prep::detail::MeshParts parts = prep::detail::join_split_meshes(scene);
    ASSERT_EQ(scene.mNumMeshes, 1u);
    EXPECT_EQ(meshes_of(*scene.mRootNode->mChildren[0]), Indices{0});
    const aiMesh& mesh = *scene.mMeshes[0];
    ASSERT_EQ(mesh.mNumVertices, 9u);
    ASSERT_EQ(mesh.mNumFaces, 3u);
    for (unsigned v = 0; v < 9; ++v) {
        EXPECT_EQ(mesh.mVertices[v].x, float(10 * (v / 3) + v % 3));
        EXPECT_EQ(mesh.mFaces[v / 3].mIndices[v % 3], v);
    }
    ASSERT_EQ(mesh.mNumBones, 2u);
    const auto weights = [&](unsigned bone) {
        Indices out;
        for (unsigned w = 0; w < mesh.mBones[bone]->mNumWeights; ++w)
            out.push_back(mesh.mBones[bone]->mWeights[w].mVertexId);
        return out;
    };
    EXPECT_EQ(weights(0), (Indices{0, 3 + 1}));
    EXPECT_EQ(weights(1), (Indices{6 + 2}));
    ASSERT_EQ(mesh.mNumAnimMeshes, 1u);
    for (unsigned v = 0; v < 9; ++v)
        EXPECT_EQ((mesh.mAnimMeshes[0]->mVertices[v] - mesh.mVertices[v]).z,
                  v / 3 == 1 ? 0 : float(v / 3 + 1));
    ASSERT_EQ(parts.size(), 1u);
    ASSERT_EQ(parts[0].size(), 3u);
    for (unsigned p = 0; p < 3; ++p) {
        EXPECT_EQ(parts[0][p].first_vertex, 3 * p);
        EXPECT_EQ(parts[0][p].material, p);
    }
}

TEST(AssimpSplit, WhatIsNotOneMeshStaysApart) {
    // Other names, and none.
    aiScene names;
    give(names, {part(0, "a", "b"), part(1, "c", "b"), part(2, "", "b"), part(3, "", "b")},
         {node("one", {0, 1, 2, 3})});
    EXPECT_TRUE(prep::detail::join_split_meshes(names).empty());
    EXPECT_EQ(names.mNumMeshes, 4u);
    names.mMetaData = aiMetadata::Alloc(1);
    names.mMetaData->Set(0, AI_METADATA_SOURCE_FORMAT, aiString("AC3D Importer"));
    prep::detail::join_split_meshes(names);
    EXPECT_EQ(names.mNumMeshes, 3u);
    EXPECT_EQ(meshes_of(*names.mRootNode->mChildren[0]), (Indices{0, 1, 2}));
    // Targets of another number, or of other vertices.
    aiScene targets;
    give(targets, {part(0, "a", "b"), part(1, "a", "b"), part(2, "a", "b")},
         {node("one", {0, 1, 2})});
    delete targets.mMeshes[1]->mAnimMeshes[0];
    targets.mMeshes[1]->mNumAnimMeshes = 0;
    targets.mMeshes[2]->mAnimMeshes[0]->mNumVertices = 2;
    EXPECT_TRUE(prep::detail::join_split_meshes(targets).empty());
    EXPECT_EQ(targets.mNumMeshes, 3u);
    // One geometry twice in a node, with two materials: the same points.
    aiScene twice;
    give(twice, {part(0, "a", "b"), part(1, "a", "b"), part(0, "a", "b"), part(1, "a", "b")},
         {node("one", {0, 1, 2, 3})});
    prep::detail::join_split_meshes(twice);
    EXPECT_EQ(twice.mNumMeshes, 2u);
    EXPECT_EQ(meshes_of(*twice.mRootNode->mChildren[0]), (Indices{0, 1}));
    // Parts that another node has beside others: all of theirs stay.
    aiScene shared;
    give(shared,
         {part(0, "a", "b"), part(1, "a", "b"), part(2, "a", "b"), part(3, "z", "b"),
          part(4, "z", "b")},
         {node("one", {0, 1}), node("two", {0, 1, 3, 4}), node("three", {0, 2}),
          node("four", {3, 4}), node("five", {1, 1})});
    const prep::detail::MeshParts parts = prep::detail::join_split_meshes(shared);
    std::vector<Indices> of_nodes;
    for (unsigned n = 0; n < 5; ++n) of_nodes.push_back(meshes_of(*shared.mRootNode->mChildren[n]));
    EXPECT_EQ(of_nodes, (std::vector<Indices>{{0, 1}, {0, 1, 3}, {0, 2}, {3}, {1, 1}}));
    ASSERT_EQ(shared.mNumMeshes, 4u);
    ASSERT_EQ(parts.size(), 4u);
    for (unsigned m = 0; m < 4; ++m) EXPECT_EQ(parts[m].empty(), m != 3) << m;
}

}  // namespace
