#include "prep/image.h"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <ctime>
#include <fstream>
#include <limits>

#include "image_folder.h"
#include "prep/files.h"
#include "prep/scene.h"
#include "shared_data.h"
#include "temporary_files.h"

namespace {
std::atomic<std::time_t> later{0};
}

// In place of the C library's: the writers of pictures ask here what time it is.
extern "C" std::time_t time(std::time_t* to) noexcept {
    timespec now{};
    ::syscall(SYS_clock_gettime, CLOCK_REALTIME, &now);
    now.tv_sec += later;
    if (to) *to = now.tv_sec;
    return now.tv_sec;
}

namespace {

namespace fs = std::filesystem;

constexpr std::time_t a_day = 86400;

using ImageFiles = test::ImageFolder;

prep::Image gradient(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
    prep::Image image{width, height, channels, {}, true};
    for (std::uint32_t i = 0; i < width * height * channels; ++i)
        image.pixels.push_back(float(i * 37 % 256) / 255.0f);
    return image;
}

using PngRoundTrip = ImageFiles;

TEST_F(PngRoundTrip, KeepsEveryByteForEveryChannelCount) {
    for (std::uint32_t channels = 1; channels <= 4; ++channels) {
        const auto image = gradient(17, 5, channels);
        const auto path = dir_ / "a.png";
        ASSERT_TRUE(prep::save_image(path, image));
        const auto back = prep::load_image(path);
        ASSERT_TRUE(back) << to_string(back.error());
        EXPECT_EQ(back->width, 17u);
        EXPECT_EQ(back->height, 5u);
        ASSERT_EQ(back->channels, channels);
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            ASSERT_EQ(std::lround(back->pixels[i] * 255), std::lround(image.pixels[i] * 255))
                << "value " << i << ", channels " << channels;
    }
    EXPECT_EQ(files(), 1u);
}

TEST_F(PngRoundTrip, SixteenBitsSurvive) {
    prep::Image image{2, 1, 1, {1.0f / 65535.0f, 40000.0f / 65535.0f}, false};
    ASSERT_TRUE(prep::save_image(dir_ / "a.png", image, prep::PixelType::u16));
    const auto back = prep::load_image(dir_ / "a.png");
    ASSERT_TRUE(back);
    EXPECT_EQ(std::lround(back->pixels[0] * 65535), 1);
    EXPECT_EQ(std::lround(back->pixels[1] * 65535), 40000);
}

TEST_F(PngRoundTrip, OutOfRangeAndNaNAreClamped) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    prep::Image image{4, 1, 1, {nan, -1.0f, inf, 0.5f}, false};
    ASSERT_TRUE(prep::save_image(dir_ / "a.png", image));
    const auto back = prep::load_image(dir_ / "a.png");
    ASSERT_TRUE(back);
    EXPECT_EQ(back->pixels[0], 0.0f);
    EXPECT_EQ(back->pixels[1], 0.0f);
    EXPECT_EQ(back->pixels[2], 1.0f);
    EXPECT_EQ(std::lround(back->pixels[3] * 255), 128);
}

TEST_F(PngRoundTrip, TransparentPixelsKeepTheirColour) {
    prep::Image image{1, 1, 4, {1.0f, 0.5f, 0.25f, 0.0f}, true};
    ASSERT_TRUE(prep::save_image(dir_ / "a.png", image));
    const auto back = prep::load_image(dir_ / "a.png");
    ASSERT_TRUE(back);
    EXPECT_EQ(back->pixels[0], 1.0f);
    EXPECT_EQ(std::lround(back->pixels[1] * 255), 128);
}

using ExrRoundTrip = ImageFiles;

TEST_F(ExrRoundTrip, FloatsKeepEveryBit) {
    prep::Image image{3, 2, 3, {}, false};
    for (int i = 0; i < 18; ++i) image.pixels.push_back(std::ldexp(1.0f / float(i + 3), i - 9));
    ASSERT_TRUE(prep::save_image(dir_ / "a.exr", image, prep::PixelType::f32));
    const auto back = prep::load_image(dir_ / "a.exr");
    ASSERT_TRUE(back) << to_string(back.error());
    EXPECT_EQ(back->pixels, image.pixels);
    EXPECT_FALSE(back->srgb);
}

TEST_F(ExrRoundTrip, FilesOfEveryFormatAreTheSameADayLater) {
    const auto image = gradient(8, 8, 3);
    const char* const endings[] = {"exr", "tif", "png", "jpg", "bmp", "tga", "webp", "ppm"};
    const auto write = [&](const std::string& stem) {
        for (const std::string ending : endings)
            ASSERT_TRUE(
                prep::save_image(dir_ / (stem + "." + ending), image,
                                 ending == "exr" ? prep::PixelType::f16 : prep::PixelType::u8))
                << ending;
    };
    write("a");
    later = a_day;
    write("b");
    later = 0;
    for (const std::string ending : endings)
        EXPECT_TRUE(*prep::read_file(dir_ / ("a." + ending)) ==
                    *prep::read_file(dir_ / ("b." + ending)))
            << ending;
}

TEST(EncodePng, IsTheSameADayLaterAndNamesNoTimeOrHost) {
    const auto image = gradient(16, 16, 3);
    const auto a = prep::encode_png(image);
    later = a_day;
    const auto b = prep::encode_png(image);
    later = 0;
    ASSERT_TRUE(a);
    EXPECT_EQ(*a, *b);
    const std::string text(reinterpret_cast<const char*>(a->data()), a->size());
    EXPECT_EQ(text.find("tIME"), std::string::npos);
    EXPECT_EQ(text.find("Host"), std::string::npos);
}

TEST(EncodePng, RefusesFloatsAndSizesThatDoNotMatch) {
    auto image = gradient(4, 4, 3);
    EXPECT_EQ(prep::encode_png(image, prep::PixelType::f32).error().code,
              prep::ErrorCode::unsupported);
    image.pixels.pop_back();
    EXPECT_EQ(prep::encode_png(image).error().code, prep::ErrorCode::invalid);
    EXPECT_EQ(prep::encode_png({}).error().code, prep::ErrorCode::invalid);
}

TEST(DecodeImage, RecognisesTheFormatByItsBytesNotItsName) {
    const auto bytes = prep::encode_png(gradient(5, 4, 3));
    ASSERT_TRUE(bytes);
    for (const char* name : {"texture", "texture.jpg", "texture.png", "images/0"}) {
        const auto image = prep::decode_image(*bytes, name);
        ASSERT_TRUE(image) << name << ": " << to_string(image.error());
        EXPECT_EQ(image->width, 5u);
        EXPECT_TRUE(image->srgb);
    }
}

TEST(DecodeImage, EveryTruncationOfAPngIsAnErrorOrAnImageNeverACrash) {
    const auto bytes = prep::encode_png(gradient(40, 40, 3));
    ASSERT_TRUE(bytes);
    std::size_t errors = 0;
    for (std::size_t n = 0; n < bytes->size(); n += 7) {
        const auto image = prep::decode_image(std::span(*bytes).first(n), "cut.png");
        if (!image) {
            ++errors;
            EXPECT_FALSE(image.error().text.empty());
            EXPECT_EQ(image.error().place, "cut.png");
        }
    }
    // Only the last few bytes (checksum and end mark) can be missing unnoticed.
    EXPECT_GE(errors, bytes->size() / 7 * 9 / 10);
}

TEST(DecodeImage, AHeaderThatPromisesTooMuchIsRefusedBeforeAllocation) {
    auto bytes = prep::encode_png(gradient(4, 4, 3));
    ASSERT_TRUE(bytes);
    // Width and height are big-endian at offsets 16 and 20; 0x7000 = 28672 pixels each way.
    for (std::size_t at : {16, 20}) {
        (*bytes)[at + 2] = std::byte{0x70};
        (*bytes)[at + 3] = std::byte{0};
    }
    const auto image = prep::decode_image(*bytes, "liar.png");
    ASSERT_FALSE(image);  // by the checksum of the header, or by its promise
}

TEST(DecodeImage, GarbageIsAnError) {
    const std::vector<std::byte> noise(100, std::byte{0x5a});
    EXPECT_FALSE(prep::decode_image(noise, "noise.tga"));
    EXPECT_FALSE(prep::decode_image(noise, "noise"));
    EXPECT_FALSE(prep::decode_image(noise, "noise.null"));
    EXPECT_FALSE(prep::decode_image({}, "nothing.png"));
}

using LoadImage = ImageFiles;

TEST_F(LoadImage, MissingFileFolderAndMakeBelieveFormatsAreErrors) {
    EXPECT_EQ(prep::load_image(dir_ / "missing.png").error().code, prep::ErrorCode::io);
    EXPECT_EQ(prep::load_image(dir_).error().code, prep::ErrorCode::io);
    std::ofstream(dir_ / "a.null") << "x";
    EXPECT_FALSE(prep::load_image(dir_ / "a.null"));
    EXPECT_EQ(prep::load_image(prep::ImageRef{"nameless", {}, {}, {}, {}}).error().place,
              "nameless");
}

TEST_F(LoadImage, EmbeddedBytesWinOverThePath) {
    const auto bytes = prep::encode_png(gradient(3, 3, 3));
    prep::ImageRef ref{"embedded", dir_ / "missing.png", *bytes, {}, "image/png"};
    EXPECT_TRUE(prep::load_image(ref));
}

using SaveImage = ImageFiles;

TEST_F(SaveImage, FailureLeavesTheOldFileAndNoRubbish) {
    const auto good = gradient(3, 3, 3);
    ASSERT_TRUE(prep::save_image(dir_ / "a.png", good));
    const auto before = *prep::read_file(dir_ / "a.png");
    auto bad = good;
    bad.pixels.pop_back();
    EXPECT_FALSE(prep::save_image(dir_ / "a.png", bad));
    EXPECT_EQ(*prep::read_file(dir_ / "a.png"), before);
    EXPECT_EQ(prep::save_image(dir_ / "a.unknown", good).error().code,
              prep::ErrorCode::unsupported);
    EXPECT_EQ(prep::save_image(dir_ / "none" / "a.png", good).error().code, prep::ErrorCode::io);
    EXPECT_EQ(files(), 1u);
}

// What comes back is as near as the type's steps promise, or the format's own losses.
TEST_F(SaveImage, EveryEndingGivesBackWhatItSaysThatItHolds) {
    using prep::PixelType;
    struct Row {
        const char* ending;
        double u8, u16, f16, f32;  // largest errors; 0: not held
    };
    // A half has 11 bits; RGBE cuts off at 1/256 of the power of two above the largest channel.
    constexpr double u8 = 0.5001 / 255, u16 = 0.5001 / 65535, half = 0.5001 / 2048, exact = 1e-12;
    for (const Row& row :
         {Row{".png", u8, u16, 0, 0}, Row{".jpg", 0.1, 0, 0, 0}, Row{".jpeg", 0.1, 0, 0, 0},
          Row{".jpe", 0.1, 0, 0, 0}, Row{".jif", 0.1, 0, 0, 0}, Row{".jfif", 0.1, 0, 0, 0},
          Row{".jfi", 0.1, 0, 0, 0}, Row{".exr", 0, 0, half, exact}, Row{".tif", u8, u16, 0, exact},
          Row{".tiff", u8, u16, 0, exact}, Row{".hdr", 0, 0, 0, 1.0 / 128},
          Row{".webp", 0.1, 0, 0, 0}, Row{".tga", u8, 0, 0, 0}, Row{".bmp", u8, 0, 0, 0},
          Row{".ppm", u8, 0, 0, 0}, Row{".pnm", u8, 0, 0, 0}}) {
        const auto path = dir_ / (std::string("a") + row.ending);
        EXPECT_TRUE(prep::is_image_name(path)) << path;
        EXPECT_TRUE(prep::check_writable_image(path)) << path;
        const double bounds[] = {row.u8, row.u16, row.f16, row.f32};
        for (std::size_t t = 0; t < 4; ++t) {
            const auto type = PixelType(t);
            SCOPED_TRACE(path.string() + " type " + std::to_string(t));
            EXPECT_EQ(prep::image_holds(path, type), bounds[t] > 0);
            if (bounds[t] == 0) continue;
            prep::Image image = gradient(9, 7, 3);
            for (std::size_t i = 0; i < image.pixels.size(); ++i)  // nothing that JPEG blurs
                image.pixels[i] = 0.3f + 0.4f * float(i) / float(image.pixels.size());
            image.srgb = t == 0;
            ASSERT_TRUE(prep::save_image(path, image, type));
            const auto back = prep::load_image(path);
            ASSERT_TRUE(back) << to_string(back.error());
            ASSERT_EQ(back->width, 9u);
            ASSERT_EQ(back->height, 7u);
            ASSERT_EQ(back->channels, 3u);
            double worst = 0;
            for (std::size_t i = 0; i < image.pixels.size(); ++i)
                worst = std::max(worst, std::abs(double(back->pixels[i]) - image.pixels[i]));
            EXPECT_LE(worst, bounds[t]);
        }
    }
}

TEST_F(SaveImage, TypesThatAnEndingDoesNotHoldBecomeWiderOnesOrErrors) {
    using prep::PixelType;
    const prep::Image image = gradient(5, 3, 3);
    EXPECT_EQ(*prep::stored_type("a.exr", PixelType::u8), PixelType::f16);
    EXPECT_EQ(*prep::stored_type("a.exr", PixelType::u16), PixelType::f32);
    EXPECT_EQ(*prep::stored_type("a.tif", PixelType::f16), PixelType::f32);
    EXPECT_EQ(*prep::stored_type("a.hdr", PixelType::u8), PixelType::f32);
    ASSERT_TRUE(prep::save_image(dir_ / "a.exr", image, PixelType::u16));
    EXPECT_EQ(prep::load_image(dir_ / "a.exr")->pixels, image.pixels);
    for (const char* name : {"b.jpg", "b.ppm", "b.webp"})
        for (const PixelType type : {PixelType::u16, PixelType::f16, PixelType::f32}) {
            const auto saved = prep::save_image(dir_ / name, image, type);
            ASSERT_FALSE(saved) << name;
            EXPECT_EQ(saved.error().code, prep::ErrorCode::unsupported) << name;
        }
    EXPECT_FALSE(prep::stored_type("a.png", PixelType::f32));
    EXPECT_EQ(files(), 1u);
}

TEST_F(SaveImage, LevelsAreTheQuotientsThatTheyStandFor) {
    prep::Image image;
    image.width = 256;
    image.height = 1;
    image.channels = 1;
    for (int k = 0; k < 256; ++k) image.pixels.push_back(float(k) / 255.0f);
    for (const auto type : {prep::PixelType::u8, prep::PixelType::u16}) {
        ASSERT_TRUE(prep::save_image(dir_ / "a.png", image, type));
        EXPECT_EQ(prep::load_image(dir_ / "a.png")->pixels, image.pixels);
    }
    prep::Image wide = image;
    for (int k = 0; k < 256; ++k) wide.pixels[std::size_t(k)] = float(251 * k + 7) / 65535.0f;
    ASSERT_TRUE(prep::save_image(dir_ / "b.png", wide, prep::PixelType::u16));
    EXPECT_EQ(prep::load_image(dir_ / "b.png")->pixels, wide.pixels);
}

std::string bytes_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

// A picture is what EXR's display window shows.
TEST_F(SaveImage, APartOfAnExrStandsWhereItsWindowSays) {
    const prep::Image image = gradient(9, 7, 3);
    const auto path = dir_ / "a.exr";
    ASSERT_TRUE(prep::save_image(path, image, prep::PixelType::f32));
    std::string bytes = bytes_of(path);
    const std::string name("displayWindow\0box2i\0", 20);
    const std::size_t at = bytes.find(name) + name.size() + 4;
    struct Window {
        std::int32_t left, top, right, bottom;  // inclusive
    };
    for (const Window& window : {Window{-2, -1, 10, 8}, Window{3, 2, 5, 5}, Window{-4, 3, 4, 3},
                                 Window{20, 20, 22, 21}, Window{0, 0, 8, 6}}) {
        std::memcpy(bytes.data() + at, &window, sizeof window);
        test::write_text(path, bytes);
        const auto shown = prep::load_image(path);
        ASSERT_TRUE(shown) << to_string(shown.error());
        ASSERT_EQ(shown->width, std::uint32_t(window.right - window.left + 1));
        ASSERT_EQ(shown->height, std::uint32_t(window.bottom - window.top + 1));
        for (std::int32_t y = window.top; y <= window.bottom; ++y)
            for (std::int32_t x = window.left; x <= window.right; ++x)
                for (std::uint32_t k = 0; k < 3; ++k) {
                    const bool there = x >= 0 && x < 9 && y >= 0 && y < 7;
                    ASSERT_EQ(
                        shown->at(std::uint32_t(x - window.left), std::uint32_t(y - window.top))[k],
                        there ? image.at(std::uint32_t(x), std::uint32_t(y))[k] : 0.0f)
                        << x << ' ' << y;
                }
    }
    for (const auto& [edge, code] : {std::pair(2147483646, prep::ErrorCode::syntax),
                                     std::pair(32000, prep::ErrorCode::limit)}) {
        const Window absurd{0, 0, edge, edge};
        std::memcpy(bytes.data() + at, &absurd, sizeof absurd);
        test::write_text(path, bytes);
        const auto far = prep::load_image(path);
        ASSERT_FALSE(far);
        EXPECT_EQ(far.error().code, code) << to_string(far.error());
    }
}

// Written by OpenImageIO 2.4, these were empty (JPEG 2000), not to be read (texture files), not
// what their names say (P6 in a .pgm), other bytes each time (DPX, GIF), or nothing that tells a
// full disk.
TEST_F(SaveImage, WhatIsNotWrittenWholeIsRefused) {
    prep::ImageLayout layout;
    layout.width = 5, layout.height = 3, layout.channels = {"R", "G", "B"};
    layout.type = prep::PixelType::u8;
    for (const char* ending :
         {".jp2", ".j2k", ".tx", ".env", ".sm", ".pgm", ".pbm", ".iff", ".z", ".sgi", ".rla",
          ".ico", ".fits", ".dpx", ".gif", ".null", ".term", ".psd", ""}) {
        const auto path = dir_ / (std::string("a") + ending);
        const auto saved = prep::save_image(path, gradient(5, 3, 3));
        ASSERT_FALSE(saved) << ending;
        EXPECT_EQ(saved.error().code, prep::ErrorCode::unsupported) << ending;
        EXPECT_NE(saved.error().text.find(".png"), std::string::npos) << saved.error().text;
        prep::ImageFiles rows;
        EXPECT_FALSE(rows.open(path, layout)) << ending;
        EXPECT_FALSE(prep::check_writable_image(path)) << ending;
    }
    EXPECT_EQ(files(), 0u);
}

unsigned at(const std::string& bytes, std::size_t i) {
    return static_cast<unsigned char>(bytes.at(i));
}

// Width and height by the formats' own descriptions.
std::pair<std::size_t, std::size_t> extent_of_jpeg(const std::string& bytes) {
    for (std::size_t i = 2; i + 9 < bytes.size();) {
        const unsigned marker = at(bytes, i + 1);
        if (marker >= 0xc0 && marker <= 0xc2)  // a frame
            return {at(bytes, i + 7) * 256 + at(bytes, i + 8),
                    at(bytes, i + 5) * 256 + at(bytes, i + 6)};
        i += 2 + at(bytes, i + 2) * 256 + at(bytes, i + 3);
    }
    return {0, 0};
}

std::pair<std::size_t, std::size_t> extent_of_exr(const std::string& bytes) {
    std::int32_t box[4];
    const std::string name("dataWindow\0box2i\0", 17);
    std::memcpy(box, bytes.data() + bytes.find(name) + name.size() + 4, sizeof box);
    return {std::size_t(box[2] - box[0] + 1), std::size_t(box[3] - box[1] + 1)};
}

std::pair<std::size_t, std::size_t> extent_of_hdr(const std::string& bytes) {
    std::size_t width = 0, height = 0;
    std::sscanf(bytes.c_str() + bytes.find("\n-Y ") + 1, "-Y %zu +X %zu", &height, &width);
    return {width, height};
}

// Targa of types 2, 3, 10 and 11 with 8 to 32 bits: rows from the top, blue before red turned.
std::vector<unsigned> targa(const std::string& bytes) {
    const std::size_t width = at(bytes, 12) + 256 * at(bytes, 13);
    const std::size_t height = at(bytes, 14) + 256 * at(bytes, 15), each = at(bytes, 16) / 8;
    const bool runs = at(bytes, 2) >= 8, from_top = at(bytes, 17) & 0x20;
    std::vector<unsigned> stored;
    for (std::size_t i = 18 + at(bytes, 0); stored.size() < width * height * each;) {
        const unsigned head = runs ? at(bytes, i++) : 0;
        const unsigned count = (head & 0x7f) + 1;
        for (unsigned k = 0; k < count; ++k) {
            for (std::size_t c = 0; c < each; ++c) stored.push_back(at(bytes, i + c));
            if (k + 1 == count || !(head & 0x80)) i += each;
        }
    }
    std::vector<unsigned> pixels(stored.size());
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < each; ++c) {
                const std::size_t row = from_top ? y : height - 1 - y;
                const std::size_t channel = each >= 3 && c < 3 ? 2 - c : c;
                pixels[(y * width + x) * each + c] = stored[(row * width + x) * each + channel];
            }
    return pixels;
}

TEST(CorpusImages, PicturesHaveTheirFilesExtentAndColourSpace) {
    MESHPREP_REQUIRE_SHARED(shared);
    struct Case {
        const char* name;
        std::pair<std::size_t, std::size_t> (*extent)(const std::string&);
        bool floating;
    };
    for (const Case& c : {Case{"DamagedHelmet/Default_albedo.jpg", extent_of_jpeg, false},
                          Case{"museum.exr", extent_of_exr, true},
                          Case{"spiaggia_di_mondello_1k.hdr", extent_of_hdr, true}}) {
        const fs::path path = shared / "corpus" / c.name;
        const auto image = prep::load_image(path);
        ASSERT_TRUE(image) << c.name << ": " << to_string(image.error());
        const auto [width, height] = c.extent(bytes_of(path));
        EXPECT_EQ(image->width, width) << c.name;
        EXPECT_EQ(image->height, height) << c.name;
        EXPECT_EQ(image->floating, c.floating) << c.name;
        EXPECT_EQ(image->srgb, !c.floating) << c.name;
    }
}

TEST(CorpusImages, TargaPixelsAreThoseOfTheFile) {
    MESHPREP_REQUIRE_SHARED(shared);
    for (const char* name :
         {"diablo3_pose/diablo3_pose_nm.tga", "african_head/african_head_spec.tga"}) {
        const fs::path path = shared / "corpus" / name;
        const auto image = prep::load_image(path);
        ASSERT_TRUE(image) << name << ": " << to_string(image.error());
        const std::vector<unsigned> wanted = targa(bytes_of(path));
        ASSERT_EQ(image->pixels.size(), wanted.size()) << name;
        std::size_t differ = 0;
        for (std::size_t i = 0; i < wanted.size(); ++i)
            differ += unsigned(std::lround(image->pixels[i] * 255)) != wanted[i];
        EXPECT_EQ(differ, 0u) << name;
        EXPECT_TRUE(image->srgb) << name;
    }
}

}  // namespace
