// jpeglib.h needs what comes before it.
// clang-format off
#include <cstdio>
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include <algorithm>
#include <array>
#include <csetjmp>
#include <new>

#include "image/jpeg/jpeg_file.h"
#include "image/levels.h"
#include "image/picture_limits.h"

namespace prep::detail {
namespace {

// What libjpeg is given and gives. It leaves by longjmp(): functions that call setjmp() have
// nothing with a destructor, and read nothing afterwards that they have changed in between; what
// they fill lives in their callers.
struct JpegReading {
    explicit JpegReading(PictureSource& from) : source(from) {}
    ~JpegReading() { jpeg_destroy_decompress(&jpeg); }
    JpegReading(const JpegReading&) = delete;
    JpegReading& operator=(const JpegReading&) = delete;

    jpeg_decompress_struct jpeg{};
    jpeg_error_mgr errors{};
    PictureSource& source;
    jpeg_source_mgr bytes{};
    std::array<JOCTET, 1 << 16> buffer;
    jpeg_progress_mgr progress{};
    std::jmp_buf leave;
    bool cut = false, scans_too_many = false, out_of_memory = false;
    char reason[JMSG_LENGTH_MAX] = "no reason given";
};

[[noreturn]] void remember_error(j_common_ptr jpeg) {
    JpegReading& reading = *static_cast<JpegReading*>(jpeg->client_data);
    reading.out_of_memory = jpeg->err->msg_code == JERR_OUT_OF_MEMORY;
    jpeg->err->format_message(jpeg, reading.reason);
    std::longjmp(reading.leave, 1);
}

// Of data that is damaged: it goes on with what it has.
void leave_warning(j_common_ptr, int) {}

JpegReading& reading_of(j_decompress_ptr jpeg) {
    return *static_cast<JpegReading*>(jpeg->client_data);
}

void start_bytes(j_decompress_ptr) {}

boolean next_bytes(j_decompress_ptr jpeg) {
    JpegReading& reading = reading_of(jpeg);
    const std::size_t count = reading.source.read(reading.buffer.data(), reading.buffer.size());
    if (count == 0) {
        reading.cut = true;
        ERREXIT(jpeg, JERR_INPUT_EOF);
    }
    reading.bytes.next_input_byte = reading.buffer.data();
    reading.bytes.bytes_in_buffer = count;
    return TRUE;
}

void skip_bytes(j_decompress_ptr jpeg, long count) {
    jpeg_source_mgr& bytes = reading_of(jpeg).bytes;
    while (count > 0) {
        if (bytes.bytes_in_buffer == 0) next_bytes(jpeg);
        const std::size_t some = std::min(bytes.bytes_in_buffer, std::size_t(count));
        bytes.next_input_byte += some;
        bytes.bytes_in_buffer -= some;
        count -= long(some);
    }
}

// A scan that says nothing is ten bytes, and takes the time of the whole picture. Encoders write
// ten scans; what is refined bit by bit, coefficient by coefficient, has some hundreds.
void count_scans(j_common_ptr common) {
    constexpr int most = 500;
    JpegReading& reading = *static_cast<JpegReading*>(common->client_data);
    reading.scans_too_many = reading.jpeg.input_scan_number > most;
    if (reading.scans_too_many) ERREXIT(common, JERR_BAD_PROGRESSION);
}

bool read_header(JpegReading& reading) {
    reading.jpeg.err = jpeg_std_error(&reading.errors);
    reading.jpeg.client_data = &reading;
    reading.errors.error_exit = remember_error;
    reading.errors.emit_message = leave_warning;
    if (setjmp(reading.leave)) return false;
    jpeg_create_decompress(&reading.jpeg);
    reading.bytes.init_source = start_bytes;
    reading.bytes.fill_input_buffer = next_bytes;
    reading.bytes.skip_input_data = skip_bytes;
    reading.bytes.resync_to_restart = jpeg_resync_to_restart;
    reading.bytes.term_source = start_bytes;
    reading.jpeg.src = &reading.bytes;
    reading.progress.progress_monitor = count_scans;
    reading.jpeg.progress = &reading.progress;
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

Result<std::optional<Image>> read_jpeg(PictureSource& source, ImageChannels channels,
                                       const std::string& place) {
    JpegReading reading(source);
    const auto broken = [&] {
        if (reading.out_of_memory) throw std::bad_alloc();
        if (reading.scans_too_many)
            return Error{ErrorCode::limit,
                         "the image has more than 500 scans, which would take long to read; export "
                         "it as a baseline JPEG",
                         place};
        if (reading.cut)
            return Error{ErrorCode::syntax,
                         "the image is truncated: the file ends before the picture does; copy or "
                         "export it again",
                         place};
        return Error{ErrorCode::syntax,
                     std::string("the image cannot be decoded: ") + reading.reason, place};
    };
    if (!read_header(reading)) return broken();
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
    if (auto told = check_promise(image, source.size(), place); !told) return told.error();
    image.pixels.resize(std::size_t(image.width) * image.height * image.channels);
    if (!read_rows(reading, place_of_levels(image, 1), std::size_t(image.width) * image.channels))
        return broken();
    spread_levels<std::uint8_t>(image);
    return std::optional<Image>(std::move(image));
}

}  // namespace prep::detail
