// Bytes of files, read by several threads, and shared by what refers to parts of them.
#include "base/file_bytes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "base/atomic_files.h"
#include "base/shared_bytes.h"
#include "mesh_files.h"

namespace {

namespace fs = std::filesystem;
using prep::detail::FileBytes;
using prep::detail::read_file_bytes;
using prep::detail::SharedBytes;

// No two places of it look alike for long.
std::string text_of(std::size_t size) {
    std::string text(size, ' ');
    for (std::size_t i = 0; i < size; ++i)
        text[i] = char(std::uint64_t(i + 1) * 0x9e3779b97f4a7c15U >> 56);
    return text;
}

std::string text_of(const FileBytes& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(FileBytes, AreTheFilesOnAnyThreads) {
    const test::TempDir dir;
    constexpr std::size_t block = std::size_t(4) << 20;
    for (const std::size_t size :
         {std::size_t(0), std::size_t(1), block - 1, block, block + 1, 3 * block + 12345}) {
        const std::string text = text_of(size);
        test::write_text(dir / "file", text);
        for (const int threads : {0, 1, 2, 7}) {
            const auto bytes = read_file_bytes(dir / "file", threads);
            ASSERT_TRUE(bytes.has_value());
            EXPECT_TRUE(text_of(*bytes) == text) << size << " bytes on " << threads << " threads";
        }
    }
}

TEST(FileBytes, OfPipesAndSystemFilesAreAllThatComes) {
    const test::TempDir dir;
    const fs::path pipe = dir / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const std::string text = text_of(300'000);
    std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << text; });
    const auto piped = read_file_bytes(pipe, 0);
    writer.join();
    ASSERT_TRUE(piped.has_value());
    EXPECT_TRUE(text_of(*piped) == text);
    // A regular file whose size is told as 0.
    if (!fs::exists("/proc/self/status")) GTEST_SKIP() << "there is no /proc";
    const auto told = read_file_bytes("/proc/self/status", 0);
    ASSERT_TRUE(told.has_value());
    EXPECT_TRUE(text_of(*told).starts_with("Name:"));
    EXPECT_NE(text_of(*told).find("VmRSS"), std::string::npos);
}

TEST(FileBytes, ErrorsNameTheFile) {
    const test::TempDir dir;
    const auto missing = read_file_bytes(dir / "missing", 0);
    ASSERT_FALSE(missing.has_value());
    EXPECT_EQ(prep::to_string(missing.error()),
              (dir / "missing").string() + ": cannot open the file: No such file or directory");
    const auto folder = read_file_bytes(dir / "", 0);
    ASSERT_FALSE(folder.has_value());
    EXPECT_EQ(folder.error().text, "this is a directory; name a file");
}

// Under the address sanitizer a part that outlived its bytes would be told.
TEST(SharedBytes, PartsKeepTheirBytes) {
    SharedBytes part;
    const std::byte* at = nullptr;
    {
        std::vector<std::uint32_t> numbers{1, 2, 3, 0xdeadbeef};
        const SharedBytes whole = SharedBytes::of(std::move(numbers));
        ASSERT_EQ(whole.size(), 16U);
        at = whole.data();
        part = whole.part(4, 12).part(4, 8);
    }
    EXPECT_EQ(part.data(), at + 8) << "no copy";
    ASSERT_EQ(part.size(), 8U);
    EXPECT_EQ(part[0], std::byte(3));
    EXPECT_EQ(part[7], std::byte(0xde));
    const SharedBytes again = part;
    part = {};
    EXPECT_TRUE(part.empty());
    EXPECT_EQ(again[4], std::byte(0xef));
}

TEST(SharedBytes, LentOnesAreTheOwners) {
    std::vector<std::byte> own(5, std::byte(7));
    const SharedBytes lent = SharedBytes::lent(own);
    EXPECT_EQ(lent.data(), own.data());
    EXPECT_EQ(lent.part(5, 0).size(), 0U);
    const SharedBytes kept = std::move(own);
    EXPECT_EQ(kept.size(), 5U);
}

// Also of a file that is not there: what is compared is where outputs will be.
TEST(FileIdentity, IsOneForAllNamesOfAFile) {
    const fs::path here = fs::canonical(fs::current_path());
    const fs::path file = here / "no such file.exr";
    for (const fs::path name : {"no such file.exr", "./no such file.exr", "sub/../no such file.exr",
                                ".//no such file.exr"})
        EXPECT_EQ(prep::detail::identity_of(name), file) << name;
    EXPECT_EQ(prep::detail::identity_of(file), file);
    const test::TempDir dir;
    fs::create_directory(dir / "at");
    fs::create_directory_symlink("at", dir / "by");
    EXPECT_EQ(prep::detail::identity_of(dir / "by" / "x.glb"), fs::canonical(dir / "at") / "x.glb");
    fs::create_symlink("nowhere.glb", dir / "link.glb");
    EXPECT_EQ(prep::detail::identity_of(dir / "link.glb"),
              fs::canonical(dir.path()) / "nowhere.glb");
    EXPECT_NE(prep::detail::identity_of("a.glb"), prep::detail::identity_of("b.glb"));
}

}  // namespace
