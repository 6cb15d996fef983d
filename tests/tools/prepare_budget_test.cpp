// `prepare --budget-ms`: what is chosen by known times, what the printed command writes,
// what is said. Times themselves are the machine's: nothing here depends on how long anything
// takes.
#include "meshprep/budgets/prepare_budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include "command_runner.h"

namespace {

using meshprep::Json;
using test::run_here;
using test::TempDir;
using test::write_text;

TEST(PrepareBudget, TheLastThatFitsIsChosenAndTheNextOneTold) {
    const auto chosen = [](double asked, const std::vector<double>& times) {
        std::vector<meshprep::TimePrediction> tried;
        for (const double t : times) tried.push_back({std::to_string(tried.size()), t});
        return meshprep::chosen_in_time(asked, std::move(tried));
    };
    EXPECT_EQ(chosen(3, {1, 2, 4}).chosen.setting, "1");
    EXPECT_EQ(chosen(3, {1, 2, 4}).index, 1u);
    EXPECT_EQ(chosen(3, {1, 2, 4}).next->setting, "2");
    EXPECT_EQ(chosen(2, {1, 2, 4}).index, 1u);
    // What is more accurate may be faster.
    EXPECT_EQ(chosen(3, {1, 5, 2}).index, 2u);
    EXPECT_FALSE(chosen(3, {1, 5, 2}).next);
    const auto none = chosen(1, {3, 2, 4});
    EXPECT_FALSE(none.met);
    EXPECT_EQ(none.index, 1u);
    EXPECT_EQ(none.chosen.milliseconds, 2);
}

TEST(PrepareBudget, APrecisionAddsWhatItAddsToSomeFaces) {
    // 600 corners of 6,000 took 2, 3 and 52 ms.
    const auto p = meshprep::precision_predictions(30, {2, 3, 52}, 600, 6000);
    ASSERT_EQ(p.size(), 3u);
    EXPECT_EQ(p[0].setting, "--precision=fast");
    EXPECT_EQ(p[0].milliseconds, 30);
    EXPECT_EQ(p[1].setting, "--precision=accurate");
    EXPECT_NEAR(p[1].milliseconds, 40, 1e-12);
    EXPECT_EQ(p[2].setting, "--precision=exact");
    EXPECT_NEAR(p[2].milliseconds, 530, 1e-12);
    // Where no normals are made, no precision costs anything.
    EXPECT_EQ(meshprep::precision_predictions(30, {0, 0, 0}, 0, 0)[2].milliseconds, 30);
    // Clocks that were interrupted make no time that is none.
    EXPECT_EQ(meshprep::precision_predictions(30, {9, 1, 1}, 1, 10)[2].milliseconds, 0);
}

// A grid of n by n squares in the plane z = `z`, row by row.
prep::Mesh grid(std::uint32_t n, float z) {
    prep::Mesh mesh;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) mesh.positions.emplace_back(i, j, z);
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t at = j * (n + 1) + i;
            for (const std::uint32_t v : {at, at + 1, at + n + 2, at + n + 1})
                mesh.corner_vertices.push_back(v);
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        }
    return mesh;
}

TEST(PrepareBudget, SampledFacesLieTogether) {
    prep::Scene scene;
    scene.meshes = {grid(8, 0), grid(100, 1), grid(300, 2)};
    scene.meshes[1].morph_targets.resize(2);
    // Of small meshes all: the first one is no fourth of all faces, and authored besides.
    meshprep::SampledFaces some = meshprep::sampled_faces(scene, {true, false, false});
    ASSERT_EQ(some.scene.meshes.size(), 1u);
    EXPECT_EQ(some.scene.meshes[0].positions, scene.meshes[0].positions);
    EXPECT_EQ(some.scene.meshes[0].corner_vertices, scene.meshes[0].corner_vertices);
    EXPECT_EQ(some.scene.meshes[0].face_offsets, scene.meshes[0].face_offsets);
    EXPECT_EQ(some.corners, 256);
    EXPECT_EQ(some.corners_of_all, 256);
    // 10,000 and 90,000 faces: the middles of all fourths are the second's.
    some = meshprep::sampled_faces(scene, {false, true, true});
    ASSERT_EQ(some.scene.meshes.size(), 4u);
    EXPECT_EQ(some.corners, 4 * 1024 * 4);
    EXPECT_EQ(some.corners_of_all, 3 * 40'000 + 360'000);
    for (const prep::Mesh& part : some.scene.meshes) {
        EXPECT_EQ(part.face_count(), 1024u);
        // A disc or, at the grid's side, a half of one: 1,024 faces with few more vertices.
        EXPECT_LT(part.vertex_count(), 1024u + 100);
        glm::vec3 low(1e9f), high(-1e9f);
        for (const glm::vec3& p : part.positions) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        EXPECT_LT(high.x - low.x, 60);
        EXPECT_LT(high.y - low.y, 60);
        EXPECT_EQ(low.z, 2);
        EXPECT_EQ(high.z, 2);
    }
    // Positions that are none are nowhere near.
    for (glm::vec3& p : scene.meshes[2].positions)
        if (p.x > 200) p.x = NAN;
    some = meshprep::sampled_faces(scene, {false, false, true});
    EXPECT_EQ(some.scene.meshes.size(), 4u);
    EXPECT_EQ(meshprep::sampled_faces(scene, {false, false, false}).corners, 0);
    EXPECT_TRUE(meshprep::sampled_faces({}, {}).scene.meshes.empty());
}

TEST(PrepareBudget, LevelsGoOnAsTheLastOneGrew) {
    // 5 ms and 0.25 ms for each face of level 0: what is fixed is not multiplied.
    const auto time = [](int level) { return 5 + 0.25 * std::pow(4.0, level); };
    for (const std::size_t known : {2u, 3u}) {
        std::vector<double> taken;
        for (std::size_t level = 0; level < known; ++level) taken.push_back(time(int(level)));
        const auto p = meshprep::level_predictions(taken, 5, "loop");
        ASSERT_EQ(p.size(), 6u);
        for (int level = 0; level <= 5; ++level)
            EXPECT_NEAR(p[std::size_t(level)].milliseconds, time(level), 1e-9) << level;
        for (std::size_t level = 0; level <= 5; ++level)
            EXPECT_EQ(p[level].measured, level < known) << level;
        EXPECT_EQ(p[4].setting, "--subdivide=loop:4");
    }
    // Of one level alone all of it is taken for the faces'.
    EXPECT_EQ(meshprep::level_predictions({2}, 1, "catmark")[1].milliseconds, 8);
    // A level that took no longer than the one before: all of it is taken for its faces'.
    EXPECT_EQ(meshprep::level_predictions({3, 2}, 3, "catmark")[3].milliseconds, 32);
}

TEST(PrepareBudget, LevelsEndWhereFacesAreTooMany) {
    EXPECT_EQ(meshprep::finest_level(0), 10);
    EXPECT_EQ(meshprep::finest_level(24), 10);       // a cube: 24 · 4^9
    EXPECT_EQ(meshprep::finest_level(1u << 24), 1);  // a face for each corner
    EXPECT_EQ(meshprep::finest_level((1u << 24) + 1), 0);
    EXPECT_EQ(meshprep::finest_level(1u << 22), 2);
}

class PrepareInTime : public ::testing::Test {
  protected:
    PrepareInTime() {
        write_text(dir_ / "ball.obj", test::sphere_obj(14, 7));
        write_text(dir_ / "cube.obj", test::cube_obj());
    }
    std::string at(const std::string& name) const { return (dir_ / name).string(); }
    test::Ran prepared(const std::string& mesh, const std::vector<std::string>& more) {
        std::vector<std::string> words = {"prepare",   at(mesh), "-o",
                                          at("o.glb"), "--json", "--threads=1"};
        words.insert(words.end(), more.begin(), more.end());
        return run_here(words);
    }
    // What the printed command writes, run by a shell.
    void repeats(std::string again) {
        EXPECT_EQ(again.find("budget"), std::string::npos) << again;
        const std::string written = test::file_text(dir_ / "o.glb");
        std::filesystem::remove(dir_ / "o.glb");
        again = "'" + test::command_path().string() + "'" + again.substr(8);
        const test::Ran ran = test::run_program("/bin/sh", {"-c", again});
        ASSERT_EQ(ran.exit_code, 0) << again << ran.err;
        EXPECT_EQ(test::file_text(dir_ / "o.glb"), written) << again;
    }
    TempDir dir_;
};

TEST_F(PrepareInTime, TheMostAccurateThatFitsIsWritten) {
    const test::Ran ran = prepared("ball.obj", {"--budget-ms=1e9", "--hard-angle=off"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const Json f = ran.json()["files"][0], b = f["budget"];
    EXPECT_EQ(b["chosen"]["setting"], "--precision=exact");
    EXPECT_EQ(b["tried"].size(), 3u);
    EXPECT_TRUE(b["next"].is_null());
    EXPECT_GT(b["pilot"]["milliseconds"], 0);
    EXPECT_GT(b["taken"], 0);
    EXPECT_EQ(b["overrun"], false);
    // With what a process of its own adds.
    EXPECT_LE(f["milliseconds"]["prepare"], b["taken"]);
    EXPECT_GT(f["milliseconds"]["prepare"].get<double>() + 5, b["taken"].get<double>());
    // Rationals take at least twice as long as floats.
    EXPECT_GT(b["tried"][2]["milliseconds"].get<double>(),
              2 * b["tried"][0]["milliseconds"].get<double>());
    EXPECT_GT(b["taken"].get<double>(), 2 * b["tried"][0]["milliseconds"].get<double>());
    repeats(b["command"]);
}

TEST_F(PrepareInTime, WhereNothingFitsTheFastestIsWritten) {
    const test::Ran ran = prepared("ball.obj", {"--budget-ms=0"});
    EXPECT_EQ(ran.exit_code, 1);
    const Json b = ran.json()["files"][0]["budget"];
    EXPECT_EQ(b["met"], false);
    EXPECT_LE(b["chosen"]["milliseconds"], b["tried"][0]["milliseconds"]);
    EXPECT_NE(b["chosen"]["setting"], "--precision=exact");
    // What was prepared to find out is what is written.
    if (b["chosen"]["setting"] == "--precision=fast") {
        EXPECT_GE(b["taken"], b["tried"][0]["milliseconds"]);
    }
    EXPECT_NE(ran.err.find("nothing is predicted to prepare within 0 ms"), std::string::npos)
        << ran.err;
    repeats(b["command"]);
}

TEST_F(PrepareInTime, LevelsAreChosenByTheirOwnTimes) {
    for (const bool none : {false, true}) {
        const test::Ran ran =
            prepared("cube.obj", {none ? "--budget-ms=0" : "--budget-ms=60", "--subdivide=catmark",
                                  "--creasing=chaikin", "--quantize=auto", "--normal-error=0.1"});
        ASSERT_EQ(ran.exit_code, none ? 1 : 0) << ran.err;
        const Json f = ran.json()["files"][0], b = f["budget"];
        EXPECT_EQ(b["tried"].size(), 11u);
        std::size_t chosen = 0;
        while (b["tried"][chosen] != b["chosen"]) ++chosen;
        if (none) {
            EXPECT_EQ(chosen, 0u);
        } else {
            // The last that fits, by what is said of all.
            EXPECT_GT(chosen, 0u);
            for (std::size_t k = chosen + 1; k < 11; ++k)
                EXPECT_GT(b["tried"][k]["milliseconds"].get<double>(), 60);
        }
        EXPECT_EQ(f["after"]["triangles"], 12 * std::size_t(std::pow(4, chosen)));
        const std::string again = b["command"];
        EXPECT_NE(again.find("--creasing=chaikin"), std::string::npos) << again;
        EXPECT_EQ(again, f["certificate"]["command"]);
        repeats(again);
    }
}

// Level 1 is prepared whether it fits or not: with a time between level 0's and its own, what was
// prepared last is not what is written. Clocks may say otherwise once.
TEST_F(PrepareInTime, ALevelThatWasTriedAndDoesNotFitIsNotWritten) {
    write_text(dir_ / "fine.obj", test::sphere_obj(64, 40));
    const auto prepared_file = [&](double asked) {
        const test::Ran ran =
            prepared("fine.obj", {"--budget-ms=" + std::to_string(asked), "--subdivide=catmark"});
        return ran.json()["files"][0];
    };
    constexpr int most_attempts = 20;
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
        const Json tried = prepared_file(30)["budget"]["tried"];
        const double none = tried[0]["milliseconds"], one = tried[1]["milliseconds"];
        const Json file = prepared_file(std::sqrt(none * one)), budget = file["budget"];
        const Json& first = budget["tried"][0];
        const Json& second = budget["tried"][1];
        ASSERT_TRUE(second["measured"]);
        const bool between =
            first["milliseconds"] <= budget["asked"] && second["milliseconds"] > budget["asked"];
        if (!between) continue;
        EXPECT_TRUE(budget["met"]);
        EXPECT_EQ(budget["chosen"], budget["tried"][0]);
        const double triangles = file["after"]["triangles"];
        EXPECT_LT(triangles, 3 * 64 * 40);  // level 1 has four times as many
        // It was prepared once more: another time.
        EXPECT_NE(budget["taken"], budget["chosen"]["milliseconds"]);
        repeats(budget["command"]);
        return;
    }
    GTEST_SKIP() << "no clock of " << most_attempts << " runs set level 1 apart from level 0";
}

TEST(PrepareBudget, RefusesWhatMakesNoSense) {
    const TempDir dir;
    const std::vector<std::vector<std::string>> refused = {
        {"--budget-ms", "-1"},
        {"--budget-ms", "soon"},
        {"--budget-ms", "9", "--precision", "fast"},
        {"--budget-ms", "9", "--subdivide", "loop:2"},
        {"--budget-ms", "9", "--chord-error", "0.1"},
        {"--budget-ms", "9", "--displace", "noise"},
        {"--budget-ms", "9", "--jobs", "2"}};
    write_text(dir / "ball.obj", test::sphere_obj(14, 7));
    for (const std::vector<std::string>& more : refused) {
        std::vector<std::string> words = {"prepare", (dir / "ball.obj").string(), "-o",
                                          (dir / "x.glb").string()};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run_here(words).exit_code, 2) << more[0] << " " << more.back();
    }
    EXPECT_FALSE(std::filesystem::exists(dir / "x.glb"));
}

}  // namespace
