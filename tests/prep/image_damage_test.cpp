// Pictures that are cut short, and formats whose colours come multiplied by alpha.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "prep/files.h"
#include "prep/image.h"

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

void add(Bytes& to, std::initializer_list<int> values) {
    for (const int value : values) to.push_back(std::byte(value));
}

// Both ways of reading: from memory, and from a file.
prep::Error error_of(const Bytes& bytes, const std::string& name) {
    const auto from_memory = prep::decode_image(bytes, name);
    const fs::path path =
        fs::temp_directory_path() / (std::to_string(::getpid()) + "-image-damage-" + name);
    EXPECT_TRUE(prep::write_file(path, bytes));
    const auto from_file = prep::load_image(path);
    fs::remove(path);
    EXPECT_EQ(bool(from_memory), bool(from_file));
    if (from_memory || from_file) return {prep::ErrorCode::io, "none", ""};
    EXPECT_EQ(from_memory.error().code, from_file.error().code);
    return from_memory.error();
}

bool is_truncated(const prep::Error& error) {
    return error.code == prep::ErrorCode::syntax &&
           error.text.find("truncated") != std::string::npos;
}

// The bits of lossless WebP (its specification, 2012), least significant first.
class Bits {
  public:
    void put(std::uint32_t value, int count) {
        for (int i = 0; i < count; ++i, ++size_) {
            if (size_ % 8 == 0) bytes.push_back(std::byte(0));
            bytes.back() |= std::byte((value >> i & 1) << size_ % 8);
        }
    }
    Bytes bytes;

  private:
    int size_ = 0;
};

// 4 × 2 pixels of one colour.
Bytes webp(const std::uint32_t (&rgba)[4]) {
    Bits bits;
    bits.put(0x2f, 8);
    bits.put(4 - 1, 14);
    bits.put(2 - 1, 14);
    bits.put(1, 1);  // alpha is used
    bits.put(0, 3);  // version
    bits.put(0, 3);  // no transform, no colour cache, one group of codes
    for (const std::uint32_t value : {rgba[1], rgba[0], rgba[2], rgba[3], 0u}) {
        bits.put(1, 1);  // a simple code
        bits.put(0, 1);  // of one symbol
        bits.put(1, 1);  // of eight bits
        bits.put(value, 8);
    }
    if (bits.bytes.size() % 2 == 1) bits.bytes.push_back(std::byte(0));
    const auto length = std::uint8_t(bits.bytes.size());
    Bytes out;
    add(out, {'R', 'I', 'F', 'F', length + 12, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8', 'L'});
    add(out, {length, 0, 0, 0});
    out.insert(out.end(), bits.bytes.begin(), bits.bytes.end());
    return out;
}

TEST(Webp, ColoursAreNotMultipliedByAlpha) {
    for (const std::uint32_t alpha : {255u, 128u, 40u, 0u}) {
        const std::uint32_t colour[4] = {200, 100, 50, alpha};
        const auto image = prep::decode_image(webp(colour), "a.webp");
        ASSERT_TRUE(image) << to_string(image.error());
        ASSERT_EQ(image->channels, 4u);
        for (std::size_t i = 0; i < image->pixels.size(); ++i) {
            const double found = image->pixels[i] * 255;
            // Half a level of rounding of the multiplied colour, seen through alpha.
            const double tolerance = alpha > 0 ? 127.51 / alpha + 1e-3 : 0;
            const double expected = i % 4 == 3 ? alpha : alpha > 0 ? colour[i % 4] : 0;
            EXPECT_NEAR(found, expected, i % 4 == 3 ? 1e-4 : tolerance) << alpha;
        }
    }
}

Bytes file_of(const prep::Image& image, const std::string& ending) {
    const fs::path path =
        fs::temp_directory_path() / (std::to_string(::getpid()) + "-image-damage-whole." + ending);
    EXPECT_TRUE(prep::save_image(path, image));
    const auto bytes = prep::read_file(path);
    fs::remove(path);
    return bytes ? *bytes : Bytes{};
}

TEST(TruncatedJpeg, IsAnErrorWhereverItIsCut) {
    prep::Image image{64, 48, 3, {}, true};
    for (std::uint32_t i = 0; i < 64 * 48 * 3; ++i)
        image.pixels.push_back(float(i * 7919 % 256) / 255);
    const Bytes whole = file_of(image, "jpg");
    ASSERT_TRUE(prep::decode_image(whole, "a.jpg"));
    for (std::size_t size = 16; size < whole.size(); size += 97)
        EXPECT_TRUE(
            is_truncated(error_of(Bytes(whole.begin(), whole.begin() + long(size)), "a.jpg")))
            << size << " of " << whole.size();
    EXPECT_TRUE(is_truncated(error_of(Bytes(whole.begin(), whole.end() - 2), "a.jpg")));
    Bytes longer = whole;
    add(longer, {0, 0, 0});
    EXPECT_TRUE(prep::decode_image(longer, "a.jpg")) << "bytes after the end are no loss";
}

// With four inks, as libjpeg itself sees to others, and finds more that is wrong with these.
TEST(TruncatedJpeg, EndsOfThumbnailsAndTablesAreNotThePictures) {
    Bytes bytes;
    add(bytes, {0xff, 0xd8});
    add(bytes, {0xff, 0xe1, 0, 8, 0xff, 0xd8, 0xff, 0xd9, 0xff, 0xd9});  // a thumbnail
    add(bytes, {0xff, 0xc2, 0, 20, 8, 0, 8, 0, 8, 4});                   // 8 × 8, progressive
    for (int ink = 1; ink <= 4; ++ink) add(bytes, {ink, 0x11, 0});
    const auto scan = [&] {
        add(bytes, {0xff, 0xda, 0, 14, 4, 1, 0, 2, 0, 3, 0, 4, 0, 0, 0, 0});
        add(bytes, {0x12, 0xff, 0x00, 0x34, 0xff, 0xd0, 0x56});  // a stuffed FF, a restart
    };
    scan();
    add(bytes, {0xff, 0xff, 0xc4, 0, 6, 0xff, 0xd9, 0xff, 0xd9});  // a table between two scans
    scan();
    EXPECT_TRUE(is_truncated(error_of(bytes, "a.jpg")));
    add(bytes, {0xff, 0xd9});
    EXPECT_FALSE(is_truncated(error_of(bytes, "a.jpg")));
}

// 2 × 4 grey pixels in two strips behind the directory, after the specification of TIFF 6.0.
Bytes tiff(bool big_endian, int last_count) {
    Bytes out;
    const auto number = [&](std::uint32_t value, int width) {
        for (int i = 0; i < width; ++i)
            add(out, {int(value >> 8 * (big_endian ? width - 1 - i : i) & 255)});
    };
    add(out, {big_endian ? 'M' : 'I', big_endian ? 'M' : 'I'});
    number(42, 2);
    number(8, 4);
    number(10, 2);
    const std::uint32_t after = 8 + 2 + 10 * 12 + 4;
    const auto field = [&](std::uint32_t tag, bool is_long, std::uint32_t count,
                           std::uint32_t value) {
        number(tag, 2);
        number(is_long ? 4 : 3, 2);
        number(count, 4);
        if (is_long) {
            number(value, 4);
        } else {
            number(value, 2);
            number(0, 2);
        }
    };
    field(256, false, 1, 2);         // columns
    field(257, false, 1, 4);         // rows
    field(258, false, 1, 8);         // bits
    field(259, false, 1, 1);         // not compressed
    field(262, false, 1, 1);         // black is 0
    field(273, true, 2, after);      // where the strips are
    field(277, false, 1, 1);         // samples
    field(278, false, 1, 3);         // rows of a strip
    field(279, true, 2, after + 8);  // their bytes
    field(284, false, 1, 1);         // contiguous
    number(0, 4);
    number(after + 16, 4);
    number(after + 22, 4);
    number(6, 4);
    number(std::uint32_t(last_count), 4);
    for (int i = 1; i <= 8; ++i) add(out, {i * 30});
    return out;
}

TEST(TruncatedTiff, IsAnErrorWhereverItIsCut) {
    for (const bool big_endian : {false, true}) {
        const Bytes whole = tiff(big_endian, 2);
        const auto image = prep::decode_image(whole, "a.tif");
        ASSERT_TRUE(image) << to_string(image.error());
        ASSERT_EQ(image->pixels.size(), 8u);
        for (int i = 1; i <= 8; ++i)
            EXPECT_EQ(std::lround(image->pixels[std::size_t(i - 1)] * 255), i * 30);
        for (std::size_t size = 16; size < whole.size(); ++size)
            EXPECT_TRUE(
                is_truncated(error_of(Bytes(whole.begin(), whole.begin() + long(size)), "a.tif")))
                << size << " of " << whole.size();
    }
}

// The same pixels in a BigTIFF (its proposal of 2004): numbers of eight bytes, one strip.
Bytes big_tiff() {
    Bytes out;
    const auto number = [&](std::uint64_t value, int width) {
        for (int i = 0; i < width; ++i) add(out, {int(value >> 8 * i & 255)});
    };
    add(out, {'I', 'I'});
    number(43, 2);
    number(8, 2);
    number(0, 2);
    number(16, 8);
    constexpr int fields = 9;
    number(fields, 8);
    constexpr std::uint64_t after = 16 + 8 + fields * 20 + 8;
    const std::uint64_t values[fields][3] = {{256, 3, 2}, {257, 3, 4}, {258, 3, 8},
                                             {259, 3, 1}, {262, 3, 1}, {273, 16, after},
                                             {277, 3, 1}, {278, 3, 4}, {279, 16, 8}};
    for (const auto& [tag, type, value] : values) {
        number(tag, 2);
        number(type, 2);
        number(1, 8);
        number(value, 8);
    }
    number(0, 8);
    for (int i = 1; i <= 8; ++i) add(out, {i * 30});
    return out;
}

TEST(TruncatedTiff, OfTheLargeKindIsAnErrorWhereverItIsCut) {
    const Bytes whole = big_tiff();
    const auto image = prep::decode_image(whole, "a.tif");
    ASSERT_TRUE(image) << to_string(image.error());
    ASSERT_EQ(image->pixels.size(), 8u);
    for (int i = 1; i <= 8; ++i)
        EXPECT_EQ(std::lround(image->pixels[std::size_t(i - 1)] * 255), i * 30);
    for (std::size_t size = 24; size < whole.size(); ++size)
        EXPECT_TRUE(
            is_truncated(error_of(Bytes(whole.begin(), whole.begin() + long(size)), "a.tif")))
            << size << " of " << whole.size();
}

TEST(TruncatedTiff, ALastStripCountedAsAFullOneIsWhole) {
    const auto image = prep::decode_image(tiff(false, 6), "a.tif");
    ASSERT_TRUE(image) << to_string(image.error());
    EXPECT_EQ(std::lround(image->pixels[7] * 255), 240);
}

}  // namespace
