#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <cstdio>  // before jpeglib.h, which needs it

#include "image/jpeg/jpeg_file.h"
#include "image/levels.h"
#include "image/picture_limits.h"

namespace prep::detail {
namespace {

// What libjpeg is given and gives. It leaves by longjmp(), past destructors: functions that call
// setjmp() have no objects of their own, and what they fill lives in their callers.
struct JpegReading {
    JpegReading() = default;
    ~JpegReading() { jpeg_destroy_decompress(&jpeg); }
    JpegReading(const JpegReading&) = delete;
    JpegReading& operator=(const JpegReading&) = delete;

    jpeg_decompress_struct jpeg{};
    jpeg_error_mgr errors{};
    std::jmp_buf leave;
    bool cut = false;
    char reason[JMSG_LENGTH_MAX] = "no reason given";
};

[[noreturn]] void remember_error(j_common_ptr jpeg) {
    JpegReading& reading = *static_cast<JpegReading*>(jpeg->client_data);
    jpeg->err->format_message(jpeg, reading.reason);
    std::longjmp(reading.leave, 1);
}

// Of data that is damaged: it goes on with what it has.
void leave_warning(j_common_ptr, int) {}

boolean say_cut(j_decompress_ptr jpeg) {
    static_cast<JpegReading*>(jpeg->client_data)->cut = true;
    ERREXIT(jpeg, JERR_INPUT_EOF);
    return FALSE;
}

bool read_header(JpegReading& reading, std::span<const std::byte> bytes) {
    reading.jpeg.err = jpeg_std_error(&reading.errors);
    reading.jpeg.client_data = &reading;
    reading.errors.error_exit = remember_error;
    reading.errors.emit_message = leave_warning;
    if (setjmp(reading.leave)) return false;
    jpeg_create_decompress(&reading.jpeg);
    jpeg_mem_src(&reading.jpeg, reinterpret_cast<const unsigned char*>(bytes.data()),
                 static_cast<unsigned long>(bytes.size()));
    reading.jpeg.src->fill_input_buffer = say_cut;
    jpeg_read_header(&reading.jpeg, TRUE);
    return true;
}

bool read_rows(JpegReading& reading, std::byte* to, std::size_t row_bytes) {
    if (setjmp(reading.leave)) return false;
    jpeg_start_decompress(&reading.jpeg);
    while (reading.jpeg.output_scanline < reading.jpeg.output_height) {
        JSAMPROW row = reinterpret_cast<JSAMPROW>(to + reading.jpeg.output_scanline * row_bytes);
        jpeg_read_scanlines(&reading.jpeg, &row, 1);
    }
    jpeg_finish_decompress(&reading.jpeg);
    return true;
}

bool is_plain(const jpeg_decompress_struct& jpeg) {
    return jpeg.data_precision == 8 &&
           (jpeg.jpeg_color_space == JCS_GRAYSCALE || jpeg.jpeg_color_space == JCS_YCbCr ||
            jpeg.jpeg_color_space == JCS_RGB);
}

}  // namespace

Result<std::optional<Image>> read_jpeg(std::span<const std::byte> bytes, ImageChannels channels,
                                       const std::string& place) {
    JpegReading reading;
    const auto broken = [&] {
        if (reading.cut)
            return Error{ErrorCode::syntax,
                         "the image is truncated: the file ends before the picture does; copy or "
                         "export it again",
                         place};
        return Error{ErrorCode::syntax,
                     std::string("the image cannot be decoded: ") + reading.reason, place};
    };
    if (!read_header(reading, bytes)) return broken();
    if (!is_plain(reading.jpeg)) return std::optional<Image>();
    const bool gray = reading.jpeg.jpeg_color_space == JCS_GRAYSCALE;
    Image image;
    image.width = reading.jpeg.image_width;
    image.height = reading.jpeg.image_height;
    image.channels = gray ? 1 : 3;
    image.integer_bits = 8;
    image.srgb = true;
    if (channels == ImageChannels::all)
        image.channel_names =
            gray ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
    if (auto held = check_extent(image.width, image.height, place); !held) return held.error();
    if (auto told = check_promise(image, bytes.size(), place); !told) return told.error();
    image.pixels.resize(std::size_t(image.width) * image.height * image.channels);
    if (!read_rows(reading, place_of_levels(image, 1), std::size_t(image.width) * image.channels))
        return broken();
    spread_levels<std::uint8_t>(image);
    return std::optional<Image>(std::move(image));
}

}  // namespace prep::detail
