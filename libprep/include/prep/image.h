// Images in and out (libpng, libjpeg and OpenImageIO behind the wall), as float or 8-bit pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "prep/result.h"

namespace prep {

struct ImageRef;
class ReaderProcess;

// Row-major, top row first, `channels` interleaved (1 to 4), values as stored in the file: 8- and
// 16-bit integers mapped to 0…1, floats as they are. No colour conversion.
struct Image {
    std::uint32_t width = 0, height = 0, channels = 0;
    std::vector<float> pixels;
    bool srgb =
        false;  // the file says (or its format implies) that colour channels are sRGB-encoded
    // EXR channels of 32-bit integers (IDs): bit k stands for channel k, and `integers`, of the
    // same layout as `pixels`, holds their values (0 in other channels); it is empty where there
    // are none. `pixels` has them divided by 2³² − 1 and rounded.
    std::uint32_t integer_channels = 0;
    std::vector<std::uint32_t> integers = {};
    bool floating = false;  // stored as floats: linear light, whatever it is used for
    std::vector<std::string> channel_names = {};  // where all channels were asked for
    // 8 or 16 where the file has integers of as many bits (8 also for fewer), else 0: `pixels` are
    // then codes over 255 or 65535.
    std::uint8_t integer_bits = 0;
    const float* at(std::uint32_t x, std::uint32_t y) const {
        return pixels.data() + (std::size_t(y) * width + x) * channels;
    }
};

// Largest image that is read: 32768² pixels. More gives ErrorCode::limit.
inline constexpr std::uint32_t max_image_extent = 32768;

// The first four channels, or all of those that EXR and TIFF files may have, 32 at most.
enum class ImageChannels : std::uint8_t { color, all };

struct ImageOptions {
    ImageChannels channels = ImageChannels::color;
    // Where pictures are decoded whose decoders may end the process (load.h): all but PNG, JPEG,
    // EXR, HDR, GIF, WebP, BMP, TIFF, TGA and PNM. Null: here. The result is the same.
    std::shared_ptr<ReaderProcess> reader_process = nullptr;
    // What such a decoder printed, as LoadOptions::reader_log has it.
    std::function<void(const std::filesystem::path& file, std::string_view text)> reader_log = {};
};

// PNG, JPEG, and any other format OpenImageIO reads. Errors: io (missing, unreadable), syntax
// (broken), limit; with a process of its own also unsupported (the decoder crashed) and limit (its
// time, its memory).
Result<Image> load_image(const std::filesystem::path& path,
                         ImageChannels channels = ImageChannels::color);
Result<Image> load_image(const std::filesystem::path& path, const ImageOptions& options);
// From memory; `name` is for messages and, by its ending, a hint at the format. Errors: also
// unsupported (KTX2).
Result<Image> decode_image(std::span<const std::byte> bytes, const std::string& name,
                           const ImageOptions& options = {});
// From the path or the embedded bytes, as the reference's own options say.
Result<Image> load_image(const ImageRef& ref);

// Loads the library that reads and writes pictures other than PNG, and JPEG with four channels or
// as output, ahead of the first one: it takes longer than a small picture does. Errors: io.
Result<void> load_image_library();

enum class PixelType : std::uint8_t { u8, u16, f16, f32 };

// Whether files of this name's ending are pictures. What is in a file, its bytes say.
bool is_image_name(const std::filesystem::path& path);
// Whether pictures of this name's ending are written. Errors: unsupported (it says what is).
Result<void> check_writable_image(const std::filesystem::path& path);
// Whether they may have channels of this very type. JPEG and WebP lose something of their 8 bits;
// HDR's f32 is RGBE, whose channels share an exponent and have 8 bits each.
bool image_holds(const std::filesystem::path& path, PixelType type);
// The narrowest type that they have and that loses nothing of `type`. Errors: unsupported (none,
// or an ending that is not written).
Result<PixelType> stored_type(const std::filesystem::path& path, PixelType type);

// Writes `pixels` as they are (encode sRGB before). The format follows the ending: png, jpg, exr, …
// Channels are of stored_type(). Errors: unsupported, invalid (an empty picture), limit, io.
// The file appears complete or not at all (temporary name, then rename).
Result<void> save_image(const std::filesystem::path& path, const Image& image,
                        PixelType type = PixelType::u8);
// A picture that is written row by row.
struct ImageLayout {
    std::uint32_t width = 0, height = 0;
    std::vector<std::string> channels;  // names, as "R", "N.X"; more than 4 only where the format
                                        // holds them (EXR, TIFF)
    PixelType type = PixelType::u8;
    std::vector<bool> integer;  // f32 only, per channel: 32-bit integers instead; empty: none is
    bool srgb = false;          // what the file says of its colours; nothing is converted
};

// Files of pictures that appear together, complete, when all of them are, or not at all.
// A file that holds rows as they come needs no more memory than the rows it is given.
class ImageFiles {
  public:
    struct Rules {
        bool replace = true;                       // files that exist may be replaced
        std::vector<std::filesystem::path> spare;  // but never these
    };
    ImageFiles();
    explicit ImageFiles(Rules rules);
    ~ImageFiles();  // what was not committed leaves no trace
    ImageFiles(const ImageFiles&) = delete;
    ImageFiles& operator=(const ImageFiles&) = delete;

    // Starts a file; the format follows the ending. The number is for write_rows().
    // Errors: invalid (no extent), limit, unsupported (the ending, or its channels), io.
    Result<std::size_t> open(const std::filesystem::path& path, const ImageLayout& layout);
    // The next rows, whole ones, top to bottom, channels interleaved; integers of u8 and u16 files
    // are rounded from 0…1. The second form is for files with integer channels: every value as its
    // 32 bits. Errors: io, invalid (not whole rows, or too many).
    Result<void> write_rows(std::size_t file, std::span<const float> values);
    Result<void> write_rows(std::size_t file, std::span<const std::uint32_t> words);
    // Errors: io, invalid (rows are missing); then nothing has changed.
    Result<void> commit();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// PNG in memory, for pages that embed their pictures. Deterministic: no time, no host in it.
Result<std::vector<std::byte>> encode_png(const Image& image, PixelType type = PixelType::u8);

}  // namespace prep
