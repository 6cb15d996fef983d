// Keys, bones and names as no exporter should write them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "formats/assimp/import.h"
#include "formats/assimp/key_tracks.h"
#include "formats/assimp/pivot_motion.h"
#include "formats/assimp/texts/md5_numbers.h"
#include "formats/assimp/texts/utf16.h"
#include "mesh_files.h"
#include "model/trs.h"
#include "prep/load.h"

namespace {

using namespace prep::detail;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

aiVectorKey key(double time, float x) {
    return {time, aiVector3D(x, 0, 0)};
}

TEST(AssimpKeys, TicksBecomeSeconds) {
    const aiVectorKey keys[] = {key(0, 1), key(48, 2)};
    KeyCounts counts;
    EXPECT_EQ(vector_track(keys, 2, 24, counts).times, (std::vector<double>{0, 2}));
}

TEST(AssimpKeys, NotFiniteOnesAreLeftOutAndCounted) {
    const aiVectorKey keys[] = {key(0, 1), key(nan, 2), key(2, float(nan)), key(3, 4),
                                key(1e300, 5)};
    KeyCounts counts;
    const VectorTrack track = vector_track(keys, 5, 1, counts);
    EXPECT_EQ(track.times, (std::vector<double>{0, 3}));
    EXPECT_EQ(counts.not_finite, 3u);
    const aiQuatKey turns[] = {{0, aiQuaternion(0, 0, 0, 0)}, {1, aiQuaternion(2, 0, 0, 0)}};
    const RotationTrack rotations = rotation_track(turns, 2, 1, counts);
    EXPECT_EQ(rotations.values, (std::vector<glm::dquat>{{1, 0, 0, 0}}));
    EXPECT_EQ(counts.not_finite, 4u);
}

TEST(AssimpKeys, UnsortedOnesAreSorted) {
    const aiVectorKey keys[] = {key(2, 2), key(0, 0), key(1, 1)};
    KeyCounts counts;
    const VectorTrack track = vector_track(keys, 3, 1, counts);
    EXPECT_EQ(track.times, (std::vector<double>{0, 1, 2}));
    EXPECT_EQ(at(track, 1.25).x, 1.25);
    EXPECT_EQ(counts.unsorted, 3u);
}

TEST(AssimpKeys, AJumpKeepsBothItsSidesAndTimesAscend) {
    const aiVectorKey keys[] = {key(0, 0), key(1, 1), key(1, 7), key(1, 5), key(2, 6)};
    KeyCounts counts;
    const VectorTrack track = vector_track(keys, 5, 1, counts);
    EXPECT_EQ(counts.repeated, 1u);
    const FloatTimes times = float_times(track.times, counts);
    ASSERT_EQ(times.times.size(), 4u);
    EXPECT_EQ(times.times[1], 1.0f);
    EXPECT_EQ(times.times[2], std::nextafter(1.0f, 2.0f));
    EXPECT_EQ(track.values[times.keys[1]].x, 1);
    EXPECT_EQ(track.values[times.keys[2]].x, 5);
}

TEST(AssimpKeys, TimesThatFloatsCannotTellApartAreOne) {
    KeyCounts counts;
    const FloatTimes times = float_times({1, 1 + 1e-12, 2}, counts);
    EXPECT_EQ(times.times, (std::vector<float>{1, 2}));
    EXPECT_EQ(counts.repeated, 1u);
}

TEST(AssimpKeys, WhatLiesBeforeZeroIsCutWhereItIsThen) {
    const aiVectorKey keys[] = {key(-2, -2), key(-1, -1), key(1, 1)};
    KeyCounts counts;
    VectorTrack track = vector_track(keys, 3, 1, counts);
    start_at_zero(track, counts);
    EXPECT_EQ(track.times, (std::vector<double>{0, 1}));
    EXPECT_EQ(track.values[0].x, 0);
    EXPECT_EQ(counts.negative, 2u);
    VectorTrack over = vector_track(keys, 2, 1, counts);
    start_at_zero(over, counts);
    EXPECT_EQ(over.times, (std::vector<double>{0}));
    EXPECT_EQ(over.values[0].x, -1);
}

TEST(AssimpKeys, RotationsTakeTheShorterWay) {
    const float h = std::sqrt(0.5f);
    const aiQuatKey keys[] = {{0, aiQuaternion(1, 0, 0, 0)}, {1, aiQuaternion(-h, -h, 0, 0)}};
    KeyCounts counts;
    const RotationTrack track = rotation_track(keys, 2, 1, counts);
    EXPECT_GT(glm::dot(track.values[0], track.values[1]), 0);
    const glm::dquat middle = at(track, 0.5);  // an eighth of a turn
    EXPECT_NEAR(middle.w, std::cos(std::acos(-1.0) / 8), 1e-7);
    EXPECT_NEAR(middle.x, std::sin(std::acos(-1.0) / 8), 1e-7);
}

TEST(AssimpKeys, NoKeysAreNoTrack) {
    KeyCounts counts;
    EXPECT_TRUE(vector_track(nullptr, 0, 25, counts).empty());
    VectorTrack none;
    start_at_zero(none, counts);
    EXPECT_TRUE(none.empty());
    EXPECT_TRUE(float_times({}, counts).times.empty());
    EXPECT_TRUE(product_tracks({}, counts)->translation.empty());
}

// A quarter turn about a point at (1, 0, 0): the origin goes along an arc about it.
TEST(AssimpPivots, KeysAreAddedUntilArcsAreArcs) {
    std::vector<MovingFactor> factors(3);
    factors[0].rest.translation = {1, 0, 0};
    const double h = std::sqrt(0.5);
    factors[1].rotation = {{0, 1}, {{1, 0, 0, 0}, {h, 0, 0, h}}};
    factors[2].rest.translation = {-1, 0, 0};
    KeyCounts counts;
    const auto tracks = product_tracks(factors, counts);
    ASSERT_TRUE(tracks);
    EXPECT_GT(counts.added, 0u);
    EXPECT_EQ(tracks->rotation.times.size(), 2u);  // turns evenly as it is
    for (int k = 0; k <= 1000; ++k) {
        const double t = k / 1000.0, angle = t * std::acos(-1.0) / 2;
        const glm::dvec3 p = at(tracks->translation, t);
        EXPECT_NEAR(p.x, 1 - std::cos(angle), 4e-6) << t;
        EXPECT_NEAR(p.y, -std::sin(angle), 4e-6) << t;
    }
}

TEST(AssimpPivots, ATurnInsideAnUnevenScaleIsNone) {
    std::vector<MovingFactor> factors(2);
    factors[0].rest.scale = {1, 2, 1};
    const double h = std::sqrt(0.5);
    factors[1].rotation = {{0, 1}, {{1, 0, 0, 0}, {h, 0, 0, h}}};
    KeyCounts counts;
    EXPECT_FALSE(product_tracks(factors, counts));
}

TEST(AssimpTrs, MatricesComeBack) {
    prep::Trs trs;
    trs.translation = {1, 2, 3};
    trs.rotation = glm::normalize(glm::dquat(0.3, -0.2, 0.7, 0.4));
    for (const glm::dvec3 scale :
         {glm::dvec3(1, 2, 3), glm::dvec3(-1, 2, 3), glm::dvec3(-1, -2, -3), glm::dvec3(0, 2, 3)}) {
        trs.scale = scale;
        EXPECT_LT(shear_of(trs.matrix(), trs_of(trs.matrix())), 1e-12);
    }
    EXPECT_EQ(trs_of(glm::dmat4(0.0)).scale, glm::dvec3(0.0));
    glm::dmat4 sheared(1.0);
    sheared[1][0] = 0.5;
    EXPECT_GT(shear_of(sheared, trs_of(sheared)), 0.1);
}

// Assimp is given the text that it becomes, and that is what is looked at.
TEST(AssimpUtf16, NumbersOfMd5AreThoseOfTheText) {
    const test::TempDir dir;
    std::string bytes = "\xff\xfe";
    for (const char c : std::string("MD5Version 10\nmesh {\nnumtris 1\ntri 4294967295 0 0 0\n}\n"))
        bytes += {c, '\0'};
    test::write_text(dir / "a.md5mesh", bytes);
    const auto read = prep::load_scene(dir / "a.md5mesh");
    ASSERT_FALSE(read);
    EXPECT_NE(read.error().text.find("'tri 4294967295' is beyond what a file of"),
              std::string::npos)
        << read.error().text;
}

TEST(AssimpUtf16, BothOrdersPairsAndHalves) {
    const auto text = [](std::vector<unsigned char> bytes) {
        return utf8_of_utf16(std::as_bytes(std::span(bytes)));
    };
    EXPECT_EQ(text({0xff, 0xfe, '<', 0, 0xe9, 0}), "<\xc3\xa9");
    EXPECT_EQ(text({0xfe, 0xff, 0, '<', 0x20, 0xac}), "<\xe2\x82\xac");
    EXPECT_EQ(text({0xff, 0xfe, 0x3d, 0xd8, 0x00, 0xde}), "\xf0\x9f\x98\x80");  // U+1F600
    EXPECT_EQ(text({0xff, 0xfe, 0x3d, 0xd8}), "\xef\xbf\xbd");                  // half a pair
    EXPECT_EQ(text({'<', 0, 'a', 0}), "<a");
    EXPECT_EQ(text({'<', '?', 'x'}), std::nullopt);
    EXPECT_EQ(text({}), std::nullopt);
    EXPECT_EQ(text({0xff, 0xfe}), "");
}

TEST(AssimpMd5Numbers, BeyondWhatTheFileHoldsAreToldByLine) {
    const auto told = [](const std::string& text) {
        const auto excess = prep::detail::md5_excess(text);
        return excess ? std::to_string(excess->line) + ": " + excess->statement : std::string();
    };
    const std::string head = "MD5Version 10\r\nmesh {\r\n", tail = " 0 0 0\n}\n";
    for (const char* word : {"vert", "tri", "weight"}) {
        EXPECT_EQ(told(head + word + " 0" + tail + " \t" + word + "\t20" + tail), "");
        for (const char* number : {"4294967295", "8589934591", "99999999999999999999999", "80"})
            EXPECT_EQ(told(head + word + " 0" + tail + " \t" + word + " \t" + number + tail),
                      std::string("5: ") + word + ' ' + number);
    }
    EXPECT_EQ(told(head + "numtris 4294967295"), "3: numtris 4294967295");
    // The other integers of a statement.
    EXPECT_EQ(told(head + "tri 0 0 99 2\n"), "3: tri 0 0 99");
    EXPECT_EQ(told(head + "vert 0 ( 99 99.5 ) 1 99\n"), "3: vert 0 99 99.5 1 99");
    EXPECT_EQ(told(head + "weight 0 99 1 ( 99 99 99 )\n"), "3: weight 0 99");
    EXPECT_EQ(told(head + "vert 0 ( 999 999 ) 1 9\nweight 0 9 999 ( 999 999 999 )\n"), "");
    // Wherever Assimp begins a statement, and not in names or remarks.
    EXPECT_EQ(told("mesh { tri 99 0 1 2"), "1: tri 99");
    EXPECT_EQ(told("shader \"x\"\ftri 99 0 1 2"), "1: tri 99");
    EXPECT_EQ(told("shader \"tri 99 0 0 0\" // tri 99\ntri 0 0 0 0\n"), "");
    EXPECT_EQ(told(head + "shader 4294967295\rtriangle 4294967295\rtri\rtri x"), "");
    // As many as bytes are no excess.
    EXPECT_EQ(told("tri 6 "), "");
    EXPECT_EQ(told("tri 7 "), "1: tri 7");
    EXPECT_EQ(told("\r\r\n\ntri 99"), "4: tri 99");
    EXPECT_EQ(told(""), "");
}

// One triangle under `root`, with bones of the given names and weights.
struct Bones {
    struct Bone {
        std::string name;
        std::vector<std::pair<unsigned, float>> weights;
    };
    explicit Bones(const std::vector<Bone>& bones, const std::vector<std::string>& children) {
        scene.mRootNode = new aiNode("root");
        scene.mRootNode->mNumMeshes = 1;
        scene.mRootNode->mMeshes = new unsigned[1]{0};
        scene.mRootNode->mNumChildren = unsigned(children.size());
        scene.mRootNode->mChildren = new aiNode*[children.size()];
        for (std::size_t c = 0; c < children.size(); ++c)
            scene.mRootNode->mChildren[c] = new aiNode(children[c]);
        auto* mesh = new aiMesh();
        mesh->mNumVertices = 3;
        mesh->mVertices = new aiVector3D[3]{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh->mNumFaces = 1;
        mesh->mFaces = new aiFace[1];
        mesh->mFaces[0].mNumIndices = 3;
        mesh->mFaces[0].mIndices = new unsigned[3]{0, 1, 2};
        mesh->mNumBones = unsigned(bones.size());
        mesh->mBones = new aiBone*[bones.size()];
        for (std::size_t b = 0; b < bones.size(); ++b) {
            auto* bone = new aiBone();
            bone->mName = aiString(bones[b].name);
            bone->mNumWeights = unsigned(bones[b].weights.size());
            bone->mWeights = new aiVertexWeight[bones[b].weights.size()];
            for (std::size_t w = 0; w < bones[b].weights.size(); ++w)
                bone->mWeights[w] = {bones[b].weights[w].first, bones[b].weights[w].second};
            mesh->mBones[b] = bone;
        }
        scene.mNumMeshes = 1;
        scene.mMeshes = new aiMesh* [1] { mesh };
    }
    prep::Scene read() {
        const std::filesystem::path path = "bones";
        AssimpImport import{scene, path, {}, {}};
        EXPECT_TRUE(import_meshes(import));
        EXPECT_TRUE(import_nodes(import));
        import_skins(import);
        return std::move(import.scene);
    }
    aiScene scene;
};

bool warned(const prep::Scene& scene, const std::string& text) {
    for (const std::string& warning : scene.warnings)
        if (warning.find(text) != std::string::npos) return true;
    return false;
}

TEST(AssimpBones, SeventyInfluencesAreSixtyFourAndTheRestIsCounted) {
    std::vector<Bones::Bone> bones;
    std::vector<std::string> names;
    for (int b = 0; b < 70; ++b) {
        names.push_back("b" + std::to_string(b));
        bones.push_back({names.back(), {{0, float(b + 1)}, {1, 1}, {2, 1}}});
    }
    const prep::Scene scene = Bones(bones, names).read();
    const auto& sets = scene.meshes[0].skin_influences;
    ASSERT_EQ(sets.size(), 16u);
    EXPECT_EQ(sets[0].joints[0][0], 69);  // the strongest first
    double sum = 0;
    for (const auto& set : sets)
        for (int k = 0; k < 4; ++k) sum += double(set.weights[0][k]);
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_TRUE(warned(scene, "18 influences beyond the 64 strongest"));
}

TEST(AssimpBones, BadWeightsAndBonesWithoutANodeAreLeftOutAndCounted) {
    const prep::Scene scene =
        Bones({{"a", {{0, 1}, {1, float(nan)}, {2, -1}, {7, 1}}}, {"nowhere", {{1, 1}}}}, {"a"})
            .read();
    EXPECT_TRUE(warned(scene, "3 weights of bones"));
    EXPECT_TRUE(warned(scene, "1 bone without a node"));
    EXPECT_TRUE(warned(scene, "2 vertices of skinned meshes without a weight"));
    ASSERT_EQ(scene.skins.size(), 1u);
    EXPECT_EQ(scene.skins[0].joints, (std::vector<std::uint32_t>{1, 0}));  // a, the mesh's own
}

TEST(AssimpBones, OfSeveralNodesWithOneNameTheFirstIsTakenAndItIsSaid) {
    const prep::Scene scene = Bones({{"a", {{0, 1}, {1, 1}, {2, 1}}}}, {"a", "a"}).read();
    EXPECT_EQ(scene.skins.at(0).joints, (std::vector<std::uint32_t>{1}));
    EXPECT_TRUE(warned(scene, "1 bone whose name several nodes have"));
}

TEST(AssimpBones, ABoneTwiceIsOneJoint) {
    const prep::Scene scene =
        Bones({{"a", {{0, 0.5f}, {1, 1}, {2, 1}}}, {"a", {{0, 0.5f}}}}, {"a"}).read();
    EXPECT_EQ(scene.skins.at(0).joints.size(), 1u);
    EXPECT_EQ(scene.meshes[0].skin_influences[0].weights[0], glm::vec4(1, 0, 0, 0));
}

TEST(AssimpNodes, AChainOfFiveThousandIsAnError) {
    aiScene scene;
    scene.mRootNode = new aiNode("root");
    aiNode* last = scene.mRootNode;
    for (int k = 0; k < 5000; ++k) {
        auto* child = new aiNode(k % 2 ? "x_$AssimpFbx$_Rotation" : "y");
        child->mParent = last;
        last->mNumChildren = 1;
        last->mChildren = new aiNode* [1] { child };
        last = child;
    }
    const std::filesystem::path path = "deep";
    AssimpImport import{scene, path, {}, {}};
    const auto done = import_nodes(import);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, prep::ErrorCode::limit);
}

}  // namespace
