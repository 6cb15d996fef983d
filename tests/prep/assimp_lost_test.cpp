// What Assimp reads and we do not keep is counted and named; tangents of the file are kept. Scenes
// are made member by member, as Assimp's readers fill them, and a few files are written.
#include <assimp/material.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "formats/assimp/import.h"
#include "mesh_files.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"

namespace {

using prep::detail::AssimpImport;
using Strings = std::vector<std::string>;

// A triangle with normals; its node is the root.
struct Triangle {
    Triangle() {
        mesh = new aiMesh();
        mesh->mNumVertices = 3;
        mesh->mVertices = new aiVector3D[3]{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh->mNormals = new aiVector3D[3]{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
        mesh->mNumFaces = 1;
        mesh->mFaces = new aiFace[1];
        mesh->mFaces[0].mNumIndices = 3;
        mesh->mFaces[0].mIndices = new unsigned[3]{0, 1, 2};
        scene.mNumMeshes = 1;
        scene.mMeshes = new aiMesh* [1] { mesh };
        scene.mRootNode = new aiNode("root");
        scene.mRootNode->mNumMeshes = 1;
        scene.mRootNode->mMeshes = new unsigned[1]{0};
        material = new aiMaterial();
        scene.mNumMaterials = 1;
        scene.mMaterials = new aiMaterial* [1] { material };
    }
    prep::Scene read() const {
        const std::filesystem::path path = "lost";
        AssimpImport import{scene, path, {}, {}};
        import_materials(import, {});
        EXPECT_TRUE(import_meshes(import));
        EXPECT_TRUE(import_nodes(import));
        import_animations(import);
        import_cameras_and_lights(import);
        count_what_is_not_kept(import);
        return std::move(import.scene);
    }
    Strings warnings() const { return read().warnings; }
    Strings remarks() const { return read().remarks; }
    // Of the root, with its last key at 4 ticks.
    void add_animation(double duration, double ticks_per_second) {
        auto* channel = new aiNodeAnim();
        channel->mNodeName = "root";
        channel->mNumPositionKeys = 2;
        channel->mPositionKeys =
            new aiVectorKey[2]{{0, aiVector3D(0, 0, 0)}, {4, aiVector3D(1, 0, 0)}};
        auto* animation = new aiAnimation();
        animation->mDuration = duration;
        animation->mTicksPerSecond = ticks_per_second;
        animation->mNumChannels = 1;
        animation->mChannels = new aiNodeAnim* [1] { channel };
        scene.mNumAnimations = 1;
        scene.mAnimations = new aiAnimation* [1] { animation };
    }

    aiScene scene;
    aiMesh* mesh = nullptr;
    aiMaterial* material = nullptr;
};

template <class T>
void add(aiMaterial& to, const T& value, const char* key, unsigned type = 0, unsigned index = 0) {
    to.AddProperty(&value, 1, key, type, index);
}
void add(aiMaterial& to, const char* text, const char* key, unsigned type = 0, unsigned index = 0) {
    const aiString value(text);
    to.AddProperty(&value, key, type, index);
}

TEST(AssimpLost, NothingIsSaidOfWhatIsKept) {
    Triangle t;
    add(*t.material, "stone", AI_MATKEY_NAME);
    add(*t.material, aiColor3D(1, 0, 0), AI_MATKEY_COLOR_DIFFUSE);
    add(*t.material, aiColor3D(1, 1, 1), AI_MATKEY_COLOR_SPECULAR);
    add(*t.material, 32.0f, AI_MATKEY_SHININESS);
    add(*t.material, 1.0f, AI_MATKEY_SHININESS_STRENGTH);
    add(*t.material, 1.0f, AI_MATKEY_OPACITY);
    EXPECT_EQ(t.warnings(), Strings{});
}

// Blender's and Maya's exporters fill in all that a material could have.
TEST(AssimpLost, PropertiesThatSayNothingAreNotCounted) {
    Triangle t;
    const aiColor3D black(0, 0, 0), white(1, 1, 1);
    add(*t.material, black, AI_MATKEY_COLOR_AMBIENT);
    add(*t.material, aiColor3D(0.1f, 0.1f, 0.1f), AI_MATKEY_COLOR_AMBIENT);  // Assimp's own
    add(*t.material, white, AI_MATKEY_COLOR_REFLECTIVE);
    add(*t.material, 0.0f, AI_MATKEY_REFLECTIVITY);
    add(*t.material, white, AI_MATKEY_COLOR_TRANSPARENT);
    add(*t.material, 0.0f, AI_MATKEY_TRANSPARENCYFACTOR);
    add(*t.material, 1.0f, AI_MATKEY_OPACITY);
    add(*t.material, 1.0f, AI_MATKEY_BUMPSCALING);
    add(*t.material, 1.0f, AI_MATKEY_REFRACTI);
    add(*t.material, 0, AI_MATKEY_ENABLE_WIREFRAME);
    add(*t.material, 10.0f, AI_MATKEY_SHININESS);
    add(*t.material, 0.7f, AI_MATKEY_ROUGHNESS_FACTOR);  // which Assimp makes of the exponent
    add(*t.material, white, "$raw.DiffuseColor");
    add(*t.material, "a.png", "$raw.DiffuseColor|file", aiTextureType_UNKNOWN);
    add(*t.material, 7, "$raw.3dsMax|ClassIDa");
    EXPECT_EQ(t.warnings(), Strings{});
}

TEST(AssimpLost, MaterialPropertiesNobodyReadsAreCountedAndNamed) {
    Triangle t;
    add(*t.material, aiColor3D(0.5f, 0.5f, 0.5f), AI_MATKEY_COLOR_REFLECTIVE);
    add(*t.material, 0.25f, AI_MATKEY_REFLECTIVITY);
    add(*t.material, 1.5f, AI_MATKEY_REFRACTI);
    add(*t.material, aiColor3D(0.2f, 0.2f, 0.2f), AI_MATKEY_COLOR_AMBIENT);
    add(*t.material, 0.5f, "$raw.Maya|transmission");
    add(*t.material, 1, "$raw.3dsMax|settings|ao_affects_diffuse");
    auto* second = new aiMaterial();
    add(*second, 1.33f, AI_MATKEY_REFRACTI);
    delete[] t.scene.mMaterials;
    t.scene.mMaterials = new aiMaterial* [2] { t.material, second };
    t.scene.mNumMaterials = 2;
    EXPECT_EQ(t.warnings(),
              Strings{"7 material properties not kept: $clr.reflective, $mat.reflectivity, "
                      "$mat.refracti, $clr.ambient, $raw.Maya|transmission, "
                      "settings|ao_affects_diffuse"});
}

// A map that is not read is one thing, whatever is said of how it lies; one that is read is not
// named, but for what of it has no place.
TEST(AssimpLost, MapsWithoutAPlaceAreNamedByTheirUse) {
    Triangle t;
    for (const aiTextureType type : {aiTextureType_AMBIENT, aiTextureType_DIFFUSE}) {
        add(*t.material, "a.png", AI_MATKEY_TEXTURE(type, 0));
        add(*t.material, 1, AI_MATKEY_MAPPINGMODE_U(type, 0));
        add(*t.material, 0.5f, AI_MATKEY_TEXBLEND(type, 0));
        add(*t.material, 0, AI_MATKEY_TEXOP(type, 0));
    }
    add(*t.material, "b.png", AI_MATKEY_TEXTURE(aiTextureType_DIFFUSE, 1));
    add(*t.material, "a.png", AI_MATKEY_TEXTURE(aiTextureType_BASE_COLOR, 0));  // said twice
    add(*t.material, "c.png", AI_MATKEY_TEXTURE(aiTextureType_EMISSIVE, 0));
    add(*t.material, "d.png", AI_MATKEY_TEXTURE(aiTextureType_EMISSION_COLOR, 0));
    aiUVTransform turned;
    turned.mRotation = 0.5f;
    add(*t.material, turned, AI_MATKEY_UVTRANSFORM(aiTextureType_EMISSIVE, 0));
    Strings warnings = t.warnings();
    std::erase_if(warnings, [](const std::string& w) { return w.find(".png") != w.npos; });
    EXPECT_EQ(warnings, (Strings{"4 material properties not kept: map Ambient, $tex.blend, "
                                 "map Diffuse 2, map EmissionColor",
                                 "1 map with a rotated or non-finite UV transform: without it"}));
}

TEST(AssimpLost, MetadataOfTheSceneAndOfItsNodesIsCountedAndNamed) {
    Triangle t;
    t.scene.mMetaData = aiMetadata::Alloc(6);
    t.scene.mMetaData->Set(0, "Author", aiString("somebody"));
    t.scene.mMetaData->Set(1, "Title", aiString(""));
    t.scene.mMetaData->Set(2, "SourceAsset_Format", aiString("Test"));
    t.scene.mMetaData->Set(3, "FrameRate", std::int32_t(11));
    t.scene.mMetaData->Set(4, "CustomFrameRate", -1.0f);
    t.scene.mMetaData->Set(5, "UpAxis", std::int32_t(1));
    auto* child = new aiNode("child");
    t.scene.mRootNode->addChildren(1, &child);
    for (aiNode* node : {t.scene.mRootNode, child}) {
        node->mMetaData = aiMetadata::Alloc(5);
        node->mMetaData->Set(0, "IsNull", true);
        node->mMetaData->Set(1, "UserProperties", aiString(""));
        node->mMetaData->Set(2, "InheritType", std::int32_t(node == child ? 2 : 1));
        node->mMetaData->Set(3, "price", 12.5);
        node->mMetaData->Set(4, "limit", aiVector3D(0, 0, 0));
    }
    EXPECT_EQ(t.warnings(), Strings{});
    EXPECT_EQ(t.remarks(), (Strings{"2 properties of the scene not kept: Author, FrameRate",
                                    "3 properties of nodes not kept: price, InheritType"}));
}

TEST(AssimpLost, WhatElseHasNoPlaceIsCounted) {
    Triangle t;
    t.mesh->mTextureCoords[0] = new aiVector3D[3]{{0, 0, 0.5f}, {1, 0, 0}, {0, 1, -1}};
    t.mesh->mNumUVComponents[0] = 3;
    t.mesh->mTextureCoords[2] = new aiVector3D[3]{{0, 0, 9}, {1, 0, 9}, {0, 1, 9}};
    t.mesh->mNumUVComponents[2] = 2;
    t.mesh->mColors[1] = new aiColor4D[3];
    t.mesh->mTextureCoordsNames = new aiString* [AI_MAX_NUMBER_OF_TEXTURECOORDS] {};
    t.mesh->mTextureCoordsNames[0] = new aiString("map1");
    t.scene.mNumLights = 1;
    t.scene.mLights = new aiLight* [1] { new aiLight() };
    t.scene.mLights[0]->mName = "root";
    t.scene.mLights[0]->mType = aiLightSource_DIRECTIONAL;
    t.scene.mLights[0]->mColorDiffuse = aiColor3D(1, 1, 1);
    t.scene.mLights[0]->mColorSpecular = aiColor3D(1, 0, 0);
    t.scene.mNumTextures = 1;
    t.scene.mTextures = new aiTexture* [1] { new aiTexture() };
    t.scene.mTextures[0]->mFilename = "spare.png";
    t.add_animation(10, 1);
    EXPECT_EQ(t.warnings(),
              (Strings{"1 embedded picture that no map names not kept: spare.png",
                       "2 texture coordinates with a third component, which is not kept",
                       "2 UV or colour sets behind one that is missing not kept",
                       "1 light with another colour for highlights or shadows, which is not kept",
                       "1 animation said to last longer than to the last key: it ends there"}));
    EXPECT_EQ(t.remarks(), Strings{"1 name of a UV set not kept: map1"});
}

// Some writers count frames, others the time from the first to the last.
TEST(AssimpLost, ATickMoreThanTheLastKeyIsNoLongerAnimation) {
    Triangle t;
    t.add_animation(5, 24);
    EXPECT_EQ(t.warnings(), Strings{});
}

TEST(AssimpLost, PointsKeepTheirColoursAndWhatElseTheyHaveIsCounted) {
    Triangle t;
    for (unsigned k = 0; k < 3; ++k) t.mesh->mFaces[0].mIndices[k] = k;
    t.mesh->mFaces[0].mNumIndices = 1;
    t.mesh->mColors[0] = new aiColor4D[3]{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
    const prep::Scene scene = t.read();
    const prep::Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.points, (std::vector<std::uint32_t>{0}));
    ASSERT_EQ(mesh.vertex_colors.size(), 3u);
    EXPECT_EQ(mesh.vertex_colors[0], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(mesh.loose_parts_with_attributes, 1u);  // the normals
    delete[] std::exchange(t.mesh->mNormals, nullptr);
    EXPECT_EQ(t.read().meshes.at(0).loose_parts_with_attributes, 1u);  // the material
    const aiString none(AI_DEFAULT_MATERIAL_NAME);
    t.material->AddProperty(&none, AI_MATKEY_NAME);
    EXPECT_EQ(t.read().meshes.at(0).loose_parts_with_attributes, 0u);
}

// --- tangents -----------------------------------------------------------------------------------

void give_tangents(aiMesh& mesh, float side) {
    mesh.mTangents = new aiVector3D[3]{{1, 0, 0}, {0.6f, 0.8f, 0}, {0, 1, 0}};
    mesh.mBitangents = new aiVector3D[3];
    for (unsigned v = 0; v < 3; ++v)
        mesh.mBitangents[v] = (mesh.mNormals[v] ^ mesh.mTangents[v]) * side;
}

TEST(AssimpTangents, AreThoseOfTheFileWithTheSignOfTheBitangents) {
    for (const float side : {1.0f, -1.0f}) {
        Triangle t;
        give_tangents(*t.mesh, side);
        const prep::Scene scene = t.read();
        const prep::Mesh& mesh = scene.meshes.at(0);
        EXPECT_EQ(
            mesh.tangents.values,
            (std::vector<glm::vec4>{{1, 0, 0, side}, {0.6f, 0.8f, 0, side}, {0, 1, 0, side}}));
        EXPECT_EQ(mesh.tangents.indices, mesh.corner_vertices);
        EXPECT_EQ(scene.warnings, Strings{});
    }
}

TEST(AssimpTangents, WithoutASignAreNotKept) {
    Triangle none;
    give_tangents(*none.mesh, 1);
    delete[] none.mesh->mBitangents;
    none.mesh->mBitangents = nullptr;
    const prep::Scene scene = none.read();
    EXPECT_TRUE(scene.meshes[0].tangents.values.empty());
    EXPECT_EQ(scene.warnings, Strings{"3 tangents not kept: without normals and bitangents to tell "
                                      "their sign"});
    // Mirrored UVs with bitangents that are nothing but N × T: Assimp's own.
    for (const bool mirrored : {false, true}) {
        Triangle made;
        give_tangents(*made.mesh, 1);
        made.mesh->mTextureCoords[0] = new aiVector3D[3]{
            {0, 0, 0}, {mirrored ? 0.0f : 1.0f, mirrored ? 1.0f : 0.0f, 0}, {1, 1, 0}};
        EXPECT_EQ(made.read().meshes[0].tangents.values.empty(), mirrored);
    }
}

// Two triangles of a square, the second with mirrored UVs; tangents as the file's program has them,
// turned by 10 degrees from those of the UVs so that computed ones would show.
const char* const fbx = R"(; FBX 7.3.0 project file
FBXHeaderExtension:  {
	FBXHeaderVersion: 1003
	FBXVersion: 7300
}
Objects:  {
	Geometry: 10, "Geometry::square", "Mesh" {
		Vertices: *12 { a: 0,0,0,1,0,0,1,1,0,0,1,0 }
		PolygonVertexIndex: *6 { a: 0,1,-3,0,2,-4 }
		GeometryVersion: 124
		LayerElementNormal: 0 {
			Version: 101
			Name: ""
			MappingInformationType: "ByPolygonVertex"
			ReferenceInformationType: "Direct"
			Normals: *18 { a: 0,0,1,0,0,1,0,0,1,0,0,1,0,0,1,0,0,1 }
		}
		LayerElementBinormal: 0 {
			Version: 101
			Name: ""
			MappingInformationType: "ByPolygonVertex"
			ReferenceInformationType: "Direct"
			Binormals: *18 { a: -0.17364818,0.98480775,0,-0.17364818,0.98480775,0,-0.17364818,0.98480775,0,0.17364818,-0.98480775,0,0.17364818,-0.98480775,0,0.17364818,-0.98480775,0 }
		}
		LayerElementTangent: 0 {
			Version: 101
			Name: ""
			MappingInformationType: "ByPolygonVertex"
			ReferenceInformationType: "Direct"
			Tangents: *18 { a: 0.98480775,0.17364818,0,0.98480775,0.17364818,0,0.98480775,0.17364818,0,0.98480775,0.17364818,0,0.98480775,0.17364818,0,0.98480775,0.17364818,0 }
		}
		LayerElementUV: 0 {
			Version: 101
			Name: "map1"
			MappingInformationType: "ByPolygonVertex"
			ReferenceInformationType: "Direct"
			UV: *12 { a: 0,0,1,0,1,1,0,1,1,0,0,0 }
		}
		Layer: 0 {
			Version: 100
			LayerElement:  {
				Type: "LayerElementNormal"
				TypedIndex: 0
			}
			LayerElement:  {
				Type: "LayerElementBinormal"
				TypedIndex: 0
			}
			LayerElement:  {
				Type: "LayerElementTangent"
				TypedIndex: 0
			}
			LayerElement:  {
				Type: "LayerElementUV"
				TypedIndex: 0
			}
		}
	}
	Model: 20, "Model::square", "Mesh" {
		Version: 232
	}
}
Connections:  {
	C: "OO",20,0
	C: "OO",10,20
}
)";

TEST(AssimpTangents, OfFbxStandInTheGlb) {
    const test::TempDir dir;
    test::write_text(dir / "square.fbx", fbx);
    auto scene = prep::load_scene(dir / "square.fbx");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    auto prepared = prep::prepare(*std::move(scene), {});
    ASSERT_TRUE(prepared.has_value());
    ASSERT_TRUE(prep::save_scene(*prepared, dir / "square.glb").has_value());
    const auto back = prep::load_scene(dir / "square.glb");
    ASSERT_TRUE(back.has_value()) << prep::to_string(back.error());
    const prep::Mesh& mesh = back->meshes.at(0);
    ASSERT_EQ(mesh.corner_count(), 6u);
    ASSERT_EQ(mesh.tangents.indices.size(), 6u);
    for (std::size_t c = 0; c < 6; ++c) {
        const glm::vec4 t = mesh.tangents.values[mesh.tangents.indices[c]];
        EXPECT_NEAR(t.x, 0.98480775, 1e-6) << c;
        EXPECT_NEAR(t.y, 0.17364818, 1e-6) << c;
        EXPECT_EQ(t.w, c < 3 ? 1.0f : -1.0f) << c;
    }
}

// --- files --------------------------------------------------------------------------------------

TEST(AssimpLost, AColladaFileTellsItAll) {
    const char* const text = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><contributor><author>somebody</author></contributor><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON>
<technique sid="common"><phong><ambient><color>0.1 0.2 0.3 1</color></ambient>
<reflective><color>1 1 1 1</color></reflective><reflectivity><float>0.5</float></reflectivity>
</phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="wood"><instance_effect url="#e"/></material>
</library_materials>
<library_geometries><geometry id="g" name="quad"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 1 1 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="u"><float_array id="ua" count="9">0 0 0.5 1 0 0.5 1 1 0.5</float_array>
<technique_common><accessor source="#ua" count="3" stride="3"><param name="S" type="float"/>
<param name="T" type="float"/><param name="P" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="TEXCOORD" source="#u" offset="1" set="0"/>
<p>0 0 1 1 2 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node id="n" name="n">
<instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="m" target="#m"/></technique_common></bind_material>
</instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>
)";
    const test::TempDir dir;
    test::write_text(dir / "a.dae", text);
    const auto scene = prep::load_scene(dir / "a.dae");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    for (const char* const expected :
         {"3 material properties not kept: $clr.ambient, $clr.reflective, $mat.reflectivity",
          "3 texture coordinates with a third component, which is not kept"})
        EXPECT_TRUE(std::find(scene->warnings.begin(), scene->warnings.end(), expected) !=
                    scene->warnings.end())
            << expected << "\n"
            << testing::PrintToString(scene->warnings);
    EXPECT_EQ(scene->remarks, Strings{"1 property of the scene not kept: Author"});
}

}  // namespace
