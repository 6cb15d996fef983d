// JPEG files, read by libjpeg: held against what OpenImageIO, which did it before, makes of them,
// and against what was put in.
// jpeglib.h needs what comes before it.
// clang-format off
#include <cstdio>
#include <jpeglib.h>
// clang-format on

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "prep/files.h"
#include "prep/image.h"
#include "temporary_files.h"

namespace {

using test::TempDir;

struct Kind {
    J_COLOR_SPACE stored = JCS_YCbCr;
    int across = 1, down = 1;  // of how many pixels the colours are one
    bool progressive = false, arithmetic = false;
    unsigned restart = 0;  // in blocks
    std::uint32_t width = 37, height = 22;
};

int channels_of(J_COLOR_SPACE space) {
    return space == JCS_GRAYSCALE ? 1 : space == JCS_CMYK || space == JCS_YCCK ? 4 : 3;
}

// Smooth, so that little is lost.
int value_at(std::uint32_t x, std::uint32_t y, int channel) {
    return int(127.5 + 120 * std::sin(0.13 * x + 0.21 * y + channel));
}

std::vector<std::byte> made(const Kind& kind) {
    jpeg_compress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&jpeg, &bytes, &size);
    jpeg.image_width = kind.width;
    jpeg.image_height = kind.height;
    jpeg.input_components = channels_of(kind.stored);
    jpeg.in_color_space = kind.stored == JCS_GRAYSCALE ? JCS_GRAYSCALE
                          : jpeg.input_components == 4 ? JCS_CMYK
                                                       : JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_set_colorspace(&jpeg, kind.stored);
    jpeg_set_quality(&jpeg, 98, TRUE);
    jpeg.comp_info[0].h_samp_factor = kind.across;
    jpeg.comp_info[0].v_samp_factor = kind.down;
    jpeg.restart_interval = kind.restart;
    jpeg.arith_code = kind.arithmetic ? TRUE : FALSE;
    if (kind.progressive) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    std::vector<JSAMPLE> row(kind.width * std::size_t(jpeg.input_components));
    for (std::uint32_t y = 0; y < kind.height; ++y) {
        for (std::size_t i = 0; i < row.size(); ++i)
            row[i] = JSAMPLE(value_at(std::uint32_t(i / std::size_t(jpeg.input_components)), y,
                                      int(i % std::size_t(jpeg.input_components))));
        JSAMPROW rows[] = {row.data()};
        jpeg_write_scanlines(&jpeg, rows, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    const auto* begin = reinterpret_cast<const std::byte*>(bytes);
    std::vector<std::byte> file(begin, begin + size);
    std::free(bytes);
    return file;
}

std::vector<Kind> plain_kinds() {
    std::vector<Kind> kinds;
    for (const bool progressive : {false, true})
        for (const auto& [across, down] : {std::pair{1, 1}, {2, 1}, {2, 2}, {1, 2}, {4, 1}})
            kinds.push_back({.across = across, .down = down, .progressive = progressive});
    kinds.push_back({.stored = JCS_GRAYSCALE});
    kinds.push_back({.stored = JCS_GRAYSCALE, .progressive = true});
    kinds.push_back({.stored = JCS_RGB});
    kinds.push_back({.arithmetic = true});
    kinds.push_back({.across = 2, .down = 2, .restart = 3});
    kinds.push_back({.width = 1, .height = 1});
    kinds.push_back({.across = 2, .down = 2, .width = 8, .height = 129});
    return kinds;
}

void expect_as_others_read(const std::filesystem::path& path, const prep::Image& image) {
    const auto input = OIIO::ImageInput::open(path.string());
    ASSERT_TRUE(input);
    const OIIO::ImageSpec& spec = input->spec();
    EXPECT_EQ(image.width, std::uint32_t(spec.width));
    EXPECT_EQ(image.height, std::uint32_t(spec.height));
    EXPECT_EQ(image.channel_names, spec.channelnames);
    EXPECT_EQ(image.srgb, spec.get_string_attribute("oiio:ColorSpace") == "sRGB");
    EXPECT_EQ(image.integer_bits, 8);
    ASSERT_EQ(image.pixels.size(), spec.image_pixels() * std::size_t(spec.nchannels));
    std::vector<std::uint8_t> levels(image.pixels.size());
    ASSERT_TRUE(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, levels.data()));
    for (std::size_t i = 0; i < levels.size(); ++i)
        ASSERT_EQ(image.pixels[i], float(levels[i]) / 255.0f) << i;
}

TEST(Jpeg, EveryKindIsReadAsOthersReadIt) {
    const TempDir dir;
    for (const Kind& kind : plain_kinds()) {
        SCOPED_TRACE(testing::Message() << kind.stored << " " << kind.across << "x" << kind.down
                                        << (kind.progressive ? " progressive" : ""));
        const std::vector<std::byte> file = made(kind);
        ASSERT_TRUE(prep::write_file(dir / "a.jpg", file));
        const auto image = prep::load_image(dir / "a.jpg", prep::ImageChannels::all);
        ASSERT_TRUE(image) << image.error().text;
        expect_as_others_read(dir / "a.jpg", *image);
        const auto embedded = prep::decode_image(file, "a.png");
        ASSERT_TRUE(embedded) << embedded.error().text;
        EXPECT_EQ(embedded->pixels, image->pixels);
        // It is the picture that was made: colours are one of eight pixels at most.
        const int channels = int(image->channels);
        double worst = 0;
        for (std::uint32_t y = 0; y < kind.height; ++y)
            for (std::uint32_t x = 0; x < kind.width; ++x)
                for (int k = 0; k < channels; ++k)
                    worst =
                        std::max(worst, std::abs(255.0 * image->at(x, y)[k] - value_at(x, y, k)));
        EXPECT_LT(worst, 8 + 25 * (kind.across * kind.down - 1));
    }
}

// What is printed with: OpenImageIO makes colours of it.
TEST(Jpeg, FourChannelsAreLeftToOpenImageIO) {
    const TempDir dir;
    for (const J_COLOR_SPACE space : {JCS_CMYK, JCS_YCCK}) {
        const std::vector<std::byte> file = made({.stored = space});
        ASSERT_TRUE(prep::write_file(dir / "a.jpg", file));
        const auto image = prep::load_image(dir / "a.jpg", prep::ImageChannels::all);
        ASSERT_TRUE(image) << image.error().text;
        EXPECT_EQ(image->channels, 3U);
        expect_as_others_read(dir / "a.jpg", *image);
        const auto embedded = prep::decode_image(file, "a.jpg");
        ASSERT_TRUE(embedded) << embedded.error().text;
        EXPECT_EQ(embedded->pixels, image->pixels);
    }
}

TEST(Jpeg, CutFilesAreErrors) {
    for (const Kind& kind : {Kind{}, Kind{.progressive = true}, Kind{.restart = 2}}) {
        const std::vector<std::byte> file = made(kind);
        for (std::size_t size = 4; size < file.size(); ++size) {
            const auto image = prep::decode_image(std::span(file).first(size), "cut.jpg");
            ASSERT_FALSE(image) << size << " of " << file.size();
            EXPECT_EQ(image.error().code, prep::ErrorCode::syntax);
            EXPECT_EQ(image.error().place, "cut.jpg");
            EXPECT_NE(image.error().text.find("truncated"), std::string::npos)
                << image.error().text;
        }
    }
}

// Behind the first marker; longer than what is read at a time.
TEST(Jpeg, LongPartsThatAreNotPixelsAreSkipped) {
    const TempDir dir;
    std::vector<std::byte> file = made({});
    const auto plain = prep::decode_image(file, "a.jpg");
    ASSERT_TRUE(plain);
    for (int part = 0; part < 3; ++part) {
        std::vector<std::byte> segment(65535 + 2, std::byte(0xff));
        segment[1] = std::byte(0xe5);                                                      // APP5
        for (std::size_t i = 5; i < segment.size(); i += 2) segment[i] = std::byte(0xd9);  // an end
        file.insert(file.begin() + 2, segment.begin(), segment.end());
    }
    ASSERT_TRUE(prep::write_file(dir / "a.jpg", file));
    const auto image = prep::load_image(dir / "a.jpg");
    ASSERT_TRUE(image) << image.error().text;
    EXPECT_EQ(image->pixels, plain->pixels);
    EXPECT_EQ(prep::decode_image(file, "a.jpg")->pixels, plain->pixels);
}

// Each takes the time of the whole picture.
TEST(Jpeg, ScansWithoutEndAreRefused) {
    const auto with_scans = [](int more) {
        std::vector<std::byte> file = made({.stored = JCS_GRAYSCALE, .progressive = true});
        const std::vector<std::byte> end(file.end() - 2, file.end());
        file.resize(file.size() - 2);
        for (int k = 0; k < more; ++k)
            for (const int byte : {0xff, 0xda, 0, 8, 1, 1, 0, 0, 0, 0})
                file.push_back(std::byte(byte));
        file.insert(file.end(), end.begin(), end.end());
        return prep::decode_image(file, "a.jpg");
    };
    EXPECT_TRUE(with_scans(20));
    const auto image = with_scans(600);
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, prep::ErrorCode::limit);
    EXPECT_NE(image.error().text.find("500 scans"), std::string::npos) << image.error().text;
}

// What only the header says.
TEST(Jpeg, HeadersThatPromiseTooMuchAreRefused) {
    const auto with_size = [](unsigned width, unsigned height) {
        std::vector<std::byte> file = made({.stored = JCS_GRAYSCALE});
        for (std::size_t i = 2; i + 8 < file.size(); ++i)
            if (file[i] == std::byte(0xff) && file[i + 1] == std::byte(0xc0)) {  // SOF0
                file[i + 5] = std::byte(height >> 8);
                file[i + 6] = std::byte(height & 255);
                file[i + 7] = std::byte(width >> 8);
                file[i + 8] = std::byte(width & 255);
                break;
            }
        return prep::decode_image(file, "a.jpg");
    };
    EXPECT_TRUE(with_size(37, 22));
    EXPECT_EQ(with_size(32769, 22).error().code, prep::ErrorCode::limit);
    EXPECT_EQ(with_size(37, 32769).error().code, prep::ErrorCode::limit);
    EXPECT_EQ(with_size(65500, 65500).error().code, prep::ErrorCode::limit);
    EXPECT_EQ(with_size(32768, 32768).error().code, prep::ErrorCode::invalid);
    EXPECT_EQ(with_size(0, 22).error().code, prep::ErrorCode::syntax);
}

// Damage that the format has no check for is read as what is there, and never more than that.
TEST(Jpeg, DamagedFilesArePicturesOrErrors) {
    for (const Kind& kind : {Kind{.across = 2, .down = 2}, Kind{.progressive = true}}) {
        const std::vector<std::byte> file = made(kind);
        int pictures = 0;
        for (std::size_t at = 2; at < file.size(); ++at) {
            std::vector<std::byte> damaged = file;
            damaged[at] ^= std::byte(0x55);
            const auto image = prep::decode_image(damaged, "a.jpg");
            if (!image) continue;
            EXPECT_EQ(image->pixels.size(),
                      std::size_t(image->width) * image->height * image->channels);
            ++pictures;
        }
        EXPECT_GT(pictures, 0);
    }
}

}  // namespace
