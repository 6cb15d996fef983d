// What Assimp reads of skins, morph targets, animations, nodes, cameras, lights and units, against
// the GLB that is written: its vertices at 20 times, sampled by the specification, lie where a
// sampler of Assimp's own keys puts them.
#include "assimp_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "gltf_motion.h"
#include "invariants.h"
#include "mesh_files.h"
#include "prep/formats.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "rig_files.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;
using Json = test::GltfFile::Json;

struct Converted {
    explicit Converted(const fs::path& from) {
        auto scene = prep::load_scene(from);
        EXPECT_TRUE(scene) << prep::to_string(scene.error());
        if (!scene) return;
        EXPECT_EQ(test::broken_promise(*scene), "");
        loaded = *scene;
        auto prepared = prep::prepare(*std::move(scene));
        EXPECT_TRUE(prepared) << prep::to_string(prepared.error());
        if (!prepared) return;
        const auto saved = prep::save_scene(*prepared, dir / "out.glb");
        EXPECT_TRUE(saved) << prep::to_string(saved.error());
        if (!saved) return;
        notes = *saved;
        file.emplace(dir / "out.glb");
        EXPECT_EQ(file->fault(), "");
        EXPECT_EQ(file->json.dump().find("$AssimpFbx$"), std::string::npos);
    }
    const Json& list(const char* name) const {
        static const Json none = Json::array();
        return file->json.contains(name) ? file->json[name] : none;
    }
    bool warned(const std::string& part) const {
        for (const std::string& text : loaded.warnings)
            if (text.find(part) != std::string::npos) return true;
        return false;
    }
    test::TempDir dir;
    prep::Scene loaded;
    std::vector<std::string> notes;
    std::optional<test::GltfFile> file;
};

// At rest and at 20 times of every animation, between its keys too.
void expect_same_motion(const test::AssimpMotion& expected, const Converted& converted,
                        double bound = 1e-5) {
    ASSERT_TRUE(converted.file);
    const test::GltfMotion written(*converted.file);
    EXPECT_LT(test::largest_difference({written.vertices(-1, 0)}, {expected.vertices(-1, 0)}),
              bound)
        << "at rest";
    ASSERT_EQ(converted.list("animations").size(), expected.scene().mNumAnimations);
    for (int a = 0; a < int(expected.scene().mNumAnimations); ++a) {
        std::vector<std::vector<test::MovedVertex>> ours, theirs;
        for (int k = 0; k < 20; ++k) {
            const double seconds = expected.duration(a) * (k + 0.37) / 20;
            ours.push_back(written.vertices(a, seconds));
            theirs.push_back(expected.vertices(a, seconds));
        }
        EXPECT_LT(test::largest_difference(ours, theirs), bound) << "animation " << a;
        double moved = 0;
        for (std::size_t v = 0; v < theirs[0].size(); ++v)
            for (const auto& time : theirs)
                moved = std::max(moved, glm::length(time[v].world - theirs[0][v].world));
        EXPECT_GT(moved, 0) << "nothing moves: nothing is tested";
    }
}

fs::path real_file(const fs::path& shared, const char* name) {
    return shared / "real_files" / name;
}
#define REQUIRE_FILE(variable, name)                   \
    MESHPREP_REQUIRE_SHARED(shared);                   \
    const fs::path variable = real_file(shared, name); \
    if (!fs::exists(variable)) GTEST_SKIP() << variable << " is not there"

TEST(AssimpRealFiles, HuesitosFbx) {
    REQUIRE_FILE(path, "huesitos.fbx");
    const Converted converted(path);
    expect_same_motion(test::AssimpMotion(path), converted);
    EXPECT_EQ(converted.list("skins").size(), 1u);
    EXPECT_EQ(converted.list("cameras").size(), 1u);
    EXPECT_EQ(converted.loaded.placement.file_unit, 0.01);
    EXPECT_EQ(converted.loaded.placement.file_unit_source, "FBX UnitScaleFactor 1");
}

TEST(AssimpRealFiles, PhongCubeFbxIsCentimetres) {
    REQUIRE_FILE(path, "phong_cube.fbx");
    const Converted converted(path);
    expect_same_motion(test::AssimpMotion(path), converted);
    double size = 0;
    for (const auto& v : test::GltfMotion(*converted.file).vertices(-1, 0)) {
        const double largest =
            std::max({std::abs(v.base[0]), std::abs(v.base[1]), std::abs(v.base[2])});
        EXPECT_NEAR(std::max({std::abs(v.world.x), std::abs(v.world.y), std::abs(v.world.z)}),
                    0.01 * largest, 1e-12);
        size = std::max(size, largest);
    }
    EXPECT_GT(size, 0);
}

TEST(AssimpRealFiles, GlobalSettingsFbxIsFiveMetres) {
    REQUIRE_FILE(path, "global_settings.fbx");
    const Converted converted(path);
    expect_same_motion(test::AssimpMotion(path), converted);
    EXPECT_EQ(converted.loaded.placement.file_unit, 5);
    ASSERT_EQ(converted.list("cameras").size(), 2u);
    // The file says 0.1 to 100 of its units for one of them.
    EXPECT_NEAR(converted.list("cameras")[1]["perspective"]["znear"].get<double>(), 0.5, 1e-6);
    EXPECT_NEAR(converted.list("cameras")[1]["perspective"]["zfar"].get<double>(), 500, 1e-3);
}

TEST(AssimpRealFiles, CubesWithMirroringAndPivotFbx) {
    REQUIRE_FILE(path, "cubes_with_mirroring_and_pivot.fbx");
    const Converted converted(path);
    expect_same_motion(test::AssimpMotion(path), converted);
    // RootNode, Cube2, its Cube1, Cube3, its Cube1: eight nodes of pivots have gone into the last.
    EXPECT_EQ(converted.list("nodes").size(), 5u);
    const auto world = test::GltfMotion(*converted.file).world(-1, 0);
    int mirrored = 0;
    for (const glm::dmat4& m : world) mirrored += glm::determinant(glm::dmat3(m)) < 0;
    EXPECT_EQ(mirrored, 2);  // Cube2 and what is in it
}

TEST(AssimpRealFiles, CubeUtf16LeDae) {
    REQUIRE_FILE(path, "cube_UTF16LE.dae");
    const Converted converted(path);
    EXPECT_TRUE(converted.warned("UTF-16"));
    // The same text in UTF-8, as Assimp reads it.
    std::ifstream in(path, std::ios::binary);
    const std::string wide{std::istreambuf_iterator<char>(in), {}};
    std::string narrow;
    for (std::size_t i = 2; i + 1 < wide.size(); i += 2) {
        const unsigned c = static_cast<unsigned char>(wide[i]) |
                           unsigned(static_cast<unsigned char>(wide[i + 1])) << 8;
        if (c < 0x80) {
            narrow += char(c);
        } else {
            if (c >= 0x800) narrow += char(0xe0 | c >> 12);
            narrow += char(c >= 0x800 ? 0x80 | (c >> 6 & 0x3f) : 0xc0 | c >> 6);
            narrow += char(0x80 | (c & 0x3f));
        }
    }
    const test::TempDir dir;
    test::write_text(dir / "narrow.dae", narrow);
    expect_same_motion(test::AssimpMotion(dir / "narrow.dae"), converted);
}

TEST(AssimpRealFiles, BoxNestedAnimationDae) {
    REQUIRE_FILE(path, "box_nested_animation.dae");
    const Converted converted(path);
    expect_same_motion(test::AssimpMotion(path), converted);
}

TEST(AssimpRealFiles, AnimsWithFullRotationsBetweenKeysDae) {
    REQUIRE_FILE(path, "anims_with_full_rotations_between_keys.DAE");
    const Converted converted(path);
    expect_same_motion(test::AssimpMotion(path), converted);
    ASSERT_EQ(converted.list("animations").size(), 1u);
    // No way between two keys is longer than half a turn, which no key could tell.
    for (const Json& channel : converted.list("animations")[0]["channels"]) {
        if (channel["target"]["path"] != "rotation") continue;
        const auto& sampler =
            converted.list("animations")[0]["samplers"][channel["sampler"].get<std::size_t>()];
        const test::GltfValues keys = converted.file->accessor(sampler["output"]);
        for (std::size_t k = 1; k < keys.count(); ++k) {
            double dot = 0;
            for (std::size_t i = 0; i < 4; ++i) dot += keys.at(k)[i] * keys.at(k - 1)[i];
            EXPECT_GE(dot, -1e-6);
        }
    }
}

TEST(AssimpRealFiles, SimpleCubeMd5mesh) {
    REQUIRE_FILE(path, "SimpleCube.md5mesh");
    const Converted converted(path);
    expect_same_motion(test::AssimpMotion(path), converted);
    ASSERT_EQ(converted.list("skins").size(), 1u);
    EXPECT_EQ(converted.list("skins")[0]["joints"].size(), 2u);
    const auto& remarks = converted.loaded.remarks;
    EXPECT_EQ(std::count(remarks.begin(), remarks.end(), "MD5 files have z up: turned to y"), 1);
}

// Where a camera or light of this name stands and looks: −Z of its node in the written file.
struct View {
    glm::dvec3 place, direction;
};
std::optional<View> view_of(const Converted& converted, bool camera, std::size_t index) {
    const auto world = test::GltfMotion(*converted.file).world(-1, 0);
    const Json& nodes = converted.list("nodes");
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const auto light = Json::json_pointer("/extensions/KHR_lights_punctual/light");
        if (camera ? nodes[n].value("camera", std::size_t(-1)) == index
                   : nodes[n].contains(light) && nodes[n][light] == index)
            return View{glm::dvec3(world[n][3]), -glm::normalize(glm::dvec3(world[n][2]))};
    }
    return std::nullopt;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double bound) {
    EXPECT_LT(glm::length(a - b), bound) << a.x << ' ' << a.y << ' ' << a.z;
}

// Blender's z is up in the file: (x, y, z) there is (x, z, −y) in glTF.
TEST(AssimpRealFiles, CamerasDae) {
    REQUIRE_FILE(path, "cameras.dae");
    const Converted converted(path);
    ASSERT_TRUE(converted.file);
    ASSERT_EQ(converted.list("cameras").size(), 3u);
    EXPECT_EQ(converted.list("meshes").size(), 0u);  // none of Assimp's bones of a skeleton
    const glm::dvec3 places[] = {{10, 0, 0}, {-10, 0, 0}, {0, 0, -5}};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto view = view_of(converted, true, c);
        ASSERT_TRUE(view);
        expect_near(view->place, places[c], 1e-5);
        expect_near(view->direction, -glm::normalize(places[c]), 1e-5);  // all look at the origin
    }
    const double xfov = 49.13434 * std::numbers::pi / 180;
    EXPECT_NEAR(converted.list("cameras")[0]["perspective"]["yfov"].get<double>(),
                2 * std::atan(std::tan(xfov / 2) / 1.777778), 1e-5);
}

TEST(AssimpRealFiles, LightsDae) {
    REQUIRE_FILE(path, "lights.dae");
    const Converted converted(path);
    ASSERT_TRUE(converted.file);
    const Json lights = converted.file->json["extensions"]["KHR_lights_punctual"]["lights"];
    ASSERT_EQ(lights.size(), 4u);  // the fifth is ambient, which glTF has not
    bool told = false;
    for (const std::string& note : converted.notes)
        told |= note.find("ambient") != std::string::npos;
    EXPECT_TRUE(told);
    const std::vector<std::string> kinds = {"point", "directional", "spot", "point"};
    const glm::dvec3 places[] = {{0, 1, -1},
                                 {7.076700, 5.147220, 5.572290},
                                 {8.888220, 5.336030, 5.016860},
                                 {8.063720, 5.273280, 4.198570}};
    for (std::size_t l = 0; l < 4; ++l) {
        EXPECT_EQ(lights[l]["type"], kinds[l]);
        const auto view = view_of(converted, false, l);
        ASSERT_TRUE(view);
        expect_near(view->place, places[l], 1e-4);
        expect_near(view->direction, {0, -1, 0}, 1e-5);  // −z of a file whose z is up
    }
}

TEST(AssimpMotion, SkinsOfOneToEightInfluences) {
    const test::TempDir dir;
    for (int n = 1; n <= 8; ++n) {
        SCOPED_TRACE(n);
        test::ColladaRig rig;
        rig.influences = n;
        rig.seed = unsigned(n);
        test::write_text(dir / "rig.dae", test::collada_rig(rig));
        const Converted converted(dir / "rig.dae");
        expect_same_motion(test::AssimpMotion(dir / "rig.dae"), converted);
        const Json& primitive = converted.file->primitive(0, 0);
        EXPECT_EQ(primitive["attributes"].contains("JOINTS_1"), n > 4);
        EXPECT_FALSE(primitive["attributes"].contains("JOINTS_2"));
        // Each point of the tube is one vertex again, which Assimp makes four of.
        EXPECT_EQ(converted.loaded.meshes[0].vertex_count(), 72u);
        // Weights that the file has not normalised are.
        const auto first = converted.file->attribute(0, 0, "WEIGHTS_0");
        for (std::size_t v = 0; v < first.count(); ++v) {
            double sum = 0;
            for (const double w : first.at(v)) sum += w;
            if (n > 4)
                for (const double w : converted.file->attribute(0, 0, "WEIGHTS_1").at(v)) sum += w;
            EXPECT_NEAR(sum, 1, 1e-6);
        }
    }
}

TEST(AssimpMotion, ScaledArmaturesAndOtherUnits) {
    const test::TempDir dir;
    test::ColladaRig rig;
    rig.influences = 3;
    rig.armature_scale[0] = 2;
    rig.armature_scale[1] = 0.5;
    rig.armature_scale[2] = 3;
    rig.metres = 0.0254;
    test::write_text(dir / "rig.dae", test::collada_rig(rig));
    const Converted converted(dir / "rig.dae");
    expect_same_motion(test::AssimpMotion(dir / "rig.dae"), converted);
    EXPECT_NEAR(converted.loaded.placement.file_unit, 0.0254, 1e-8);
    EXPECT_EQ(converted.loaded.placement.file_unit_source, "Collada unit");
}

TEST(AssimpMotion, VerticesWithoutWeightsFollowTheMesh) {
    const test::TempDir dir;
    test::ColladaRig rig;
    rig.influences = 2;
    rig.loose_vertices = true;
    test::write_text(dir / "rig.dae", test::collada_rig(rig));
    const Converted converted(dir / "rig.dae");
    expect_same_motion(test::AssimpMotion(dir / "rig.dae"), converted);
    EXPECT_TRUE(converted.warned("without a weight"));
    EXPECT_EQ(converted.list("skins")[0]["joints"].size(), 9u);
}

TEST(AssimpMotion, PivotsOffsetsAndGeometricTransformsOfFbx) {
    const test::TempDir dir;
    for (const bool rotation : {false, true})
        for (const bool scaling : {false, true})
            for (const bool geometric : {false, true})
                for (const bool turned : {false, true}) {
                    SCOPED_TRACE(std::to_string(rotation) + std::to_string(scaling) +
                                 std::to_string(geometric) + std::to_string(turned));
                    test::FbxRig rig;
                    rig.rotation_pivot = rotation;
                    rig.scaling_pivot = scaling;
                    rig.geometric = geometric;
                    rig.rotations_before_and_after = turned;
                    rig.shape_keys = false;
                    test::write_text(dir / "rig.fbx", test::fbx_rig(rig));
                    const Converted converted(dir / "rig.fbx");
                    expect_same_motion(test::AssimpMotion(dir / "rig.fbx"), converted);
                    // Root, arm, hand; the geometric transform has a node of its own.
                    EXPECT_EQ(converted.list("nodes").size(), geometric ? 4u : 3u);
                    EXPECT_NEAR(converted.loaded.placement.file_unit, 0.0254, 1e-9);
                }
}

TEST(AssimpMotion, PreRotationWithoutPivots) {
    const test::TempDir dir;
    test::FbxRig rig;
    rig.pre_rotation_only = true;
    rig.shape_keys = false;
    test::write_text(dir / "rig.fbx", test::fbx_rig(rig));
    const Converted converted(dir / "rig.fbx");
    expect_same_motion(test::AssimpMotion(dir / "rig.fbx"), converted);
    EXPECT_EQ(converted.list("nodes").size(), 3u);
}

TEST(AssimpMotion, ShapeKeysWithAKeyframeEach) {
    const test::TempDir dir;
    test::write_text(dir / "rig.fbx", test::fbx_rig({}));
    const Converted converted(dir / "rig.fbx");
    expect_same_motion(test::AssimpMotion(dir / "rig.fbx"), converted);
    const Json& mesh = converted.list("meshes")[0];
    EXPECT_EQ(mesh["primitives"][0]["targets"].size(), 2u);
    EXPECT_EQ(converted.loaded.meshes[0].vertex_count(), 8u);  // a cube
    EXPECT_EQ(mesh["extras"]["targetNames"], Json({"key0", "key1"}));
    EXPECT_EQ(mesh["weights"], Json({0.0, 0.0}));
    bool weights = false;
    for (const Json& channel : converted.list("animations")[0]["channels"])
        weights |= channel["target"]["path"] == "weights";
    EXPECT_TRUE(weights);
}

TEST(AssimpMotion, TheAxesThatFbxStatesAreThoseOfGltf) {
    const test::TempDir dir;
    const auto places = [&](int up) {
        test::FbxRig rig;
        rig.up = up;
        rig.animated = false;
        test::write_text(dir / "rig.fbx", test::fbx_rig(rig));
        const Converted converted(dir / "rig.fbx");
        return test::GltfMotion(*converted.file).vertices(-1, 0);
    };
    const auto y = places(1), z = places(2), x = places(0);
    ASSERT_EQ(y.size(), z.size());
    ASSERT_EQ(y.size(), x.size());
    for (std::size_t v = 0; v < y.size(); ++v) {
        const glm::dvec3 p = y[v].world;
        expect_near(z[v].world, {p.x, p.z, -p.y}, 1e-12);  // x right, z up
        expect_near(x[v].world, {p.y, p.x, -p.z}, 1e-12);  // y right, x up
    }
}

// A unit that is none says nothing of the axes.
TEST(AssimpMotion, FbxAxesTurnWithoutAUnit) {
    const test::TempDir dir;
    test::FbxRig rig;
    rig.animated = false;
    const auto places = [&](int up, double unit) {
        rig.up = up;
        rig.unit = unit;
        test::write_text(dir / "rig.fbx", test::fbx_rig(rig));
        const Converted converted(dir / "rig.fbx");
        const auto& warnings = converted.loaded.warnings;
        const auto is_of_unit = [](const std::string& text) {
            return text.find("UnitScaleFactor is no number over 0") != std::string::npos;
        };
        EXPECT_EQ(std::any_of(warnings.begin(), warnings.end(), is_of_unit), unit < 0);
        return test::GltfMotion(*converted.file).vertices(-1, 0);
    };
    const auto y = places(1, 100), z = places(2, -1);
    ASSERT_EQ(y.size(), z.size());
    for (std::size_t v = 0; v < y.size(); ++v)
        expect_near(z[v].world, {y[v].world.x, y[v].world.z, -y[v].world.y}, 1e-12);
}

TEST(AssimpMotion, OgreMeshesHaveTheirSkeletonsAndMaterials) {
    const test::TempDir dir;
    const test::OgreRig rig = test::ogre_rig("strip");
    const fs::path mesh = dir / "strip.mesh.xml";
    test::write_text(mesh, rig.mesh);
    test::write_text(dir / "strip.skeleton.xml", rig.skeleton);
    test::write_text(dir / "strip.material", rig.material);
    ASSERT_NE(prep::file_format(mesh), nullptr) << "a directory is read for it";
    EXPECT_EQ(prep::file_format("strip.mesh"), nullptr) << "other programs' ending as well";
    EXPECT_EQ(prep::file_format("strip.skeleton.xml"), nullptr) << "no mesh";

    const Converted converted(mesh);
    ASSERT_TRUE(converted.file);
    expect_same_motion(test::AssimpMotion(mesh), converted);
    const Json& skin = converted.list("skins").at(0);
    std::vector<std::string> joints;
    for (const Json& joint : skin["joints"])
        joints.push_back(converted.list("nodes")[joint.get<std::size_t>()]["name"]);
    EXPECT_EQ(joints, (std::vector<std::string>{"bone0", "bone1", "bone2"}));

    // At the end, to 1e-5 of the size: about the second bone, which has gone to (0.5, 2, 0).
    const test::GltfMotion motion(*converted.file);
    EXPECT_NEAR(motion.duration(0), 2, 1e-6);
    std::size_t seen = 0;
    for (const test::MovedVertex& v : motion.vertices(0, 2)) {
        const glm::dvec3 base(v.base[0], v.base[1], v.base[2]);
        const glm::dvec3 turned(0.5 - (base.y - 2), 2 + base.x, 0);
        const double share = base.y < 2 ? 0 : base.y == 2 ? 0.75 : 1;
        EXPECT_LT(glm::length(v.world - glm::mix(base, turned, share)), 1e-5 * 6) << base.y;
        ++seen;
    }
    EXPECT_EQ(seen, 14u);

    const prep::Material& stone = converted.loaded.materials.at(0);
    EXPECT_EQ(stone.name, "stone");
    EXPECT_EQ(stone.diffuse, glm::vec4(0.25f, 0.5f, 0.75f, 1));
    EXPECT_EQ(stone.specular, glm::vec3(0.5f));
    EXPECT_TRUE(bool(stone.diffuse_map));

    std::vector<fs::path> beside = converted.loaded.libraries;  // what it was read from
    std::sort(beside.begin(), beside.end());
    EXPECT_EQ(beside, (std::vector<fs::path>{dir / "strip.material", dir / "strip.skeleton.xml"}));
}

TEST(AssimpMotion, TheSameBytesForAnyNumberOfThreads) {
    const test::TempDir dir;
    test::write_text(dir / "rig.fbx", test::fbx_rig({}));
    std::vector<std::string> bytes;
    for (const int threads : {1, 4}) {
        auto scene = prep::load_scene(dir / "rig.fbx", {threads});
        ASSERT_TRUE(scene);
        prep::PrepareOptions options;
        options.threads = threads;
        auto prepared = prep::prepare(*std::move(scene), options);
        ASSERT_TRUE(prepared);
        ASSERT_TRUE(prep::save_scene(*prepared, dir / "out.glb"));
        bytes.push_back(test::file_text(dir / "out.glb"));
    }
    EXPECT_EQ(bytes[0], bytes[1]);
}

}  // namespace
