// How the command writes numbers, sizes and tables, and which files it takes from a directory.
#include "meshprep/output/console.h"

#include <gtest/gtest.h>

#include <sstream>

#include "command_runner.h"

namespace {

namespace fs = std::filesystem;
using test::run_command;
using test::TempDir;
using test::write_text;

TEST(Console, CommasPartThousands) {
    EXPECT_EQ(meshprep::with_commas(0), "0");
    EXPECT_EQ(meshprep::with_commas(999), "999");
    EXPECT_EQ(meshprep::with_commas(1000), "1,000");
    EXPECT_EQ(meshprep::with_commas(123456), "123,456");
    EXPECT_EQ(meshprep::with_commas(18446744073709551615u), "18,446,744,073,709,551,615");
}

TEST(Console, CountsAreOfOneOrMany) {
    EXPECT_EQ(meshprep::count_of(1, "face", ""), "1 face");
    EXPECT_EQ(meshprep::count_of(0, "face", ""), "0 faces");
    EXPECT_EQ(meshprep::count_of(1000, "vertex", "vertices"), "1,000 vertices");
}

TEST(Console, SizesAreDecimal) {
    EXPECT_EQ(meshprep::byte_size(999), "999 B");
    EXPECT_EQ(meshprep::byte_size(1000), "1.0 kB");
    EXPECT_EQ(meshprep::byte_size(204800), "204.8 kB");
    EXPECT_EQ(meshprep::byte_size(5000000), "5.0 MB");
    EXPECT_EQ(meshprep::byte_size(7300000000), "7.3 GB");
}

TEST(Console, DurationsAreInWhatSuitsThem) {
    EXPECT_EQ(meshprep::duration(0.25), "0.2 ms");
    EXPECT_EQ(meshprep::duration(123.4), "123 ms");
    EXPECT_EQ(meshprep::duration(4321), "4.3 s");
}

TEST(Console, ColumnsStandBelowOneAnotherWhateverTheirLetters) {
    EXPECT_EQ(meshprep::align_table({{"Stuhl", "7"}, {"Möbelstück", "12"}, {"椅子", "345"}},
                                    {false, true}),
              (std::vector<std::string>{"  Stuhl         7", "  Möbelstück   12",
                                        "  椅子          345"}));
    // What would be blanks at the end is not written.
    EXPECT_EQ(meshprep::align_table({{"a", "b"}, {"long", "c d"}}, {}),
              (std::vector<std::string>{"  a     b", "  long  c d"}));
}

// Whatever a name holds, it makes no line of its own, and a terminal obeys none of it.
TEST(Console, AMessageIsOneLine) {
    std::ostringstream out, err;
    meshprep::Console console(out, err, false);
    const meshprep::CommonOptions common;
    const std::string name =
        "a\nmeshprep: error: b\x1b[2J\xc2\x9b"
        "2J.obj";
    const std::string shown = "a?meshprep: error: b?[2J?2J.obj";
    console.warning(common, name);
    console.error(name);
    console.result(common, name);
    EXPECT_EQ(err.str(), "meshprep: warning: " + shown + "\nmeshprep: error: " + shown + "\n");
    EXPECT_EQ(out.str(), shown + "\n");
    // What a reader printed is lines, with nothing in place of what is not shown.
    err.str("");
    console.note(name,
                 "one\x07\xc2\x9b"
                 "2J\nMöbel\n");
    EXPECT_EQ(err.str(),
              "meshprep: note: " + shown + ": one2J\nmeshprep: note: " + shown + ": Möbel\n");
}

TEST(FileList, DirectoriesGiveTheirMeshesInOrderAndNoScenes) {
    const TempDir dir;
    fs::create_directory(dir / "in");
    const std::vector<std::string> names{"c.obj", "a.obj", "e.obj", "b.obj", "d.obj"};
    for (const std::string& name : names) write_text(dir / "in" / name, test::cube_obj());
    write_text(dir / "in/scene.json",
               R"({"meshprep": 1, "meshes": {"a": {"shape": {"kind": "box"}}}})");
    write_text(dir / "in/notes.txt", "v 0 0 0\n");
    const test::Ran ran =
        run_command({"prepare", (dir / "in").string(), "-o", (dir / "out").string(), "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    std::vector<std::string> read;
    const nlohmann::json report = ran.json();
    for (const auto& file : report["files"])
        read.push_back(fs::path(file["input"].get<std::string>()).filename());
    EXPECT_EQ(read, (std::vector<std::string>{"a.obj", "b.obj", "c.obj", "d.obj", "e.obj"}));
    // A scene that is named is one.
    EXPECT_EQ(run_command(
                  {"prepare", (dir / "in/scene.json").string(), "-o", (dir / "scene.glb").string()})
                  .exit_code,
              0);
}

TEST(FileList, OneFileByTwoNamesIsNoTwoOutputs) {
    const TempDir dir;
    for (const char* name : {"a.obj", "b.obj"}) write_text(dir / name, test::cube_obj());
    fs::create_directory(dir / "out");
    write_text(dir / "out/a.glb", "old");
    fs::create_symlink("a.glb", dir / "out/b.glb");
    const test::Ran ran = run_command({"prepare", (dir / "a.obj").string(),
                                       (dir / "b.obj").string(), "-o", (dir / "out").string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find((dir / "b.obj").string() + ": two inputs would be written to "),
              std::string::npos)
        << ran.err;
    // The first one's.
    EXPECT_EQ(test::file_text(dir / "out/a.glb").substr(0, 4), "glTF");
    EXPECT_TRUE(fs::is_symlink(dir / "out/b.glb"));
}

}  // namespace
