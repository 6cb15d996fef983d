// Pictures written row by row, several files together.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "image_folder.h"
#include "prep/files.h"
#include "prep/image.h"

namespace {

namespace fs = std::filesystem;

using ImageFiles = test::ImageFolder;

prep::ImageLayout layout(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                         prep::PixelType type = prep::PixelType::u8) {
    prep::ImageLayout out;
    out.width = width;
    out.height = height;
    const char* names[] = {"R", "G", "B", "A"};
    for (std::uint32_t c = 0; c < channels; ++c) out.channels.push_back(names[c]);
    out.type = type;
    out.srgb = type == prep::PixelType::u8;
    return out;
}

std::vector<float> values(std::size_t count) {
    std::vector<float> out;
    for (std::size_t i = 0; i < count; ++i) out.push_back(float(i * 37 % 256) / 255.0f);
    return out;
}

TEST_F(ImageFiles, RowsGiveTheBytesOfTheWholePicture) {
    for (const std::string ending : {"png", "jpg", "exr", "tif", "hdr", "tga", "bmp", "ppm"}) {
        SCOPED_TRACE(ending);
        const bool floats = ending == "exr" || ending == "hdr";
        const auto type = floats ? prep::PixelType::f32 : prep::PixelType::u8;
        const auto all = values(61 * 40 * 3);
        std::vector<std::vector<std::byte>> written;
        for (const std::size_t rows : {40u, 1u, 7u}) {
            prep::ImageFiles out;
            const auto file = out.open(dir_ / ("a." + ending), layout(61, 40, 3, type));
            ASSERT_TRUE(file) << to_string(file.error());
            for (std::size_t y = 0; y < 40; y += rows) {
                const std::size_t count = std::min<std::size_t>(rows, 40 - y) * 61 * 3;
                const auto part = std::span(all).subspan(y * 61 * 3, count);
                ASSERT_TRUE(out.write_rows(*file, part));
            }
            ASSERT_TRUE(out.commit());
            auto bytes = prep::read_file(dir_ / ("a." + ending));
            ASSERT_TRUE(bytes);
            written.push_back(*std::move(bytes));
        }
        EXPECT_EQ(written[1], written[0]);
        EXPECT_EQ(written[2], written[0]);
        prep::Image whole{61, 40, 3, all, !floats};
        ASSERT_TRUE(prep::save_image(dir_ / ("b." + ending), whole, type));
        const auto bytes = prep::read_file(dir_ / ("b." + ending));
        ASSERT_TRUE(bytes);
        EXPECT_EQ(*bytes, written[0]);
    }
}

// What a full disk does, by a limit on the size of files.
TEST_F(ImageFiles, AFileThatDoesNotFitIsAnErrorAndLeavesTheOldOne) {
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    std::mt19937 random(7);
    std::vector<float> noise(300 * 200 * 3);
    for (float& v : noise) v = float(random() % 256) / 255.0f;
    for (const std::string ending :
         {"png", "jpg", "bmp", "tga", "webp", "tif", "exr", "hdr", "ppm"}) {
        SCOPED_TRACE(ending);
        const bool floats = ending == "exr" || ending == "hdr";
        const auto path = dir_ / ("a." + ending);
        std::ofstream(path) << "old";
        const rlimit small{8192, before.rlim_max};
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
        bool good = true;
        {
            prep::ImageFiles out;
            const auto file = out.open(
                path, layout(300, 200, 3, floats ? prep::PixelType::f32 : prep::PixelType::u8));
            ASSERT_TRUE(file) << to_string(file.error());  // nothing is written yet
            good = out.write_rows(*file, noise).has_value();
            good = out.commit().has_value() && good;
        }
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
        EXPECT_FALSE(good);
        const auto bytes = prep::read_file(path);
        ASSERT_TRUE(bytes);
        EXPECT_EQ(bytes->size(), 3u);
        EXPECT_EQ(files(), 1u);
        fs::remove(path);
    }
    std::signal(SIGXFSZ, old_handler);
}

// A file so small that nothing of it is written before it is closed.
TEST_F(ImageFiles, ASmallFileThatDoesNotFitIsAnError) {
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    prep::ImageFiles out;
    const auto file = out.open(dir_ / "a.png", layout(4, 2, 3, prep::PixelType::u8));
    ASSERT_TRUE(file) << to_string(file.error());
    const rlimit small{100, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const auto written = out.write_rows(*file, std::vector<float>(4 * 2 * 3));
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, old_handler);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, prep::ErrorCode::io);
    EXPECT_NE(written.error().text.find("too large"), std::string::npos) << written.error().text;
    EXPECT_FALSE(out.commit());
}

TEST_F(ImageFiles, FormatsWhoseWritersMissAFullDiskAreNotWritten) {
    prep::ImageFiles out;
    const auto file = out.open(dir_ / "a.sgi", layout(3, 1, 3));
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, prep::ErrorCode::unsupported);
    EXPECT_EQ(files(), 0u);
}

TEST_F(ImageFiles, FloatsKeepEveryBitInExr) {
    const float inf = std::numeric_limits<float>::infinity();
    std::vector<float> all = {0.1f, -3e-30f, inf, 3e38f, 16777217.0f, 1e-45f};
    auto what = layout(3, 1, 2, prep::PixelType::f32);
    what.channels = {"Z", "depth"};
    prep::ImageFiles out;
    const auto file = out.open(dir_ / "a.exr", what);
    ASSERT_TRUE(file);
    ASSERT_TRUE(out.write_rows(*file, all));
    ASSERT_TRUE(out.commit());
    const auto back = prep::load_image(dir_ / "a.exr");
    ASSERT_TRUE(back);
    EXPECT_EQ(back->pixels, all);
}

TEST_F(ImageFiles, IntegerChannelsStandBesideFloats) {
    auto what = layout(4, 1, 2, prep::PixelType::f32);
    what.channels = {"a", "id"};
    what.integer = {false, true};
    const std::vector<std::uint32_t> words = {std::bit_cast<std::uint32_t>(0.25f), 0,
                                              std::bit_cast<std::uint32_t>(0.5f),  1u << 31,
                                              std::bit_cast<std::uint32_t>(-1.0f), 0xffffffffu,
                                              std::bit_cast<std::uint32_t>(2.0f),  1u << 30};
    prep::ImageFiles out;
    const auto file = out.open(dir_ / "a.exr", what);
    ASSERT_TRUE(file) << to_string(file.error());
    EXPECT_FALSE(out.write_rows(*file, values(8)));  // floats are not what it holds
    ASSERT_TRUE(out.write_rows(*file, words));
    ASSERT_TRUE(out.commit());
    const auto back = prep::load_image(dir_ / "a.exr");
    ASSERT_TRUE(back);
    // Integers are read as parts of their range.
    const std::vector<float> expected = {0.25f, 0, 0.5f, 0.5f, -1.0f, 1, 2.0f, 0.25f};
    ASSERT_EQ(back->pixels.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(back->pixels[i], expected[i], 1e-7) << i;
    const auto png = out.open(dir_ / "a.png", what);
    ASSERT_FALSE(png);
    EXPECT_EQ(png.error().code, prep::ErrorCode::unsupported);
}

TEST_F(ImageFiles, AllOfThemAppearOrNone) {
    ASSERT_TRUE(prep::save_image(dir_ / "a.png", {1, 1, 1, {0.5f}, true}));
    const auto before = prep::read_file(dir_ / "a.png");
    {
        prep::ImageFiles out;
        const auto a = out.open(dir_ / "a.png", layout(4, 4, 1));
        const auto b = out.open(dir_ / "b.exr", layout(4, 4, 1, prep::PixelType::f32));
        ASSERT_TRUE(a && b);
        ASSERT_TRUE(out.write_rows(*a, values(16)));
        ASSERT_TRUE(out.write_rows(*b, values(12)));
        EXPECT_FALSE(out.write_rows(*b, values(8)));  // more rows than there are
        EXPECT_FALSE(out.write_rows(*b, values(3)));  // no whole row
        const auto early = out.commit();
        ASSERT_FALSE(early);  // a row of b is missing
        EXPECT_EQ(early.error().code, prep::ErrorCode::invalid);
    }
    EXPECT_EQ(files(), 1u);
    EXPECT_EQ(*prep::read_file(dir_ / "a.png"), *before);
}

TEST_F(ImageFiles, KeepToTheirRulesAndTheRightsOfOldFiles) {
    ASSERT_TRUE(prep::save_image(dir_ / "a.png", {1, 1, 1, {0.5f}, true}));
    ::chmod((dir_ / "a.png").c_str(), 0440);
    {
        prep::ImageFiles out({false, {}});
        EXPECT_FALSE(out.open(dir_ / "a.png", layout(1, 1, 1)));
    }
    {
        prep::ImageFiles out({true, {dir_ / "a.png"}});
        EXPECT_FALSE(out.open(dir_ / "a.png", layout(1, 1, 1)));
    }
    prep::ImageFiles out;
    const auto a = out.open(dir_ / "a.png", layout(1, 1, 1));
    ASSERT_TRUE(a);
    ASSERT_TRUE(out.write_rows(*a, values(1)));
    ASSERT_TRUE(out.commit());
    struct stat now {};
    ASSERT_EQ(::stat((dir_ / "a.png").c_str(), &now), 0);
    EXPECT_EQ(now.st_mode & 0777, 0440u);
    EXPECT_EQ(files(), 1u);
}

// Whole pictures and rows alike; nothing is left where the file would have been.
TEST_F(ImageFiles, ShapesThatAFormatDoesNotHoldAreErrors) {
    struct Case {
        const char* name;
        std::uint32_t width, channels;
        prep::ErrorCode code;
    };
    using enum prep::ErrorCode;
    for (const Case& c : std::initializer_list<Case>{{"a.webp", 4, 1, unsupported},
                                                     {"a.webp", 4, 2, unsupported},
                                                     {"a.webp", 16384, 3, limit},
                                                     {"a.bmp", 4, 2, unsupported},
                                                     {"a.ppm", 4, 2, unsupported},
                                                     {"a.ppm", 4, 4, unsupported}}) {
        SCOPED_TRACE(std::string(c.name) + " of " + std::to_string(c.channels));
        prep::Image image;
        image.width = c.width;
        image.height = 1;
        image.channels = c.channels;
        image.pixels = values(std::size_t(c.width) * c.channels);
        const auto saved = prep::save_image(dir_ / c.name, image);
        ASSERT_FALSE(saved);
        EXPECT_EQ(saved.error().code, c.code) << saved.error().text;
        prep::ImageFiles out;
        const auto opened = out.open(dir_ / c.name, layout(c.width, 1, c.channels));
        ASSERT_FALSE(opened);
        EXPECT_EQ(opened.error().code, c.code) << opened.error().text;
    }
    EXPECT_EQ(files(), 0u);
}

TEST_F(ImageFiles, BadPlacesAndLayoutsAreErrors) {
    prep::ImageFiles out;
    EXPECT_FALSE(out.open(dir_ / "none" / "a.png", layout(1, 1, 1)));
    EXPECT_FALSE(out.open(dir_ / "a", layout(1, 1, 1)));
    EXPECT_FALSE(out.open(dir_ / "a.unknown", layout(1, 1, 1)));
    EXPECT_FALSE(out.open(dir_ / "a.png", layout(0, 1, 1)));
    EXPECT_FALSE(out.open(dir_ / "a.png", layout(1, 1, 0)));
    EXPECT_FALSE(out.open(dir_ / "a.png", layout(1, prep::max_image_extent + 1, 1)));
    EXPECT_FALSE(out.open(dir_, layout(1, 1, 1)));
    ASSERT_TRUE(out.commit());  // what could not be opened leaves nothing
    EXPECT_EQ(files(), 0u);
}

}  // namespace
