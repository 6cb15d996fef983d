#include <png.h>

#include <bit>
#include <new>

#include "image/levels.h"
#include "image/picture_limits.h"
#include "image/png/png_file.h"
#include "image/png/png_problem.h"

namespace prep::detail {
namespace {

// What libpng is given and gives.
struct PngReading {
    explicit PngReading(PictureSource& from) : source(from) {}
    ~PngReading() { png_destroy_read_struct(&png, &info, nullptr); }
    PngReading(const PngReading&) = delete;
    PngReading& operator=(const PngReading&) = delete;

    PictureSource& source;
    png_structp png = nullptr;
    png_infop info = nullptr;
    int passes = 1;          // 7 where it is interlaced
    std::uint32_t bits = 0;  // a pixel in the file
    PngProblem problem;
};

void give_bytes(png_structp png, png_bytep to, std::size_t count) {
    PngReading& reading = *static_cast<PngReading*>(png_get_io_ptr(png));
    if (reading.source.read(to, count) < count)
        png_error(png, "the file ends before the picture does");
}

// Up to the pixels: what the file says of them.
bool read_header(PngReading& reading) {
    // Texts and what else says nothing of the pixels: a few bytes of file can be megabytes of it.
    static constexpr png_byte unread[] = "tEXt\0zTXt\0iTXt\0sPLT\0eXIf\0hIST\0pCAL\0sCAL\0tIME";
    PngProblem& problem = reading.problem;
    reading.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &problem, remember_problem,
                                           ignore_warning, &problem, take_memory, give_memory_back);
    if (!reading.png) return false;
    if (setjmp(png_jmpbuf(reading.png))) return false;
    reading.info = png_create_info_struct(reading.png);
    if (!reading.info) return false;
    png_set_keep_unknown_chunks(reading.png, PNG_HANDLE_CHUNK_NEVER, unread, sizeof(unread) / 5);
    png_set_user_limits(reading.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // ours, with our words
    png_set_read_fn(reading.png, &reading, give_bytes);
    png_read_info(reading.png, reading.info);
    return true;
}

// Makes ready for the pixels, which takes memory by the width.
bool start_pixels(PngReading& reading) {
    if (setjmp(png_jmpbuf(reading.png))) return false;
    reading.bits = std::uint32_t(png_get_bit_depth(reading.png, reading.info)) *
                   png_get_channels(reading.png, reading.info);
    png_set_expand(reading.png);
    if constexpr (std::endian::native == std::endian::little) png_set_swap(reading.png);
    reading.passes = png_set_interlace_handling(reading.png);
    png_read_update_info(reading.png, reading.info);
    return true;
}

bool read_rows(PngReading& reading, std::byte* to, std::size_t row_bytes, std::uint32_t rows) {
    if (setjmp(png_jmpbuf(reading.png))) return false;
    for (int pass = 0; pass < reading.passes; ++pass)
        for (std::uint32_t row = 0; row < rows; ++row)
            png_read_row(reading.png, reinterpret_cast<png_bytep>(to + row * row_bytes), nullptr);
    return true;
}

bool says_srgb(const PngReading& reading) {
    int intent = 0;
    double gamma = 0;
    return png_get_sRGB(reading.png, reading.info, &intent) != 0 ||
           png_get_gAMA(reading.png, reading.info, &gamma) == 0;
}

// As OpenImageIO calls those of other formats.
std::vector<std::string> names_of(std::uint32_t channels) {
    static constexpr const char* names[4][4] = {
        {"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    return {names[channels - 1], names[channels - 1] + channels};
}

}  // namespace

Result<Image> read_png(PictureSource& source, ImageChannels channels, const std::string& place) {
    PngReading reading(source);
    const auto broken = [&] {
        if (reading.problem.out_of_memory) throw std::bad_alloc();
        return Error{ErrorCode::syntax,
                     std::string("the image cannot be decoded: ") + reading.problem.reason, place};
    };
    if (!read_header(reading)) return broken();
    Image image;
    image.width = png_get_image_width(reading.png, reading.info);
    image.height = png_get_image_height(reading.png, reading.info);
    if (auto sized = check_extent(image.width, image.height, place); !sized) return sized.error();
    if (!start_pixels(reading)) return broken();
    image.channels = png_get_channels(reading.png, reading.info);
    // Deflate makes at most 1032 bytes of one.
    const std::uint64_t floats = 1032 * 32 * image.channels / reading.bits;
    if (auto kept = check_promise(image, source.size(), place, floats); !kept) return kept.error();
    image.integer_bits = png_get_bit_depth(reading.png, reading.info);
    image.srgb = says_srgb(reading);
    if (channels == ImageChannels::all) image.channel_names = names_of(image.channels);
    image.pixels.resize(std::size_t(image.width) * image.height * image.channels);
    const std::size_t level_bytes = image.integer_bits / 8;
    if (!read_rows(reading, place_of_levels(image, level_bytes),
                   std::size_t(image.width) * image.channels * level_bytes, image.height))
        return broken();
    if (level_bytes == 1)
        spread_levels<std::uint8_t>(image);
    else
        spread_levels<std::uint16_t>(image);
    return image;
}

}  // namespace prep::detail
