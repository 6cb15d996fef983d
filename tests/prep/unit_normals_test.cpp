// Kept normals keep their direction and are unit from there on: in what is written, and for
// tangents. Mode mikktspace_exact alone takes them as they are.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gltf_source.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

namespace fs = std::filesystem;

double length(const std::vector<double>& v) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// A bent strip of two triangles with these normals, a value for each of its four corners, and UVs.
prep::Scene strip(const std::vector<glm::vec3>& normals) {
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2f}, {0, 1, 0}};
    mesh.face_offsets = {0, 3, 6};
    mesh.corner_vertices = {0, 1, 2, 0, 2, 3};
    mesh.normals = {normals, mesh.corner_vertices};
    mesh.uvs.resize(1);
    mesh.uvs[0] = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, mesh.corner_vertices};
    prep::Scene scene;
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    return scene;
}

prep::PrepareOptions with_tangents(prep::TangentMode mode = prep::TangentMode::mikktspace) {
    prep::PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    options.tangent.mode = mode;
    return options;
}

// Directions all around, their lengths off by what a validator lets pass, or by a lot.
std::vector<glm::vec3> directions(unsigned seed, double scale) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<glm::vec3> out;
    while (out.size() < 4) {
        const glm::dvec3 d(normal(random), normal(random), 3 + normal(random));
        out.push_back(glm::vec3(d / glm::length(d) * scale));
    }
    return out;
}

TEST(UnitNormals, KeepTheDirectionAndLoseTheLength) {
    for (const double scale : {1 - 4e-4, 1 + 4.9e-4, 1 + 3e-6, 0.5, 1e-20, 1e20}) {
        for (unsigned seed = 0; seed < 50; ++seed) {
            const auto given = directions(seed, scale);
            const auto result = prep::prepare(strip(given));
            ASSERT_TRUE(result.has_value());
            const prep::VertexMesh& mesh = result->meshes[0];
            ASSERT_EQ(mesh.normals.size(), 4u);
            for (const glm::vec3& n : mesh.normals) {
                const glm::dvec3 d(n);
                EXPECT_NEAR(glm::length(d), 1, 1e-7) << scale << ", seed " << seed;
                double nearest = 4;
                for (const glm::vec3& g : given)
                    nearest = std::min(nearest, glm::distance(d, glm::normalize(glm::dvec3(g))));
                EXPECT_LT(nearest, 1e-7) << scale << ", seed " << seed;
            }
        }
    }
}

TEST(UnitNormals, OnesThatOnlyRoundingKeepsFromUnitKeepTheirBits) {
    for (unsigned seed = 0; seed < 200; ++seed) {
        const auto given = directions(seed, 1);
        const auto result = prep::prepare(strip(given));
        ASSERT_TRUE(result.has_value());
        EXPECT_EQ(result->scene.meshes[0].normals.values, given) << "seed " << seed;
    }
}

// The tangents of lengthened normals are those of the unit ones: projected on the same planes.
TEST(UnitNormals, AreWhatTangentsAreMadeFrom) {
    for (unsigned seed = 0; seed < 50; ++seed) {
        const auto unit = prep::prepare(strip(directions(seed, 1)), with_tangents());
        const auto longer = prep::prepare(strip(directions(seed, 1 + 4.5e-4)), with_tangents());
        ASSERT_TRUE(unit.has_value() && longer.has_value());
        ASSERT_EQ(unit->meshes[0].tangents.size(), longer->meshes[0].tangents.size());
        for (std::size_t v = 0; v < unit->meshes[0].tangents.size(); ++v) {
            const glm::dvec4 a(unit->meshes[0].tangents[v]), b(longer->meshes[0].tangents[v]);
            EXPECT_LT(glm::distance(a, b), 1e-6) << "seed " << seed;
            EXPECT_NEAR(glm::dot(glm::dvec3(b), glm::dvec3(longer->meshes[0].normals[v])), 0, 1e-6);
        }
    }
}

TEST(UnitNormals, AreNotForTheModeThatRepeatsTheReference) {
    const auto given = directions(7, 1 + 4e-4);
    const auto result =
        prep::prepare(strip(given), with_tangents(prep::TangentMode::mikktspace_exact));
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->scene.meshes[0].normals.values, given);
}

TEST(UnitNormals, KeptTangentsAreUnitToo) {
    prep::Scene scene = strip({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
    prep::Mesh& mesh = scene.meshes[0];
    mesh.tangents = {{{0.9997f, 0, 0, -1}}, std::vector<std::uint32_t>(6, 0)};
    const auto result = prep::prepare(std::move(scene), with_tangents());
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->scene.meshes[0].tangents.values[0], glm::vec4(1, 0, 0, -1));
}

// Whole numbers say directions, not lengths: a file that needs nothing keeps its accessors.
TEST(UnitNormals, OfWholeNumbersStayAsTheFileHasThem) {
    test::GltfSource source;
    source.json["extensionsUsed"] = source.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    const auto positions = source.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const auto normals =
        source.add<std::int8_t>("VEC3", {10, 70, 105, 0, 0, 127, -70, 0, 105}, true);
    source.mesh(test::GltfMaker::Json::array(
        {{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}}}));
    const test::TempDir dir;
    source.write(dir / "in.glb");
    auto scene = prep::load_scene(dir / "in.glb");
    ASSERT_TRUE(scene.has_value());
    auto prepared = prep::prepare(std::move(*scene));
    ASSERT_TRUE(prepared.has_value());
    for (const glm::vec3& n : prepared->meshes[0].normals)
        EXPECT_NEAR(glm::length(glm::dvec3(n)), 1, 1e-7);
    ASSERT_TRUE(prep::save_scene(*prepared, dir / "out.glb").has_value());
    const test::GltfFile out(dir / "out.glb");
    EXPECT_EQ(out.attribute(0, 0, "NORMAL").component_type, 5120);
    EXPECT_EQ(test::gltf_difference(test::GltfFile(dir / "in.glb"), out, {}), "");
}

// Every normal that was written as floats, of all glTF files there are, with tangents asked for.
TEST(UnitNormals, InEverythingThatIsWritten) {
    MESHPREP_REQUIRE_SHARED(shared);
    const test::TempDir dir;
    std::size_t files = 0, normals = 0;
    for (const char* folder : {"corpus", "real_files"}) {
        for (const auto& entry : fs::recursive_directory_iterator(shared / folder)) {
            const std::string ending = entry.path().extension().string();
            if (ending != ".glb" && ending != ".gltf") continue;
            auto scene = prep::load_scene(entry.path());
            if (!scene) continue;  // files that are refused have tests of their own
            auto prepared = prep::prepare(std::move(*scene), with_tangents());
            ASSERT_TRUE(prepared.has_value()) << entry.path();
            if (!prep::save_scene(*prepared, dir / "out.glb")) {
                // Of the validator's own some are broken; tests/tools/corpus_test.cpp says which.
                EXPECT_NE(entry.path().string().find("gltf-validator"), std::string::npos)
                    << entry.path();
                continue;
            }
            const test::GltfFile out(dir / "out.glb");
            ++files;
            if (out.json.dump().find("_compression\"") != std::string::npos) {
                // Not for the reader of these tests.
                const auto again = prep::load_scene(dir / "out.glb");
                ASSERT_TRUE(again.has_value()) << entry.path();
                for (const prep::Mesh& mesh : again->meshes)
                    for (const glm::vec3& n : mesh.normals.values) {
                        ASSERT_NEAR(glm::length(glm::dvec3(n)), 1, 1e-6) << entry.path();
                        ++normals;
                    }
                continue;
            }
            for (const auto& mesh : out.json.value("meshes", nlohmann::json::array())) {
                for (const auto& primitive : mesh["primitives"]) {
                    const auto& attributes = primitive["attributes"];
                    for (const char* name : {"NORMAL", "TANGENT"}) {
                        if (!attributes.contains(name)) continue;
                        const test::GltfValues values = out.accessor(attributes[name]);
                        if (values.component_type != 5126) continue;
                        for (std::size_t i = 0; i < values.count(); ++i) {
                            // The validator's own broken files: tangents of points, all zero.
                            if (name[0] == 'T' && length(values.at(i)) == 0) continue;
                            ASSERT_NEAR(length(values.at(i)), 1, 1e-6)
                                << entry.path() << " " << name << " " << i;
                        }
                        normals += values.count();
                    }
                }
            }
        }
    }
    EXPECT_GT(files, 60u);
    EXPECT_GT(normals, 500'000u);
}

}  // namespace
