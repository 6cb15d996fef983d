// What a second run of a batch makes of the first one's manifest, where files have changed between
// them, or the manifest is none that a run has written.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "command_runner.h"
#include "meshprep/files/json_depth.h"
#include "meshprep/files/read_watch.h"
#include "prep/image.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::file_text;
using test::run_command;
using test::run_here;
using test::TempDir;
using test::write_text;

std::string repeated(const std::string& text, int times) {
    std::string out;
    for (int n = 0; n < times; ++n) out += text;
    return out;
}

class Resumed : public ::testing::Test {
  protected:
    Resumed() { write_text(dir_ / "a.obj", test::cube_obj()); }
    std::string at(const std::string& name) const { return (dir_ / name).string(); }
    std::vector<std::string> words(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> list{"prepare",    at("a.obj"),     "-o",     at("out/"),
                                      "--manifest", at("made.json"), "--json", "--skip-unchanged"};
        list.insert(list.end(), more.begin(), more.end());
        return list;
    }
    // The state of the file; empty where there is none.
    std::string run(const std::vector<std::string>& more = {}, int expected = 0) const {
        const test::Ran ran = run_here(words(more));
        EXPECT_EQ(ran.exit_code, expected) << ran.err;
        const json document = ran.json();
        return document.contains("files") ? document["files"][0]["status"].get<std::string>() : "";
    }
    json made() const { return json::parse(file_text(dir_ / "made.json"), nullptr, false); }
    TempDir dir_;
};

TEST_F(Resumed, DepthIsOfBracketsOutsideOfTexts) {
    using meshprep::is_nested_deeper;
    EXPECT_FALSE(is_nested_deeper(R"([[{"a":[1]},[2]]])", 4));
    EXPECT_TRUE(is_nested_deeper(R"([[{"a":[1]},[2]]])", 3));
    EXPECT_FALSE(is_nested_deeper(R"(["[[[[\"[[[[","{{{{"])", 1));
    EXPECT_FALSE(is_nested_deeper(R"({"\\":[],"b":[]})", 2));
    EXPECT_TRUE(is_nested_deeper(R"({"\\":[[]]})", 2));
}

// A stack of 8 MiB holds some tens of thousands of calls.
TEST_F(Resumed, AManifestThatIsNestedDeeplyIsNone) {
    ASSERT_EQ(run(), "ok");
    const std::string good = file_text(dir_ / "made.json");
    const std::string deep = repeated("[", 200000) + repeated("]", 200000);
    for (const char* const key : {"\"settings\": {", "\"said\": {"}) {
        std::string text = good;
        const std::size_t from = text.find(key);
        ASSERT_NE(from, std::string::npos) << key;
        text.insert(from + std::string(key).size(), "\"deep\": " + deep + ", ");
        // "settings" is empty in it.
        if (const std::size_t comma = text.find(deep + ", }"); comma != std::string::npos)
            text.replace(comma + deep.size(), 3, "}");
        ASSERT_FALSE(json::parse(text, nullptr, false).is_discarded()) << key;
        write_text(dir_ / "made.json", text);
        const test::Ran ran = run_command(words());
        EXPECT_EQ(ran.exit_code, 1) << key;
        EXPECT_NE(ran.err.find("this is no manifest of meshprep"), std::string::npos) << ran.err;
    }
}

// What stands there and is what would be written is no conflict.
TEST_F(Resumed, WithoutOverwritingWhatIsDoneIsSkipped) {
    const std::string before = file_text(dir_ / "a.obj");
    ASSERT_EQ(run({"--no-overwrite"}), "ok");
    const std::string first = file_text(dir_ / "made.json");
    EXPECT_EQ(run({"--no-overwrite"}), "skipped");
    EXPECT_EQ(file_text(dir_ / "made.json"), first);
    write_text(dir_ / "a.obj", test::sphere_obj(8, 4));
    const std::string old = file_text(dir_ / "out/a.glb");
    EXPECT_EQ(run({"--no-overwrite"}, 1), "failed");
    EXPECT_EQ(file_text(dir_ / "out/a.glb"), old);
    // The failure has touched nothing, what is known of the file included.
    write_text(dir_ / "a.obj", before);
    EXPECT_EQ(run({"--no-overwrite"}), "skipped");
    write_text(dir_ / "a.obj", test::sphere_obj(8, 4));
    EXPECT_EQ(run(), "ok");
}

// In the order of docs: beside the model, in its picture folders, in those beside it, in the
// directories that the user names.
TEST_F(Resumed, APictureThatAppearsAtAnEarlierPlaceIsRead) {
    const auto picture = [](float shade) {
        return prep::Image{2, 2, 3, std::vector<float>(12, shade)};
    };
    fs::create_directories(dir_ / "first");
    fs::create_directories(dir_ / "second");
    fs::create_directories(dir_ / "textures");
    write_text(dir_ / "a.mtl", "newmtl m\nmap_Kd tex.png\n");
    write_text(dir_ / "a.obj", "mtllib a.mtl\nusemtl m\n" + test::textured_cube_obj());
    ASSERT_TRUE(prep::save_image(dir_ / "second/tex.png", picture(0)));
    const std::vector<std::string> places{"--texture-dir", at("first"), "--texture-dir",
                                          at("second")};
    EXPECT_EQ(run(places), "ok");
    EXPECT_EQ(run(places), "skipped");
    float shade = 0;
    for (const char* const earlier : {"first/tex.png", "textures/tex.png", "tex.png"}) {
        const std::string before = file_text(dir_ / "out/a.glb");
        ASSERT_TRUE(prep::save_image(dir_ / earlier, picture(shade += 0.25f)));
        EXPECT_EQ(run(places), "ok") << earlier;
        EXPECT_NE(file_text(dir_ / "out/a.glb"), before) << earlier;
        EXPECT_EQ(run(places), "skipped") << earlier;
    }
}

// At the very place that the file names, and of a library too; nothing else makes it done again.
TEST_F(Resumed, AFileThatAppearsWhereItIsNamedIsRead) {
    const auto picture = [](float shade) {
        return prep::Image{2, 2, 3, std::vector<float>(12, shade)};
    };
    fs::create_directories(dir_ / "sub");
    write_text(dir_ / "a.mtl", "newmtl m\nmap_Kd sub/tex.png\n");
    write_text(dir_ / "a.obj", "mtllib lib/a.mtl\nusemtl m\n" + test::textured_cube_obj());
    ASSERT_TRUE(prep::save_image(dir_ / "TEX.PNG", picture(0)));
    EXPECT_EQ(run(), "ok");
    EXPECT_EQ(run(), "skipped");
    for (const char* const earlier : {"tex.png", "sub/tex.png"}) {
        ASSERT_TRUE(prep::save_image(dir_ / earlier, picture(0.5f)));
        EXPECT_EQ(run(), "ok") << earlier;
        EXPECT_EQ(run(), "skipped") << earlier;
    }
    // The picture is where it is named: it is sought nowhere else.
    fs::create_directories(dir_ / "textures/sub");
    ASSERT_TRUE(prep::save_image(dir_ / "textures/sub/tex.png", picture(1)));
    ASSERT_TRUE(prep::save_image(dir_ / "textures/tex.png", picture(1)));
    EXPECT_EQ(run(), "skipped");
    fs::create_directories(dir_ / "lib");
    write_text(dir_ / "lib/a.mtl", "newmtl m\nKd 1 0 0\n");
    EXPECT_EQ(run(), "ok");
    EXPECT_EQ(run(), "skipped");
}

// Neither the picture itself, by a way through a directory that is not there, nor a directory of
// its name is a file that could appear.
TEST_F(Resumed, WhatIsThereIsNotWaitedFor) {
    fs::create_directories(dir_ / "textures");
    fs::create_directories(dir_ / "maps");
    const prep::Image picture{2, 2, 3, std::vector<float>(12, 0.5f)};
    ASSERT_TRUE(prep::save_image(dir_ / "tex.png", picture));
    fs::copy_file(dir_ / "tex.png", dir_ / "textures/maps");
    for (const char* const name : {"nodir/../tex.png", "maps"}) {
        write_text(dir_ / "a.mtl", "newmtl m\nmap_Kd " + std::string(name) + "\n");
        write_text(dir_ / "a.obj", "mtllib a.mtl\nusemtl m\n" + test::textured_cube_obj());
        EXPECT_EQ(run(), "ok") << name;
        EXPECT_EQ(run(), "skipped") << name;
    }
}

// What a scene file's meshes lack is lacking in the scene.
TEST_F(Resumed, ALibraryThatAMeshOfASceneLacksIsLookedForAgain) {
    write_text(dir_ / "part.obj", "mtllib part.mtl\nusemtl m\n" + test::textured_cube_obj());
    write_text(dir_ / "s.json", R"({"meshprep": 1, "meshes": {"x": {"file": "part.obj"}}})");
    const auto state = [&] {
        const test::Ran ran = run_here({"prepare", at("s.json"), "-o", at("out/"), "--manifest",
                                        at("made.json"), "--json", "--skip-unchanged"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.json()["files"][0]["status"].get<std::string>();
    };
    EXPECT_EQ(state(), "ok");
    EXPECT_EQ(state(), "ok");
    write_text(dir_ / "part.mtl", "newmtl m\nKd 1 0 0\n");
    EXPECT_EQ(state(), "ok");
    EXPECT_EQ(state(), "skipped");
}

TEST_F(Resumed, ChangesAreSeenBySizeAndTime) {
    const fs::path file = dir_ / "a.obj", other = dir_ / "b.obj";
    write_text(other, "b");
    const meshprep::ReadWatch watch(file);
    EXPECT_TRUE(watch.unchanged(file));
    EXPECT_TRUE(watch.unchanged(other));
    EXPECT_FALSE(watch.unchanged(dir_ / "none"));
    // Of the input its size tells; of others the time of the change, once the clock has moved on.
    write_text(file, file_text(file) + "#");
    EXPECT_FALSE(watch.unchanged(file));
    bool seen = false;
    for (int n = 0; n < 1000000 && !seen; ++n) {
        write_text(other, "c");
        seen = !watch.unchanged(other);
    }
    EXPECT_TRUE(seen);
}

}  // namespace
