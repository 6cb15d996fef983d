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
        std::vector<std::string> all{
            "-c", "cd \"$0\" && rmdir \"$0\" && exec \"$@\"", (dir / "gone").string(),
            test::command_path().string()};
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

}  // namespace
