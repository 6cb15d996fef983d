// What pictures say of themselves: floats are linear light whatever holds them, bytes are sRGB; and
// channels of numbers in any place.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "image_folder.h"
#include "mesh_files.h"
#include "prep/image.h"

namespace {

using ImageValues = test::ImageFolder;

template <class T>
std::string raw(const std::vector<T>& values) {
    std::string out(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(out.data(), values.data(), out.size());
    return out;
}

// Two pixels of three channels, not compressed (TIFF 6.0). Format: 1 unsigned, 3 floating point.
std::string tiff(std::uint16_t bits, std::uint16_t format, const std::string& pixels) {
    struct Field {
        std::uint16_t tag, type;
        std::uint32_t count, value;
    };
    const std::uint32_t after = 8 + 2 + 11 * 12 + 4;
    const std::vector<Field> fields = {
        {256, 3, 1, 2}, {257, 3, 1, 1},        {258, 3, 3, after},
        {259, 3, 1, 1}, {262, 3, 1, 2},        {273, 4, 1, after + 12},
        {277, 3, 1, 3}, {278, 3, 1, 1},        {279, 4, 1, std::uint32_t(pixels.size())},
        {284, 3, 1, 1}, {339, 3, 3, after + 6}};
    std::string out("II*\0\x08\0\0\0\x0b\0", 10);
    for (const Field& f : fields)
        out += raw<std::uint16_t>({f.tag, f.type}) + raw<std::uint32_t>({f.count, f.value});
    out += std::string(4, '\0') + raw<std::uint16_t>({bits, bits, bits}) +
           raw<std::uint16_t>({format, format, format});
    return out + pixels;
}

const std::vector<float> values{0.25f, 0.5f, 0.75f, 1.5f, 0.0f, -2.0f};

TEST_F(ImageValues, FloatsAreLinearLightAndKeepTheirValuesInEveryFormat) {
    test::write_text(dir_ / "a.tif", tiff(32, 3, raw(values)));
    // Halves: 0.25, 0.5, 0.75, 1.5, 0, −2.
    test::write_text(dir_ / "half.tif",
                     tiff(16, 3, raw<std::uint16_t>({0x3400, 0x3800, 0x3a00, 0x3e00, 0, 0xc000})));
    test::write_text(dir_ / "a.pfm", "PF\n2 1\n-1.0\n" + raw(values));
    ASSERT_TRUE(prep::save_image(dir_ / "a.exr", {2, 1, 3, values, false}, prep::PixelType::f32));
    for (const char* name : {"a.tif", "half.tif", "a.pfm", "a.exr"}) {
        const auto image = prep::load_image(dir_ / name);
        ASSERT_TRUE(image) << name << to_string(image.error());
        EXPECT_EQ(image->pixels, values) << name;
        EXPECT_TRUE(image->floating) << name;
        EXPECT_FALSE(image->srgb) << name;
    }
}

// Tiles of 16 × 16, those at the right and below in part; any channels beyond three have no
// meaning of their own. `level(x, y, c)`.
template <class Level, class Levels>
std::string tiled_tiff(std::uint32_t width, std::uint32_t height, std::uint16_t channels,
                       const Levels& level) {
    constexpr std::uint32_t side = 16;
    const std::uint32_t across = (width + side - 1) / side, down = (height + side - 1) / side;
    const std::uint32_t tiles = across * down, bytes = side * side * channels * sizeof(Level);
    struct Field {
        std::uint16_t tag, type;
        std::uint32_t count, value;
    };
    const std::uint32_t after = 8 + 2 + 13 * 12 + 4, lists = after + 2 * channels;
    const std::uint32_t texels = lists + 8 * tiles;
    std::vector<Field> fields = {{256, 3, 1, width},
                                 {257, 3, 1, height},
                                 {258, 3, channels, after},
                                 {259, 3, 1, 1},
                                 {262, 3, 1, 2},
                                 {277, 3, 1, channels},
                                 {284, 3, 1, 1},
                                 {322, 3, 1, side},
                                 {323, 3, 1, side},
                                 {324, 4, tiles, lists},
                                 {325, 4, tiles, lists + 4 * tiles},
                                 {339, 3, 1, 1}};
    // The last place is of what further channels are, or of nothing.
    if (channels > 3) fields.insert(fields.end() - 1, {338, 3, channels - 3u, 0});
    std::string out("II*\0\x08\0\0\0", 8);
    out += raw<std::uint16_t>({std::uint16_t(fields.size())});
    for (const Field& f : fields)
        out += raw<std::uint16_t>({f.tag, f.type}) + raw<std::uint32_t>({f.count, f.value});
    out.resize(after, '\0');
    out += raw(std::vector<std::uint16_t>(channels, std::uint16_t(8 * sizeof(Level))));
    for (std::uint32_t t = 0; t < tiles; ++t) out += raw<std::uint32_t>({texels + t * bytes});
    for (std::uint32_t t = 0; t < tiles; ++t) out += raw<std::uint32_t>({bytes});
    for (std::uint32_t t = 0; t < tiles; ++t) {
        std::vector<Level> values;
        for (std::uint32_t k = 0; k < side * side * channels; ++k) {
            const std::uint32_t x = t % across * side + k / channels % side;
            const std::uint32_t y = t / across * side + k / channels / side;
            values.push_back(x < width && y < height ? level(x, y, k % channels) : Level(77));
        }
        out += raw(values);
    }
    return out;
}

template <class Level>
void expect_levels_of_tiles(const std::filesystem::path& path, std::uint16_t channels) {
    constexpr std::uint32_t width = 85, height = 67;  // more values than are made floats at once
    const auto level = [](std::uint32_t x, std::uint32_t y, std::uint32_t c) {
        return Level(x * 7919 + y * 104729 + c * 31337);
    };
    test::write_text(path, tiled_tiff<Level>(width, height, channels, level));
    for (const auto wanted : {prep::ImageChannels::color, prep::ImageChannels::all}) {
        const auto image = prep::load_image(path, wanted);
        ASSERT_TRUE(image) << to_string(image.error());
        const std::uint32_t count =
            wanted == prep::ImageChannels::all ? channels : std::min<std::uint32_t>(channels, 4);
        ASSERT_EQ(image->channels, count);
        ASSERT_EQ(image->pixels.size(), std::size_t(width) * height * count);
        std::size_t differ = 0, at = 0;
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                for (std::uint32_t c = 0; c < count; ++c)
                    differ += image->pixels[at++] !=
                              float(level(x, y, c)) / float(std::numeric_limits<Level>::max());
        EXPECT_EQ(differ, 0u) << channels << " channels, " << count << " of them";
    }
}

TEST_F(ImageValues, LevelsOfTilesAndOfChannelsBeyondColoursAreExact) {
    for (const auto channels : {std::uint16_t(3), std::uint16_t(5)}) {
        expect_levels_of_tiles<std::uint8_t>(dir_ / "a.tif", channels);
        expect_levels_of_tiles<std::uint16_t>(dir_ / "b.tif", channels);
    }
}

TEST_F(ImageValues, BytesAreSrgbInEveryFormat) {
    const std::string bytes("\x10\x80\xff\x00\x40\xc0", 6);
    test::write_text(dir_ / "a.tif", tiff(8, 1, bytes));
    test::write_text(dir_ / "a.ppm", "P6\n2 1\n255\n" + bytes);
    // Targa: blue first, from the top.
    test::write_text(dir_ / "a.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\1\0\x18\x20", 18) +
                                         std::string("\xff\x80\x10\xc0\x40\x00", 6));
    std::vector<float> pixels;
    for (const char c : bytes) pixels.push_back(float(static_cast<unsigned char>(c)) / 255);
    ASSERT_TRUE(prep::save_image(dir_ / "a.png", {2, 1, 3, pixels, true}));
    for (const char* name : {"a.tif", "a.ppm", "a.tga", "a.png"}) {
        const auto image = prep::load_image(dir_ / name);
        ASSERT_TRUE(image) << name << to_string(image.error());
        ASSERT_EQ(image->pixels.size(), pixels.size()) << name;
        for (std::size_t i = 0; i < pixels.size(); ++i)
            EXPECT_FLOAT_EQ(image->pixels[i], pixels[i]) << name << i;
        EXPECT_FALSE(image->floating) << name;
        // Those of PPM are of ITU-R BT.709, as its description has it.
        EXPECT_EQ(image->srgb, std::string(name) != "a.ppm") << name;
    }
}

// Only the values' 32 bits tell numbers from floats.
TEST_F(ImageValues, EveryChannelOfNumbersIsTold) {
    prep::ImageLayout layout;
    layout.width = 2;
    layout.height = 1;
    layout.channels = {"Z", "id", "node"};
    layout.type = prep::PixelType::f32;
    layout.integer = {false, true, true};
    const float depth[] = {0.5f, 3.25f};
    std::vector<std::uint32_t> words(6);
    for (std::size_t x = 0; x < 2; ++x) {
        std::memcpy(&words[3 * x], &depth[x], 4);
        words[3 * x + 1] = 0xfffffff0u + std::uint32_t(x);
        words[3 * x + 2] = 16777217u + std::uint32_t(x);
    }
    prep::ImageFiles files;
    const auto file = files.open(dir_ / "a.exr", layout);
    ASSERT_TRUE(file) << to_string(file.error());
    ASSERT_TRUE(files.write_rows(*file, words));
    ASSERT_TRUE(files.commit());
    const auto image = prep::load_image(dir_ / "a.exr", prep::ImageChannels::all);
    ASSERT_TRUE(image) << to_string(image.error());
    // The file's order of channels is by name.
    ASSERT_EQ(image->channel_names.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto& name = image->channel_names[k];
        const bool number = name != "Z";
        EXPECT_EQ(image->integer_channels >> k & 1, number ? 1u : 0u) << name;
        for (std::size_t x = 0; x < 2; ++x) {
            if (number) {
                EXPECT_EQ(image->integers.at(3 * x + k), words[3 * x + (name == "id" ? 1 : 2)]);
            } else {
                EXPECT_EQ(image->pixels[3 * x + k], depth[x]);
            }
        }
    }
}

TEST_F(ImageValues, TwoPicturesOfOneNameAreAnErrorHoweverItIsWritten) {
    prep::ImageLayout layout;
    layout.width = layout.height = 1;
    layout.channels = {"Y"};
    std::filesystem::create_directory(dir_ / "sub");
    std::filesystem::create_symlink("a.png", dir_ / "link.png");
    for (const std::string other : {"a.png", "sub/../a.png", "link.png"}) {
        prep::ImageFiles files;
        ASSERT_TRUE(files.open(dir_ / "a.png", layout));
        const auto second = files.open(dir_ / other, layout);
        ASSERT_FALSE(second) << other;
        EXPECT_EQ(second.error().text,
                  "two outputs would have this name; give one of them another");
    }
}

}  // namespace
