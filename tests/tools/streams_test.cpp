// The command with streams, rights and limits that others set: standard output that is full or
// closed, directories that are locked, a limit on the size of files or on memory.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "command_runner.h"
#include "sanitized.h"

namespace {

namespace fs = std::filesystem;
using test::file_text;
using test::run_command;
using test::sanitized;
using test::TempDir;
using test::write_text;

TEST(Streams, StandardOutputThatCannotBeWrittenIsAFailure) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const std::string cube = (dir / "cube.obj").string(), ply = (dir / "cube.ply").string();
    const std::vector<std::vector<std::string>> all{{"--help"},
                                                    {"--version"},
                                                    {"inspect", "--help"},
                                                    {"inspect", cube},
                                                    {"inspect", cube, "--json"},
                                                    {"prepare", cube, "-o", ply},
                                                    {"prepare", cube, "-o", ply, "--json"}};
    for (const auto& arguments : all)
        for (const char* out : {"/dev/full", ""}) {
            SCOPED_TRACE(arguments.back() + (*out ? " to /dev/full" : " closed"));
            fs::remove(ply);
            test::Circumstances circumstances;
            circumstances.out = out;
            const test::Ran ran = run_command(arguments, circumstances);
            EXPECT_EQ(ran.exit_code, 1);
            EXPECT_NE(ran.err.find("meshprep: error: standard output cannot be written"),
                      std::string::npos)
                << ran.err;
            // The mesh is no less complete for it.
            if (arguments[0] == "prepare") {
                EXPECT_EQ(file_text(ply).rfind("ply\n", 0), 0u);
            }
        }
}

// `meshprep … | head -1`: the end of the pipe that is read is closed already.
TEST(Streams, AReaderThatHasGoneIsAFailure) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    std::string command = test::command_path().string(), verb = "inspect";
    std::string cube = (dir / "cube.obj").string();
    const std::string said = (dir / "said").string();
    char* const argv[] = {command.data(), verb.data(), cube.data(), nullptr};
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    ::close(ends[0]);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_addopen(&actions, 2, said.c_str(), O_WRONLY | O_CREAT, 0600);
    pid_t process = 0;
    ASSERT_EQ(::posix_spawn(&process, command.c_str(), &actions, nullptr, argv, environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    int status = 0;
    ASSERT_EQ(::waitpid(process, &status, 0), process);
    ASSERT_TRUE(WIFEXITED(status)) << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 1);
    EXPECT_NE(file_text(said).find("standard output cannot be written"), std::string::npos);
}

// What says nothing on standard output does not miss it.
TEST(Streams, QuietRunsNeedNoStandardOutput) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    for (const char* out : {"/dev/full", ""}) {
        test::Circumstances circumstances;
        circumstances.out = out;
        const test::Ran ran = run_command(
            {"prepare", (dir / "cube.obj").string(), "-o", (dir / "cube.ply").string(), "--quiet"},
            circumstances);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
    }
}

TEST(Rights, AnUnwritableDirectoryIsAnErrorAndLeavesNothing) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    fs::create_directory(dir / "locked");
    for (const auto& user : test::users()) {
        if (!user && ::geteuid() == 0) continue;  // the superuser may write anywhere
        ::chmod((dir / "locked").c_str(), 0555);
        ::chmod(dir.path().c_str(), 0755);
        test::Circumstances circumstances;
        circumstances.user = user;
        const test::Ran ran = run_command(
            {"prepare", (dir / "cube.obj").string(), "-o", (dir / "locked/cube.glb").string()},
            circumstances);
        ::chmod((dir / "locked").c_str(), 0755);
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_NE(ran.err.find("cannot create a file here: Permission denied"), std::string::npos)
            << ran.err;
        EXPECT_TRUE(fs::is_empty(dir / "locked"));
    }
}

TEST(Rights, AnUnreadableInputIsAnErrorThatNamesIt) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    for (const auto& user : test::users()) {
        if (!user && ::geteuid() == 0) continue;  // the superuser may read anything
        ::chmod((dir / "cube.obj").c_str(), 0000);
        ::chmod(dir.path().c_str(), 0777);
        test::Circumstances circumstances;
        circumstances.user = user;
        const std::string cube = (dir / "cube.obj").string();
        const test::Ran prepare =
            run_command({"prepare", cube, "-o", (dir / "x.glb").string()}, circumstances);
        EXPECT_EQ(prepare.exit_code, 1);
        EXPECT_NE(prepare.err.find(cube + ": no permission to read this file"), std::string::npos)
            << prepare.err;
        const test::Ran inspect = run_command({"inspect", cube}, circumstances);
        EXPECT_EQ(inspect.exit_code, 1);
        EXPECT_NE(inspect.err.find(cube + ": no permission to read this file"), std::string::npos)
            << inspect.err;
        EXPECT_EQ(dir.names(), std::vector<std::string>{"cube.obj"});
    }
}

TEST(Limits, AFileOverTheUsersLimitIsAnErrorAndLeavesTheOldOne) {
    for (const auto& user : test::users()) {
        const TempDir dir;
        ::chmod(dir.path().c_str(), 0777);
        write_text(dir / "ball.obj", test::sphere_obj(32, 16));
        write_text(dir / "old.glb", "the old file");
        test::Circumstances circumstances;
        circumstances.user = user;
        circumstances.largest_file = 4096;
        const test::Ran ran =
            run_command({"prepare", (dir / "ball.obj").string(), "-o", (dir / "old.glb").string()},
                        circumstances);
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_NE(ran.err.find("cannot write the file: File too large"), std::string::npos)
            << ran.err;
        EXPECT_EQ(file_text(dir / "old.glb"), "the old file");
        EXPECT_EQ(dir.names(), (std::vector<std::string>{"ball.obj", "old.glb"}));
    }
}

// A sparse file larger than the memory that the process may have.
TEST(Limits, OutOfMemoryIsToldAndLeavesTheOldFile) {
    if (sanitized) GTEST_SKIP() << "a sanitizer needs all the addresses there are";
    const TempDir dir;
    write_text(dir / "large.ply", "ply\n");
    fs::resize_file(dir / "large.ply", std::uintmax_t(1) << 33);
    write_text(dir / "old.glb", "the old file");
    test::Circumstances circumstances;
    circumstances.memory = std::uint64_t(1) << 32;
    const test::Ran ran = run_command(
        {"prepare", (dir / "large.ply").string(), "-o", (dir / "old.glb").string()}, circumstances);
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("out of memory"), std::string::npos) << ran.err;
    EXPECT_EQ(file_text(dir / "old.glb"), "the old file");
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"large.ply", "old.glb"}));
}

}  // namespace
