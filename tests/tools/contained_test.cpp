// The command with files that end the libraries that read them: an error for each, and everything
// else goes on.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <set>
#include <thread>

#include "command_runner.h"
#include "prep/formats.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;
using test::run_command;
using test::TempDir;
using test::write_text;

constexpr const char* crashed_by_signal =
    "Assimp, which reads this format, crashed on the file (SIG";

// Files that end Assimp, each by itself.
void expect_contained(const fs::path& shared, const std::string& name) {
    const fs::path file = shared / "real_files" / name;
    const TempDir dir;
    const std::string out = (dir / "out.glb").string();
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"prepare", file.string(), "-o", out, "--json"},
          {"inspect", file.string(), "--json"}}) {
        SCOPED_TRACE(arguments[0]);
        const test::Ran ran = run_command(arguments);
        EXPECT_EQ(ran.exit_code, 1) << ran.err;
        const nlohmann::json json = ran.json();
        ASSERT_FALSE(json.is_null()) << ran.out;
        const nlohmann::json& error = json["files"][0]["error"];
        EXPECT_EQ(error["place"], file.string());
        const std::string text = error["text"];
        EXPECT_TRUE(text.starts_with(crashed_by_signal)) << text;
        EXPECT_EQ(ran.err, "meshprep: error: " + file.string() + ": " + text + "\n");
    }
    EXPECT_TRUE(dir.names().empty());
}

TEST(RealFiles, CounterX3mfIsAnErrorWithFileReaderAndSignal) {
    MESHPREP_REQUIRE_SHARED(shared);
    expect_contained(shared, "counterX.3MF");
}

TEST(RealFiles, DropoutBufferOverflowCsmIsAnErrorWithFileReaderAndSignal) {
    MESHPREP_REQUIRE_SHARED(shared);
    expect_contained(shared, "DropoutBufferOverflow.csm");
}

// Assimp would write far beyond a list, into whatever lies there: the file never gets to it.
TEST(RealFiles, OverflowingTriangleIndexMd5meshIsAnErrorWithFileAndLine) {
    MESHPREP_REQUIRE_SHARED(shared);
    const std::string file = (shared / "real_files/OverflowingTriangleIndex.md5mesh").string();
    for (const char* command : {"prepare", "inspect"}) {
        const TempDir dir;
        std::vector<std::string> arguments{command, file};
        if (arguments[0] == "prepare") {
            arguments.push_back("-o");
            arguments.push_back((dir / "out.glb").string());
        }
        const test::Ran ran = run_command(arguments);
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_EQ(ran.err, "meshprep: error: " + file +
                               ":18: 'tri 4294967295' is beyond what a file of 271 bytes can "
                               "hold\n");
        EXPECT_TRUE(dir.names().empty());
    }
}

// All meshes of the shared data at once, in an order in which those that crash come early: what has
// an output by itself has it here, the rest is told, and standard output is JSON and nothing else.
TEST(RealFiles, ABatchWithThoseThatCrashWritesEveryOtherOutput) {
    MESHPREP_REQUIRE_SHARED(shared);
    const std::vector<std::string> crashing = {"counterX.3MF", "DropoutBufferOverflow.csm"};
    std::vector<std::string> inputs;
    for (const std::string& name : crashing)
        inputs.push_back((shared / "real_files" / name).string());
    std::set<std::string> stems;
    for (const char* folder : {"real_files", "corpus"})
        for (const auto& entry : fs::recursive_directory_iterator(shared / folder)) {
            const fs::path& path = entry.path();
            const prep::FileFormat* const format = prep::file_format(path);
            if (!entry.is_regular_file() || !format || !format->meshes ||
                path.string().find("gltf-validator") != std::string::npos ||
                entry.file_size() > 6'000'000 ||
                std::count(crashing.begin(), crashing.end(), path.filename().string()) > 0 ||
                !stems.insert(path.stem().string()).second)
                continue;
            inputs.push_back(path.string());
        }
    ASSERT_GT(inputs.size(), 60u);
    const TempDir dir;
    std::vector<std::string> arguments{"prepare"};
    arguments.insert(arguments.end(), inputs.begin(), inputs.end());
    for (const char* word : {"-o", "--json"}) {
        arguments.push_back(word);
        if (std::string(word) == "-o") arguments.push_back(dir.path().string());
    }
    const test::Ran ran = run_command(arguments);
    EXPECT_EQ(ran.exit_code, 1);
    const nlohmann::json json = ran.json();
    ASSERT_FALSE(json.is_null()) << ran.out.substr(0, 500);
    ASSERT_EQ(json["files"].size(), inputs.size());
    std::size_t written = 0, failed = 0, crashed = 0;
    for (const nlohmann::json& file : json["files"]) {
        const fs::path output = file["output"].get<std::string>();
        if (file["status"] == "ok") {
            ++written;
            EXPECT_EQ(test::file_text(output).substr(0, 4), "glTF") << output;
        } else {
            ++failed;
            EXPECT_FALSE(fs::exists(output)) << output;
            crashed += file["error"]["text"].get<std::string>().find(" crashed on the file (SIG") !=
                       std::string::npos;
        }
    }
    EXPECT_EQ(crashed, crashing.size());
    for (std::size_t file = 0; file < crashing.size(); ++file)
        EXPECT_EQ(json["files"][file]["status"], "failed") << crashing[file];
    EXPECT_EQ(dir.names().size(), written);
    // Those that fail beside them fail by themselves.
    for (const nlohmann::json& file : json["files"])
        if (file["status"] != "ok") {
            const TempDir alone;
            const test::Ran one = run_command(
                {"prepare", file["input"].get<std::string>(), "-o", (alone / "x.glb").string()});
            EXPECT_EQ(one.exit_code, 1) << file["input"];
            EXPECT_EQ(one.err.find("meshprep: error: "), 0u) << one.err;
        }
    std::cout << inputs.size() << " files: " << written << " written, " << failed
              << " failed, of these " << crashed << " crashed their reader\n";
}

// ---- the reader's process and the command's ----

std::vector<pid_t> children_of(pid_t parent) {
    std::vector<pid_t> list;
    for (const auto& process : fs::directory_iterator("/proc")) {
        const std::string stat = test::file_text(process.path() / "stat");
        const std::size_t name = stat.rfind(')');
        int of = 0;
        if (name != std::string::npos && std::sscanf(stat.c_str() + name, ") %*c %d", &of) == 1 &&
            of == parent)
            list.push_back(std::stoi(process.path().filename()));
    }
    return list;
}

bool runs(pid_t process) {
    const std::string stat = test::file_text("/proc/" + std::to_string(process) + "/stat");
    const std::size_t name = stat.rfind(')');
    return name != std::string::npos && stat.substr(name, 3) != ") Z";
}

template <class Condition>
bool comes_true(const Condition& condition) {
    for (int i = 0; i < 2000; ++i) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}

// The command, busy with a file that its reader never ends with.
class BusyCommand {
  public:
    BusyCommand() {
        write_text(dir / "hangs.fbx", "x");
        std::string program = test::command_path().string(), verb = "prepare",
                    in = (dir / "hangs.fbx").string(), option = "-o",
                    out = (dir / "out.glb").string();
        char* const argv[] = {program.data(), verb.data(), in.data(),
                              option.data(),  out.data(),  nullptr};
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        for (const int stream : {1, 2})
            posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
        std::string reader = std::string("MESHPREP_READER=") + MESHPREP_BAD_READER;
        std::vector<char*> environment{reader.data()};
        for (char** variable = environ; *variable; ++variable) environment.push_back(*variable);
        environment.push_back(nullptr);
        EXPECT_EQ(
            ::posix_spawn(&process, program.c_str(), &actions, nullptr, argv, environment.data()),
            0);
        posix_spawn_file_actions_destroy(&actions);
        EXPECT_TRUE(comes_true([&] { return !children_of(process).empty(); }));
        readers = children_of(process);
    }
    TempDir dir;
    pid_t process = 0;
    std::vector<pid_t> readers;
};

TEST(ReaderProcess, EndsWithTheCommandHoweverThatEnds) {
    for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
        SCOPED_TRACE(signal);
        BusyCommand command;
        ASSERT_EQ(command.readers.size(), 1u);
        ::kill(command.process, signal);
        int status = 0;
        EXPECT_EQ(::waitpid(command.process, &status, 0), command.process);
        EXPECT_TRUE(comes_true([&] { return !runs(command.readers[0]); }));
        EXPECT_EQ(command.dir.names(), std::vector<std::string>{"hangs.fbx"});
    }
}

TEST(ReaderProcess, FilesOfOurOwnFormatsStartNone) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    test::Circumstances circumstances;
    circumstances.environment = {{"MESHPREP_READER", "/nowhere/meshprep-reader"}};
    const std::string obj = (dir / "cube.obj").string(), glb = (dir / "cube.glb").string();
    EXPECT_EQ(run_command({"prepare", obj, "-o", glb}, circumstances).exit_code, 0);
    EXPECT_EQ(run_command({"inspect", glb}, circumstances).exit_code, 0);
    write_text(dir / "a.fbx", "x");
    const test::Ran other = run_command({"inspect", (dir / "a.fbx").string()}, circumstances);
    EXPECT_EQ(other.exit_code, 1);
    EXPECT_NE(other.err.find("(sought: /nowhere/meshprep-reader)"), std::string::npos) << other.err;
}

// A triangle with a material's ambient colour and a file's author, for neither of which there is a
// place.
TEST(ContainedCommand, WhatAssimpFilesLoseIsInJsonAndWords) {
    const TempDir dir;
    const std::string file = (dir / "a.dae").string();
    write_text(file, R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><contributor><author>somebody</author></contributor><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="common"><phong>
<ambient><color>0.5 0.25 0 1</color></ambient></phong></technique></profile_COMMON></effect>
</library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="pa" count="9">0 0 0 1 0 0 1 1 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node id="n"><instance_geometry url="#g">
<bind_material><technique_common><instance_material symbol="m" target="#m"/></technique_common>
</bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>
)");
    const std::string lost = "1 material property not kept: $clr.ambient";
    const std::string author = "1 property of the scene not kept: Author";
    for (const bool inspect : {false, true}) {
        std::vector<std::string> arguments = {"prepare", file, "-o", (dir / "a.glb").string()};
        if (inspect) arguments = {"inspect", file};
        const test::Ran words = run_command(arguments);
        for (const std::string& text : {lost, author})
            EXPECT_NE((words.out + words.err).find(text), std::string::npos) << words.out;
        arguments.push_back("--json");
        const nlohmann::json json = run_command(arguments).json();
        EXPECT_EQ(json["files"][0]["warnings"], nlohmann::json{lost});
        EXPECT_EQ(json["files"][0]["remarks"], nlohmann::json{author});
    }
}

// The stand-in for a reader crashes on pictures of this name.
TEST(ContainedCommand, APictureThatEndsItsDecoderEndsNoBatch) {
    const TempDir dir;
    for (const char* const name : {"a", "b"}) {
        const std::string picture = name == std::string("a") ? "segv.ico" : "good.ico";
        write_text(dir / picture, "x");
        write_text(dir / (std::string(name) + ".mtl"), "newmtl m\nmap_Kd " + picture + "\n");
        write_text(dir / (std::string(name) + ".obj"),
                   "mtllib " + std::string(name) +
                       ".mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
    }
    // No TGA files by their bytes: what else they may be is tried in the other process.
    write_text(dir / "segv.tga", "x");
    write_text(dir / "good.tga", "x");
    test::Circumstances circumstances;
    circumstances.environment = {{"MESHPREP_READER", MESHPREP_BAD_READER}};
    const test::Ran ran =
        run_command({"prepare", (dir / "a.obj").string(), (dir / "b.obj").string(), "-o",
                     (dir / "out").string() + "/", "--json"},
                    circumstances);
    const test::Ran diff = run_command(
        {"diff", (dir / "segv.tga").string(), (dir / "good.tga").string()}, circumstances);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const nlohmann::json files = ran.json()["files"];
    ASSERT_EQ(files.size(), 2u);
    const std::string crashed =
        "OpenImageIO, which reads this format, crashed on the file (SIGSEGV)";
    EXPECT_NE(files[0]["notes"].dump().find(crashed), std::string::npos) << files[0]["notes"];
    EXPECT_EQ(files[1]["notes"].dump().find(crashed), std::string::npos) << files[1]["notes"];
    EXPECT_TRUE(fs::exists(dir / "out/a.glb"));
    EXPECT_TRUE(fs::exists(dir / "out/b.glb"));
    EXPECT_EQ(diff.exit_code, 1);
    EXPECT_NE(diff.err.find((dir / "segv.tga").string() + ": " + crashed), std::string::npos)
        << diff.err;
}

TEST(ReaderProcess, LimitsAreOptions) {
    const TempDir dir;
    write_text(dir / "hangs.fbx", "x");
    const std::string file = (dir / "hangs.fbx").string();
    test::Circumstances circumstances;
    circumstances.environment = {{"MESHPREP_READER", MESHPREP_BAD_READER}};
    const test::Ran late = run_command({"inspect", file, "--reader-seconds", "0.1"}, circumstances);
    EXPECT_EQ(late.exit_code, 1);
    EXPECT_NE(late.err.find("0.1 s of processor time or 0.4 s by the clock"), std::string::npos)
        << late.err;
    for (const char* words : {"x", "-1", "nan", "0.01"})
        EXPECT_EQ(run_command({"inspect", file, "--reader-seconds", words}).exit_code, 2) << words;
    for (const char* words : {"x", "-1", "nan", "10"})
        EXPECT_EQ(run_command({"inspect", file, "--reader-memory", words}).exit_code, 2) << words;
}

TEST(ReaderProcess, WhatAReaderPrintsIsANoteThatIsAskedFor) {
    const TempDir dir;
    test::Circumstances circumstances;
    circumstances.environment = {{"MESHPREP_READER", MESHPREP_BAD_READER}};
    write_text(dir / "prints.fbx", "x");
    const std::string file = (dir / "prints.fbx").string();
    const test::Ran quiet = run_command({"inspect", file, "--json"}, circumstances);
    EXPECT_FALSE(quiet.json().is_null());
    EXPECT_EQ(quiet.err.find("to stdout"), std::string::npos) << quiet.err;
    const test::Ran told = run_command({"inspect", file, "--json", "--verbose"}, circumstances);
    EXPECT_FALSE(told.json().is_null());
    EXPECT_NE(told.err.find("meshprep: note: " + file + ": to stdout\n"), std::string::npos);
    EXPECT_NE(told.err.find("meshprep: note: " + file + ": to stderr\n"), std::string::npos);
}

}  // namespace
