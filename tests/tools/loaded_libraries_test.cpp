// Libraries that are loaded when they are first needed: which processes have them, and what is said
// where one is not there or of another build.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "command_runner.h"
#include "rig_files.h"

namespace {

using test::file_text;
using test::run_command;
using test::TempDir;
using test::write_text;

// The command and its reader in a directory of their own, with one library of this build.
class CopiedCommand {
  public:
    CopiedCommand(const std::string& library, std::string symbol)
        : library_(dir / library), symbol_(std::move(symbol)) {
        const std::filesystem::path built = test::command_path().parent_path();
        for (const char* program : {"meshprep", "meshprep-reader"})
            std::filesystem::copy_file(built / program, dir / program);
        bytes_ = file_text(built / library);
        write_text(library_, bytes_);
        write_text(dir / "cube.obj", test::cube_obj());
    }

    test::Ran run(std::vector<std::string> words) const {
        for (std::string& word : words)
            if (word.find('.') != std::string::npos) word = (dir / word).string();
        return test::run_program(dir / "meshprep", words);
    }
    // Half an update leaves a command with another build's library.
    void change_build() {
        std::string other = bytes_;
        for (std::size_t at = other.find(symbol_); at != std::string::npos;
             at = other.find(symbol_, at))
            other[at] = 'M';
        std::filesystem::remove(library_);
        write_text(library_, other);
    }
    void remove() { std::filesystem::remove(library_); }

    void expect_refused(const test::Ran& ran) const {
        EXPECT_EQ(ran.exit_code, 1) << ran.err;
        const std::string file = library_.filename().string();
        // A sanitized library refers to that name itself: the loader is the first to miss it.
        EXPECT_TRUE(ran.err.find(file + " is of another build") != std::string::npos ||
                    ran.err.find("undefined symbol: M" + symbol_.substr(1)) != std::string::npos)
            << ran.err;
        EXPECT_NE(ran.err.find("install meshprep anew"), std::string::npos) << ran.err;
    }
    void expect_missed(const test::Ran& ran) const {
        EXPECT_EQ(ran.exit_code, 1) << ran.err;
        EXPECT_NE(ran.err.find(library_.filename().string() + ": cannot open"), std::string::npos)
            << ran.err;
        EXPECT_NE(ran.err.find("install meshprep anew"), std::string::npos) << ran.err;
    }

    TempDir dir;

  private:
    std::filesystem::path library_;
    std::string symbol_, bytes_;
};

constexpr const char* installed =
    "this build's library is installed where the system looks for libraries";

// Whether the command finds it without the one beside it.
bool is_installed(const std::string& library, const std::vector<std::string>& words) {
    CopiedCommand command(library, "");
    write_text(command.dir / "rig.dae", test::collada_rig({}));
    command.remove();
    return command.run(words).exit_code == 0;
}

TEST(LoadedLibraries, PicturesAreReadWithThatOfTheSameBuildAlone) {
    const std::vector<std::string> words{"render", "cube.obj", "-o", "a.exr", "--size", "16x16"};
    if (is_installed("libprep_images.so", words)) GTEST_SKIP() << installed;
    CopiedCommand command("libprep_images.so", "meshprep_images_");
    const test::Ran own = command.run(words);
    EXPECT_EQ(own.exit_code, 0) << own.err;
    command.change_build();
    const test::Ran other = command.run(words);
    command.expect_refused(other);
    command.remove();
    command.expect_missed(command.run(words));
    // PNG needs none of it.
    const test::Ran png = command.run({"render", "cube.obj", "-o", "a.png", "--size", "16x16"});
    EXPECT_EQ(png.exit_code, 0) << png.err;
    EXPECT_EQ(command.run({"diff", "a.png", "a.png"}).exit_code, 0);
}

TEST(LoadedLibraries, ModelsAreReadWithThatOfTheSameBuildAlone) {
    const std::vector<std::string> words{"prepare", "rig.dae", "-o", "a.glb"};
    if (is_installed("libprep_readers.so", words)) GTEST_SKIP() << installed;
    CopiedCommand command("libprep_readers.so", "meshprep_readers_");
    write_text(command.dir / "rig.dae", test::collada_rig({}));
    const test::Ran own = command.run(words);
    EXPECT_EQ(own.exit_code, 0) << own.err;
    command.change_build();
    const test::Ran other = command.run(words);
    command.expect_refused(other);
    command.remove();
    command.expect_missed(command.run(words));
}

// Whether Assimp claims such an ending is not known without it; what else the file is, is.
TEST(LoadedLibraries, WithoutThatOfReadersUnknownEndingsGoByTheirFirstBytes) {
    if (is_installed("libprep_readers.so", {"prepare", "rig.dae", "-o", "a.glb"}))
        GTEST_SKIP() << installed;
    CopiedCommand command("libprep_readers.so", "meshprep_readers_");
    write_text(command.dir / "text.zzz", "neither\n");
    write_text(command.dir / "cube.zzz", test::cube_obj());
    const std::vector<std::string> text{"inspect", "text.zzz"};
    const test::Ran known = command.run(text);
    EXPECT_EQ(known.exit_code, 1);
    EXPECT_NE(known.err.find("unknown file type '.zzz'"), std::string::npos) << known.err;
    command.remove();
    const test::Ran unknown = command.run(text);
    command.expect_missed(unknown);
    EXPECT_EQ(command.run({"inspect", "cube.zzz"}).exit_code, 0);
    EXPECT_EQ(command.run({"inspect", "cube.obj"}).exit_code, 0);
}

// What the loader tells of each process that a run consists of.
std::vector<std::string> told_by_loader(const TempDir& dir, const char* what,
                                        const std::vector<std::string>& arguments) {
    test::Circumstances loader;
    loader.environment = {{"LD_DEBUG", what}, {"LD_DEBUG_OUTPUT", (dir / "loader").string()}};
    const test::Ran ran = run_command(arguments, loader);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    std::vector<std::string> told;
    for (const std::string& name : dir.names())
        if (name.starts_with("loader")) {
            told.push_back(file_text(dir / name));
            std::filesystem::remove(dir / name);
        }
    return told;
}

std::ptrdiff_t processes_with(const std::vector<std::string>& told, const char* library) {
    return std::count_if(told.begin(), told.end(), [&](const std::string& text) {
        return text.find(library) != std::string::npos;
    });
}

// It takes ten times as long to load as all else that drawing a small picture is.
TEST(LoadedLibraries, OpenImageIOIsNotLoadedForPng) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    const auto drawn = [&](const char* picture, const std::vector<std::string>& more = {}) {
        std::vector<std::string> words{"render", (dir / "cube.obj").string(),
                                       "-o",     (dir / picture).string(),
                                       "--size", "16x16"};
        words.insert(words.end(), more.begin(), more.end());
        return told_by_loader(dir, "files", words);
    };
    const auto png = drawn("a.png"), exr = drawn("a.exr");
    if (processes_with(png, "libc.so") == 0)
        GTEST_SKIP() << "the loader of this system does not tell what it loads (LD_DEBUG)";
    EXPECT_EQ(processes_with(png, "libOpenImageIO"), 0);
    EXPECT_EQ(processes_with(exr, "libOpenImageIO"), 1);
    const auto in_time = drawn("b.png", {"--budget-ms", "1000"});
    EXPECT_EQ(processes_with(in_time, "libOpenImageIO"), 0);
    const std::string picture = (dir / "a.png").string();
    const auto read = told_by_loader(dir, "files", {"diff", picture, picture});
    EXPECT_EQ(processes_with(read, "libOpenImageIO"), 0);
}

// Loading it takes a quarter of the start of the command.
TEST(LoadedLibraries, AssimpAndOpenMeshAreInTheReadersProcessAlone) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    write_text(dir / "rig.dae", test::collada_rig({}));
    const std::string out = (dir / "a.glb").string();
    const auto own =
        told_by_loader(dir, "files", {"prepare", (dir / "cube.obj").string(), "-o", out});
    if (processes_with(own, "libc.so") == 0)
        GTEST_SKIP() << "the loader of this system does not tell what it loads (LD_DEBUG)";
    EXPECT_EQ(own.size(), 1U);
    const auto foreign =
        told_by_loader(dir, "files", {"prepare", (dir / "rig.dae").string(), "-o", out});
    EXPECT_EQ(foreign.size(), 2U);
    for (const char* library : {"libprep_readers.so", "libassimp.so", "libOpenMeshCore.so"}) {
        EXPECT_EQ(processes_with(own, library), 0) << library;
        EXPECT_EQ(processes_with(foreign, library), 1) << library;
    }
}

// Opened with OpenImageIO alone, each of its libraries looks for symbols in all of them.
TEST(LoadedLibraries, WhatOpenImageIONeedsIsOpenedBeforeIt) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    std::string text;
    for (const std::string& told : told_by_loader(dir, "scopes",
                                                  {"render", (dir / "cube.obj").string(), "-o",
                                                   (dir / "cube.exr").string(), "--size", "16x16"}))
        text += told;
    if (text.find(" scope 1: ") == std::string::npos)
        GTEST_SKIP() << "the loader of this system does not tell its scopes (LD_DEBUG)";
    // The scope that a library came with stands under its first mention.
    std::istringstream lines(text);
    std::set<std::string> known;
    std::string line, object;
    std::size_t all = 0, with_the_rest = 0;
    while (std::getline(lines, line)) {
        if (const auto at = line.find("object="); at != std::string::npos) {
            object = line.substr(at + 7, line.find(' ', at) - at - 7);
            if (!known.insert(object).second) object.clear();
        } else if (const auto first = line.find(" scope 1: ");
                   first != std::string::npos && !object.empty()) {
            ++all;
            with_the_rest += line.find("libprep_images.so", first) != std::string::npos;
        }
    }
    EXPECT_GT(all, 50U);
    // The library of our own, OpenImageIO, and what cannot be opened by itself.
    EXPECT_LT(with_the_rest, all / 10);
}

}  // namespace
