// PNG files, read and written by libpng: held against what was put in, and against OpenImageIO,
// which did it before.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>
#include <zlib.h>

#include <array>
#include <map>
#include <random>

#include "prep/files.h"
#include "prep/image.h"
#include "temporary_files.h"

namespace {

using test::TempDir;

enum class Space { none, srgb, gamma_2_2, linear };

struct Kind {
    int color_type = PNG_COLOR_TYPE_RGB, bits = 8;
    bool interlaced = false, transparent = false;
    Space space = Space::none;
    std::uint32_t width = 1, height = 1;
};

std::uint32_t samples_a_pixel(const Kind& kind) {
    switch (kind.color_type) {
        case PNG_COLOR_TYPE_GRAY_ALPHA:
            return 2;
        case PNG_COLOR_TYPE_RGB:
            return 3;
        case PNG_COLOR_TYPE_RGB_ALPHA:
            return 4;
        default:
            return 1;
    }
}

struct Made {
    std::vector<std::byte> file;
    std::vector<float> pixels;  // what is in it
    std::uint32_t channels = 0;
};

std::uint32_t entry(std::uint32_t index, std::uint32_t channel) {
    return (index * 37 + channel * 101 + 5) % 256;
}

// Random samples as a file of that kind, and as the pixels that they are by PNG's specification.
Made made(const Kind& kind, std::mt19937& random) {
    const std::uint32_t samples = samples_a_pixel(kind), top = (1u << kind.bits) - 1;
    const bool palette = kind.color_type == PNG_COLOR_TYPE_PALETTE;
    const std::uint32_t colors = palette ? 3 : samples, clear = top / 2;
    Made out;
    out.channels = colors + (kind.transparent ? 1 : 0);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &out.file,
        [](png_structp to, png_bytep bytes, std::size_t count) {
            auto& file = *static_cast<std::vector<std::byte>*>(png_get_io_ptr(to));
            const auto* begin = reinterpret_cast<const std::byte*>(bytes);
            file.insert(file.end(), begin, begin + count);
        },
        nullptr);
    png_set_IHDR(png, info, kind.width, kind.height, kind.bits, kind.color_type,
                 kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (kind.space == Space::srgb) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (kind.space == Space::gamma_2_2) png_set_gAMA(png, info, 1 / 2.2);
    if (kind.space == Space::linear) png_set_gAMA(png, info, 1.0);
    std::vector<png_color> table;
    std::vector<png_byte> alphas;
    if (palette) {
        for (std::uint32_t i = 0; i <= top; ++i) {
            table.push_back({png_byte(entry(i, 0)), png_byte(entry(i, 1)), png_byte(entry(i, 2))});
            alphas.push_back(png_byte(entry(i, 3)));
        }
        png_set_PLTE(png, info, table.data(), int(table.size()));
        if (kind.transparent) png_set_tRNS(png, info, alphas.data(), int(alphas.size()), nullptr);
    } else if (kind.transparent) {
        png_color_16 key{};
        key.gray = key.red = key.green = key.blue = png_uint_16(clear);
        png_set_tRNS(png, info, nullptr, 0, &key);
    }
    png_write_info(png, info);
    png_set_packing(png);
    const int passes = png_set_interlace_handling(png);
    const std::uint32_t bytes = kind.bits == 16 ? 2 : 1;
    std::vector<std::vector<png_byte>> rows(kind.height);
    std::uniform_int_distribution<std::uint32_t> any(0, top), few(0, 3);
    for (std::vector<png_byte>& row : rows)
        for (std::uint32_t x = 0; x < kind.width; ++x) {
            const bool see_through = kind.transparent && !palette && few(random) == 0;
            std::array<std::uint32_t, 4> values{};
            for (std::uint32_t k = 0; k < samples; ++k) {
                values[k] = see_through ? clear : any(random);
                if (bytes == 2) row.push_back(png_byte(values[k] >> 8));
                row.push_back(png_byte(values[k] & 255));
            }
            if (palette) {
                for (std::uint32_t k = 0; k < out.channels; ++k)
                    out.pixels.push_back(float(entry(values[0], k)) / 255.0f);
                continue;
            }
            bool is_clear = kind.transparent;
            for (std::uint32_t k = 0; k < samples; ++k) {
                out.pixels.push_back(float(values[k]) / float(top));
                is_clear = is_clear && values[k] == clear;
            }
            if (kind.transparent) out.pixels.push_back(is_clear ? 0.0f : 1.0f);
        }
    for (int pass = 0; pass < passes; ++pass)
        for (std::vector<png_byte>& row : rows) png_write_row(png, row.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return out;
}

void expect_as_others_read(const std::filesystem::path& path, const prep::Image& image) {
    OIIO::ImageSpec wish;
    wish.attribute("oiio:UnassociatedAlpha", 1);
    const auto input = OIIO::ImageInput::open(path.string(), &wish);
    ASSERT_TRUE(input);
    const OIIO::ImageSpec& spec = input->spec();
    EXPECT_EQ(image.channel_names, spec.channelnames);
    EXPECT_EQ(image.srgb, spec.get_string_attribute("oiio:ColorSpace") == "sRGB");
    const bool wide = spec.format == OIIO::TypeDesc::UINT16;
    EXPECT_EQ(image.integer_bits, wide ? 16 : 8);
    ASSERT_EQ(image.pixels.size(), spec.image_pixels() * std::size_t(spec.nchannels));
    std::vector<std::uint16_t> levels(image.pixels.size());
    // A level of 8 bits is 257 times itself in 16.
    ASSERT_TRUE(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT16, levels.data()));
    for (std::size_t i = 0; i < levels.size(); ++i)
        ASSERT_EQ(image.pixels[i],
                  wide ? float(levels[i]) / 65535.0f : float(levels[i] / 257) / 255.0f)
            << i;
}

// Every kind of PNG that there is, with its values as they were put in.
TEST(Png, EveryKindIsReadAsItWasMadeAndAsOthersReadIt) {
    const TempDir dir;
    std::mt19937 random(20);
    const std::map<int, std::vector<int>> kinds = {{PNG_COLOR_TYPE_GRAY, {1, 2, 4, 8, 16}},
                                                   {PNG_COLOR_TYPE_PALETTE, {1, 2, 4, 8}},
                                                   {PNG_COLOR_TYPE_RGB, {8, 16}},
                                                   {PNG_COLOR_TYPE_GRAY_ALPHA, {8, 16}},
                                                   {PNG_COLOR_TYPE_RGB_ALPHA, {8, 16}}};
    int files = 0;
    for (const auto& [color_type, depths] : kinds)
        for (const int bits : depths)
            for (const bool interlaced : {false, true})
                for (const bool transparent : {false, true}) {
                    if (transparent && (color_type & PNG_COLOR_MASK_ALPHA) != 0) continue;
                    Kind kind{color_type, bits, interlaced, transparent, Space(files % 4), 1, 1};
                    kind.width = 1 + std::uint32_t(random() % 40);
                    kind.height = 1 + std::uint32_t(random() % 20);
                    SCOPED_TRACE(std::to_string(files++) + ": type " + std::to_string(color_type) +
                                 ", " + std::to_string(bits) + " bits");
                    const Made picture = made(kind, random);
                    ASSERT_TRUE(prep::write_file(dir / "a.png", picture.file));
                    const auto image = prep::load_image(dir / "a.png", prep::ImageChannels::all);
                    ASSERT_TRUE(image) << image.error().text;
                    EXPECT_EQ(image->width, kind.width);
                    EXPECT_EQ(image->height, kind.height);
                    EXPECT_EQ(image->channels, picture.channels);
                    EXPECT_EQ(image->pixels, picture.pixels);
                    expect_as_others_read(dir / "a.png", *image);
                    const auto embedded = prep::decode_image(picture.file, "a.jpg");
                    ASSERT_TRUE(embedded) << embedded.error().text;
                    EXPECT_EQ(embedded->pixels, picture.pixels);
                    std::filesystem::rename(dir / "a.png", dir / "a.jpg");
                    const auto misnamed = prep::load_image(dir / "a.jpg");
                    ASSERT_TRUE(misnamed) << misnamed.error().text;
                    EXPECT_EQ(misnamed->pixels, picture.pixels);
                }
    EXPECT_EQ(files, 52);
}

prep::Image noise(std::uint32_t width, std::uint32_t height, std::uint32_t channels, bool srgb) {
    std::mt19937 random(width * 31 + height + channels);
    std::uniform_real_distribution<float> value(-0.1f, 1.1f);
    prep::Image image;
    image.width = width;
    image.height = height;
    image.channels = channels;
    image.srgb = srgb;
    // Rows that one filter suits, and rows that none does.
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t i = 0; i < width * channels; ++i)
            image.pixels.push_back(y % 3 == 0 ? float(i) / float(width * channels) : value(random));
    return image;
}

// Pictures that were written before, by OpenImageIO, come out as the same bytes.
TEST(Png, WrittenFilesAreThoseOfOpenImageIO) {
    const TempDir dir;
    for (std::uint32_t channels = 1; channels <= 4; ++channels)
        for (const bool wide : {false, true})
            for (const bool srgb : {false, true}) {
                SCOPED_TRACE(std::to_string(channels) + (wide ? " wide" : "") +
                             (srgb ? " srgb" : ""));
                // More than one chunk of libpng's.
                const prep::Image image = noise(61 + channels, 140, channels, srgb);
                const auto type = wide ? prep::PixelType::u16 : prep::PixelType::u8;
                const auto bytes = prep::encode_png(image, type);
                ASSERT_TRUE(bytes);
                const auto back = prep::decode_image(*bytes, "a");
                ASSERT_TRUE(back);
                EXPECT_EQ(back->srgb, srgb);
                OIIO::ImageSpec spec(int(image.width), int(image.height), int(channels),
                                     wide ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
                spec.attribute("oiio:ColorSpace", srgb ? "sRGB" : "Linear");
                spec.attribute("oiio:UnassociatedAlpha", 1);
                spec.attribute("png:compressionLevel", 4);
                const auto output = OIIO::ImageOutput::create("a.png");
                ASSERT_TRUE(output->open((dir / "others.png").string(), spec));
                // What was read back is on the levels: no rounding is left to anyone.
                ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, back->pixels.data()));
                ASSERT_TRUE(output->close());
                EXPECT_EQ(*bytes, *prep::read_file(dir / "others.png"));

                prep::ImageFiles files;
                prep::ImageLayout layout{image.width, image.height, {}, type, {}, srgb};
                for (std::uint32_t k = 0; k < channels; ++k)
                    layout.channels.push_back(std::string(1, "RGBA"[k]));
                const auto file = files.open(dir / "rows.png", layout);
                ASSERT_TRUE(file);
                const std::size_t row = std::size_t(image.width) * channels;
                for (std::size_t y = 0; y < image.height; y += 20)
                    ASSERT_TRUE(files.write_rows(
                        *file, std::span(image.pixels).subspan(y * row, 20 * row)));
                ASSERT_TRUE(files.commit());
                EXPECT_EQ(*bytes, *prep::read_file(dir / "rows.png"));
            }
}

// PNG's specification, annex D.
std::uint32_t crc_of(std::span<const std::byte> bytes) {
    std::uint32_t crc = 0xffffffff;
    for (const std::byte byte : bytes) {
        crc ^= std::to_integer<std::uint32_t>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 1 ? 0xedb88320 : 0) ^ (crc >> 1);
    }
    return ~crc;
}

// Cut anywhere: an error, or, where all pixels came before the cut, the picture.
TEST(Png, CutFilesAreErrorsOrWhole) {
    std::mt19937 random(5);
    for (const bool interlaced : {false, true}) {
        const Kind kind{PNG_COLOR_TYPE_RGB, 8, interlaced, false, Space::srgb, 23, 11};
        const Made picture = made(kind, random);
        std::size_t whole = 0;
        for (std::size_t size = 1; size < picture.file.size(); ++size) {
            const auto image = prep::decode_image(std::span(picture.file).first(size), "cut.png");
            if (image) {
                EXPECT_EQ(image->pixels, picture.pixels);
                ++whole;
            } else {
                EXPECT_EQ(image.error().code, prep::ErrorCode::syntax);
                EXPECT_EQ(image.error().place, "cut.png");
                if (size > 8) {
                    EXPECT_NE(image.error().text.find("ends before the picture does"),
                              std::string::npos)
                        << image.error().text;
                }
            }
        }
        EXPECT_LT(whole, 20u);  // IEND, and what closes the last chunk of pixels
    }
}

// Behind the header of a file.
void insert_chunk(std::vector<std::byte>& file, const std::string& name,
                  std::span<const std::byte> data) {
    std::vector<std::byte> chunk;
    const auto number = [&](std::uint32_t value) {
        for (int k = 24; k >= 0; k -= 8) chunk.push_back(std::byte(value >> k));
    };
    number(std::uint32_t(data.size()));
    for (const char c : name) chunk.push_back(std::byte(c));
    chunk.insert(chunk.end(), data.begin(), data.end());
    number(crc_of(std::span(chunk).subspan(4)));
    file.insert(file.begin() + 33, chunk.begin(), chunk.end());
}

// libpng takes colours for invalid where one of their chunks is: the others are what they say.
TEST(Png, ColoursOfFilesWithOddChunksAreAsOthersReadThem) {
    const TempDir dir;
    std::mt19937 random(5);
    const std::vector<std::byte> zeros(32),
        linear{std::byte(0), std::byte(1), std::byte(0x86), std::byte(0xa0)};
    for (const Space space : {Space::none, Space::srgb, Space::gamma_2_2, Space::linear})
        for (const int odd : {0, 1, 2}) {
            SCOPED_TRACE(std::to_string(int(space)) + " " + std::to_string(odd));
            auto file = made({.space = space, .width = 3, .height = 2}, random).file;
            if (odd == 1) insert_chunk(file, "cHRM", zeros);
            if (odd == 2) insert_chunk(file, "gAMA", linear);
            ASSERT_TRUE(prep::write_file(dir / "a.png", file));
            const auto image = prep::load_image(dir / "a.png", prep::ImageChannels::all);
            ASSERT_TRUE(image) << image.error().text;
            expect_as_others_read(dir / "a.png", *image);
        }
}

// A few kilobytes of file can be hundreds of megabytes of text, of which nothing is needed.
TEST(Png, TextsTakeNoMemory) {
    std::mt19937 random(5);
    auto file = made({.width = 3, .height = 2}, random).file;
    const std::vector<Bytef> text(7'900'000, 'x');
    std::vector<std::byte> packed(100'000);
    auto size = uLongf(packed.size());
    ASSERT_EQ(::compress(reinterpret_cast<Bytef*>(packed.data()), &size, text.data(), text.size()),
              Z_OK);
    std::vector<std::byte> data{std::byte('k'), std::byte(0), std::byte(0)};
    data.insert(data.end(), packed.begin(), packed.begin() + long(size));
    for (int k = 0; k < 50; ++k) insert_chunk(file, "zTXt", data);
    rusage before{}, after{};
    ::getrusage(RUSAGE_SELF, &before);
    EXPECT_TRUE(prep::decode_image(file, "a.png"));
    ::getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100'000) << "kB";  // of 395
}

// What the compression of PNG can do at its best is no damage.
TEST(Png, LargeConstantPicturesOfOneBitAreRead) {
    std::vector<std::byte> file;
    {
        prep::Image small{1, 1, 1, {0.0f}, true};
        file = *prep::encode_png(small);
    }
    const std::uint32_t side = 8600;  // 296 MB of floats
    std::vector<std::byte> header;
    for (const std::uint32_t extent : {side, side})
        for (int k = 24; k >= 0; k -= 8) header.push_back(std::byte(extent >> k));
    for (const int field : {1, 0, 0, 0, 0}) header.push_back(std::byte(field));
    const std::vector<Bytef> rows(std::size_t(side) * (1 + side / 8));
    std::vector<std::byte> packed(rows.size() / 500);
    auto size = uLongf(packed.size());
    ASSERT_EQ(::compress2(reinterpret_cast<Bytef*>(packed.data()), &size, rows.data(), rows.size(),
                          Z_BEST_COMPRESSION),
              Z_OK);
    packed.resize(size);
    file.resize(8);
    file.resize(33);  // insert_chunk() puts behind the header, which is made last
    insert_chunk(file, "IEND", {});
    insert_chunk(file, "IDAT", packed);
    insert_chunk(file, "IHDR", header);
    file.erase(file.begin() + 8, file.begin() + 33);
    const auto image = prep::decode_image(file, "a.png");
    ASSERT_TRUE(image) << image.error().text;
    EXPECT_EQ(image->width, side);
    EXPECT_EQ(image->pixels.back(), 0.0f);
}

// What only the header says.
TEST(Png, HeadersThatPromiseTooMuchAreRefused) {
    std::mt19937 random(5);
    const auto with_size = [&](std::uint32_t width, std::uint32_t height) {
        Kind kind{PNG_COLOR_TYPE_GRAY, 8, false, false, Space::none, 1, 1};
        std::vector<std::byte> file = made(kind, random).file;
        for (int k = 0; k < 4; ++k) {
            file[16 + k] = std::byte(width >> (24 - 8 * k));
            file[20 + k] = std::byte(height >> (24 - 8 * k));
        }
        const std::uint32_t crc = crc_of(std::span(file).subspan(12, 17));
        for (int k = 0; k < 4; ++k) file[29 + k] = std::byte(crc >> (24 - 8 * k));
        return prep::decode_image(file, "a.png");
    };
    EXPECT_TRUE(with_size(1, 1));
    EXPECT_EQ(with_size(32769, 1).error().code, prep::ErrorCode::limit);
    EXPECT_EQ(with_size(1, 32769).error().code, prep::ErrorCode::limit);
    EXPECT_EQ(with_size(0x7fffffff, 0x7fffffff).error().code, prep::ErrorCode::limit);
    EXPECT_EQ(with_size(32768, 32768).error().code, prep::ErrorCode::invalid);
    EXPECT_EQ(with_size(0, 1).error().code, prep::ErrorCode::syntax);
    EXPECT_EQ(with_size(1, 0x80000000).error().code, prep::ErrorCode::syntax);
    EXPECT_EQ(with_size(2, 2).error().code, prep::ErrorCode::syntax);  // has fewer
}

TEST(Png, MoreThanFourChannelsAreRefused) {
    const TempDir dir;
    prep::ImageFiles files;
    const prep::ImageLayout layout{4, 2, {"R", "G", "B", "A", "Z"}, prep::PixelType::u8, {}, true};
    const auto file = files.open(dir / "a.png", layout);
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, prep::ErrorCode::unsupported);
}

// A signature that a transfer as text has changed.
TEST(Png, DamagedSignaturesAreSaid) {
    auto bytes = *prep::encode_png(noise(4, 4, 3, true));
    bytes.erase(bytes.begin() + 4);  // of \r\n
    const auto image = prep::decode_image(bytes, "a.png");
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, prep::ErrorCode::syntax);
    EXPECT_NE(image.error().text.find("PNG"), std::string::npos) << image.error().text;
}

}  // namespace
