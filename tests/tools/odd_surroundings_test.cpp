// Names and places as they come by accident: outputs that are pipes, names in brackets, a working
// directory that is gone.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <thread>

#include "command_runner.h"

namespace {

namespace fs = std::filesystem;
using test::file_text;
using test::run_command;
using test::run_here;
using test::TempDir;
using test::write_text;

// Of a pipe that `timeout` ends where the command waits for ever.
TEST(Surroundings, WhatIsWrittenIntoAPipeIsNotReadAgain) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const auto prepare = [&](const fs::path& to, const std::string& manifest) {
        return test::run_program(
            "/usr/bin/timeout",
            {"30", test::command_path().string(), "prepare", (dir / "cube.obj").string(), "-o",
             to.string(), "--manifest", (dir / manifest).string()});
    };
    ASSERT_EQ(prepare(dir / "file.glb", "file.json").exit_code, 0);
    const fs::path pipe = dir / "pipe.glb";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    // One opening is one writer's bytes: a second writer would find nobody.
    std::string got;
    std::thread reader([&] {
        const int fd = ::open(pipe.c_str(), O_RDONLY | O_CLOEXEC);
        std::array<char, 4096> buffer;
        for (ssize_t n = 0; (n = ::read(fd, buffer.data(), buffer.size())) > 0;)
            got.append(buffer.data(), std::size_t(n));
        ::close(fd);
    });
    const test::Ran ran = prepare(pipe, "pipe.json");
    // Where nothing was written into it the reader still waits.
    ::close(::open(pipe.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
    reader.join();
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(got, file_text(dir / "file.glb"));
}

// The command is started where a directory was; absolute paths need none.
TEST(Surroundings, AWorkingDirectoryThatIsGoneIsNoEnd) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const auto run = [&](const std::vector<std::string>& words) {
        fs::create_directory(dir / "gone");
        std::vector<std::string> all{"-c", "cd \"$0\" && rmdir \"$0\" && exec \"$@\"",
                                     (dir / "gone").string(), test::command_path().string()};
        all.insert(all.end(), words.begin(), words.end());
        return test::run_program("/bin/sh", all);
    };
    const std::string in = (dir / "cube.obj").string(), out = (dir / "cube.glb").string();
    test::Ran ran = run({"prepare", in, "-o", out});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(run({"inspect", out}).exit_code, 0);
    // Relative ones lead nowhere.
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"prepare", "cube.obj", "-o", "cube.glb"},
          {"prepare", in, "-o", "out/"},
          {"prepare", in, "-o", out, "--manifest", "made.json"},
          {"prepare", "-", "-o", "cube.glb"},
          {"render", in, "-o", "cube.png"},
          {"validate", in, "-o", "."}}) {
        ran = run(words);
        EXPECT_EQ(ran.exit_code, 1) << words.back();
        EXPECT_NE(ran.err.find("meshprep: error: "), std::string::npos) << words.back() << ran.err;
    }
}

// Names that a program of ours does not choose: they are no lists.
TEST(Surroundings, NamesInBracketsAreNames) {
    const TempDir dir;
    fs::create_directories(dir / "[assets]");
    write_text(dir / "[assets]/cube.obj", test::cube_obj());
    write_text(dir / "[a,b]", test::cube_obj());
    test::GltfText wheels;
    for (const char* const name : {"a", "[Wheel]", "Wheel"})
        wheels.add({name, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {}, {}, {0, 1, 2}, "", ""});
    write_text(dir / "wheels.gltf", wheels.text());
    const auto run = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"-c", "cd \"$0\" && exec \"$@\"", dir.path().string(),
                                     test::command_path().string()});
        return test::run_program("/bin/sh", words);
    };
    test::Ran ran = run({"prepare", "[assets]", "-o", "out"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(fs::exists(dir / "out/cube.glb"));
    ran = run({"inspect", "--json", "[a,b]", "--input-format", "obj"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.json()["files"].size(), 1u);
    ran = run({"inspect", "--json", "--input-format", "obj", "--", "[a,b]"});
    EXPECT_EQ(ran.json()["files"].size(), 1u) << ran.err;
    EXPECT_EQ(run({"inspect", "--texture-dir", "[assets]", "wheels.gltf"}).exit_code, 0);
    ran = run({"validate", "wheels.gltf", "-o", "sheets", "--panel", "64", "--mesh", "[Wheel]",
               "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    ASSERT_EQ(ran.json()["files"][0]["sheets"].size(), 1u) << ran.out;
    EXPECT_NE(ran.json()["files"][0]["numbers"][0]["sheet"].get<std::string>().find("'[Wheel]'"),
              std::string::npos)
        << ran.out;
    // As a value of its own it is an output's name.
    EXPECT_EQ(run({"prepare", "wheels.gltf", "-o", "[c]/"}).exit_code, 0);
    EXPECT_TRUE(fs::exists(dir / "[c]/wheels.glb"));
}

}  // namespace
