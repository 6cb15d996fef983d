// What a second run of a batch makes of the first one's manifest, where files have changed between
// them, or the manifest is none that a run has written.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "command_runner.h"
#include "meshprep/files/json_depth.h"

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
        std::vector<std::string> list{"prepare",  at("a.obj"),          "-o",    at("out/"),
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
    ASSERT_EQ(run({"--no-overwrite"}), "ok");
    const std::string first = file_text(dir_ / "made.json");
    EXPECT_EQ(run({"--no-overwrite"}), "skipped");
    EXPECT_EQ(file_text(dir_ / "made.json"), first);
    write_text(dir_ / "a.obj", test::sphere_obj(8, 4));
    const std::string old = file_text(dir_ / "out/a.glb");
    EXPECT_EQ(run({"--no-overwrite"}, 1), "failed");
    EXPECT_EQ(file_text(dir_ / "out/a.glb"), old);
    EXPECT_EQ(run(), "ok");
}

}  // namespace
