#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <fstream>
#include <memory>
#include <string_view>

#include "base/own_directory.h"
#include "image/levels.h"
#include "image/openimageio/backend_parts.h"
#include "image/openimageio/completeness.h"
#include "image/picture_kind.h"
#include "image/picture_limits.h"
#include "prep/files.h"
#include "prep/image.h"

namespace prep {
namespace {

namespace oiio = OIIO;

// How much larger than the part of it that a file holds a picture may be; of up to a gigabyte it
// may be anything.
constexpr std::uint64_t largest_margin = 64;

std::string reason_of(const std::string& from_reader) {
    std::string reason = from_reader.empty() ? oiio::geterror() : from_reader;
    while (!reason.empty() && std::isspace(static_cast<unsigned char>(reason.back())))
        reason.pop_back();
    // Several messages come as several lines.
    for (std::size_t at; (at = reason.find_first_of("\r\n")) != std::string::npos;) {
        const std::size_t end = reason.find_first_not_of("\r\n", at);
        reason.replace(at, end - at, "; ");
    }
    return reason.empty() ? "no reason given" : reason;
}

// Still pictures only: the library also opens movies, volumes and pictures that exist in name only.
// PNG is read elsewhere (image/png). Not IFF: its reader ends the process on damaged files (27 of
// 1,000 altered ones, OpenImageIO 2.4.7).
constexpr std::string_view known_formats[] = {
    "jpeg", "openexr",   "hdr",      "gif",  "webp", "dds",   "bmp",
    "tiff", "targa",     "pnm",      "psd",  "sgi",  "rla",   "cineon",
    "dpx",  "softimage", "jpeg2000", "heif", "ico",  "zfile", "fits"};

constexpr int most_channels = 32;  // as Image::integer_channels has bits

// The size of the picture: that of EXR's display window, of which a file may hold a part. What
// other formats say of places on a page is not about the picture.
struct Extent {
    std::int64_t x = 0, y = 0, width = 0, height = 0;
};
Extent extent_of(const oiio::ImageInput& input, const oiio::ImageSpec& spec) {
    if (std::string_view(input.format_name()) == "openexr")
        return {spec.full_x, spec.full_y, spec.full_width, spec.full_height};
    return {spec.x, spec.y, spec.width, spec.height};
}

Result<void> check_spec(const oiio::ImageSpec& spec, const Extent& full, std::uint64_t count,
                        std::uint64_t file_bytes, const std::string& place) {
    if (spec.deep)
        return Error{ErrorCode::unsupported,
                     "this is a deep image; flatten it before using it as a texture", place};
    if (spec.width <= 0 || spec.height <= 0 || full.width <= 0 || full.height <= 0 ||
        spec.nchannels <= 0)
        return Error{ErrorCode::invalid, "the image is empty", place};
    if (spec.depth > 1)
        return Error{ErrorCode::unsupported, "this is a volume image; a flat one is needed", place};
    if (auto held = detail::check_extent(spec.width, spec.height, place); !held) return held;
    if (auto shown = detail::check_extent(full.width, full.height, place); !shown) return shown;
    const auto width = std::uint64_t(spec.width), height = std::uint64_t(spec.height);
    if (auto promise = detail::check_promise(width, height, count, file_bytes, place); !promise)
        return promise;
    const std::uint64_t need = detail::bytes_of_pixels(width, height, count);
    const std::uint64_t whole =
        detail::bytes_of_pixels(std::uint64_t(full.width), std::uint64_t(full.height), count);
    if (whole > 4 * detail::always_allowed_bytes && whole / largest_margin > need)
        return Error{ErrorCode::limit,
                     "the image is " + std::to_string(full.width) + " x " +
                         std::to_string(full.height) + " pixels, of which the file holds " +
                         std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                         "; crop it to them",
                     place};
    return {};
}

bool says_srgb(const oiio::ImageSpec& spec) {
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    if (!space.empty()) return space == "sRGB";
    // Pictures of 8 bits are sRGB unless something says otherwise; floats are linear.
    return spec.format == oiio::TypeDesc::UINT8;
}

// Floats hold 24 bits of an integer; numbers that name things need all 32.
bool read_integers(oiio::ImageInput& input, Image& image) {
    if (std::string_view(input.format_name()) != "openexr") return true;
    const oiio::ImageSpec& spec = input.spec();
    for (std::uint32_t k = 0; k < image.channels; ++k) {
        if (spec.channelformat(int(k)) != oiio::TypeDesc::UINT32) continue;
        image.integer_channels |= 1u << k;
        image.integers.resize(image.pixels.size());
        const auto stride = oiio::stride_t(image.channels * sizeof(std::uint32_t));
        if (!input.read_image(0, 0, int(k), int(k) + 1, oiio::TypeDesc::UINT32,
                              image.integers.data() + k, stride))
            return false;
    }
    return true;
}

// OpenImageIO 2.4 multiplies the colours of WebP pictures by their alpha, whatever is asked for. It
// does so in 8 bits: half a level of error becomes 128 / alpha levels. Later readers that heed the
// wish say so in the spec.
void straighten(const oiio::ImageInput& input, Image& image) {
    if (std::string_view(input.format_name()) != "webp" || image.channels != 4 ||
        input.spec().get_int_attribute("oiio:UnassociatedAlpha") != 0)
        return;
    for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
        const float alpha = image.pixels[i + 3];
        if (!(alpha > 0)) continue;
        for (std::size_t k = 0; k < 3; ++k)
            image.pixels[i + k] = std::min(image.pixels[i + k] / alpha, 1.0f);
    }
}

// The channels' values as the file has them, which OpenImageIO 2.4 reads into their place where no
// type is asked for; else by way of 64 MB, however small the picture.
template <class Value>
bool read_own(oiio::ImageInput& input, const Image& image, void* to) {
    const oiio::ImageSpec& spec = input.spec();
    const oiio::TypeDesc type(oiio::BaseTypeFromC<Value>::value);
    const bool own = spec.format == type && spec.channelformats.empty();
    return input.read_image(0, 0, 0, int(image.channels), own ? oiio::TypeDesc::UNKNOWN : type, to);
}

template <class Level>
bool read_levels(oiio::ImageInput& input, Image& image) {
    if (!read_own<Level>(input, image, detail::place_of_levels(image, sizeof(Level)))) return false;
    detail::spread_levels<Level>(image);
    return true;
}

bool read_values(oiio::ImageInput& input, Image& image) {
    if (image.integer_bits == 8) return read_levels<std::uint8_t>(input, image);
    if (image.integer_bits == 16) return read_levels<std::uint16_t>(input, image);
    return read_own<float>(input, image, image.pixels.data());
}

// What the file does not hold of its picture is 0; what it holds beyond it is left out.
template <class T>
void fit_to_picture(const oiio::ImageSpec& spec, const Extent& full, std::size_t channels,
                    std::vector<T>& values) {
    if (values.empty()) return;
    std::vector<T> placed(std::size_t(full.width * full.height) * channels);
    const std::int64_t x = std::int64_t(spec.x) - full.x, y = std::int64_t(spec.y) - full.y;
    const std::int64_t left = std::max(x, std::int64_t(0));
    const std::int64_t right = std::min(x + spec.width, full.width);
    const std::int64_t bottom = std::min(y + spec.height, full.height);
    for (std::int64_t row = std::max(y, std::int64_t(0)); left < right && row < bottom; ++row) {
        const auto from = std::size_t((row - y) * spec.width + (left - x)) * channels;
        std::copy_n(&values[from], std::size_t(right - left) * channels,
                    &placed[std::size_t(row * full.width + left) * channels]);
    }
    values = std::move(placed);
}

Result<void> check_complete(const detail::ByteSource& file, const std::string& place) {
    const std::string missing = detail::missing_part(file);
    if (missing.empty()) return {};
    return Error{ErrorCode::syntax,
                 "the image is truncated: " + missing + "; copy or export it again", place};
}

Result<void> check_complete(const std::filesystem::path& path, std::uint64_t size,
                            const std::string& place) {
    std::ifstream in(path, std::ios::binary);
    detail::ByteSource file;
    file.size = size;
    file.read = [&in](std::uint64_t offset, std::span<std::byte> out) {
        in.seekg(std::streamoff(offset));
        in.read(reinterpret_cast<char*>(out.data()), std::streamsize(out.size()));
        return bool(in);
    };
    return check_complete(file, place);
}

Result<void> check_complete(std::span<const std::byte> bytes, const std::string& place) {
    detail::ByteSource file;
    file.size = bytes.size();
    file.read = [bytes](std::uint64_t offset, std::span<std::byte> out) {
        std::memcpy(out.data(), bytes.data() + offset, out.size());
        return true;
    };
    return check_complete(file, place);
}

Result<Image> read(oiio::ImageInput& input, ImageChannels channels, std::uint64_t file_bytes,
                   const std::string& place) {
    const oiio::ImageSpec& spec = input.spec();
    const bool all = channels == ImageChannels::all;
    if (all && spec.nchannels > most_channels)
        return Error{ErrorCode::limit,
                     "the image has " + std::to_string(spec.nchannels) + " channels, at most " +
                         std::to_string(most_channels) + " are read",
                     place};
    const int count = all ? spec.nchannels : std::min(spec.nchannels, 4);
    const Extent full = extent_of(input, spec);
    if (auto checked = check_spec(spec, full, std::uint64_t(std::max(count, 0)), file_bytes, place);
        !checked)
        return checked.error();
    Image image;
    image.width = std::uint32_t(spec.width);
    image.height = std::uint32_t(spec.height);
    image.channels = std::uint32_t(count);
    if (all) image.channel_names = spec.channelnames;
    image.srgb = says_srgb(spec);
    image.floating = spec.format.is_floating_point();
    if (spec.format == oiio::TypeDesc::UINT8) image.integer_bits = 8;
    if (spec.format == oiio::TypeDesc::UINT16) image.integer_bits = 16;
    image.pixels.resize(std::size_t(image.width) * image.height * image.channels);
    if (!read_values(input, image))
        return Error{ErrorCode::syntax,
                     "the image cannot be decoded: " + reason_of(input.geterror()), place};
    straighten(input, image);
    if (!read_integers(input, image))
        return Error{ErrorCode::syntax,
                     "the image cannot be decoded: " + reason_of(input.geterror()), place};
    if (full.x != spec.x || full.y != spec.y || full.width != spec.width ||
        full.height != spec.height) {
        fit_to_picture(spec, full, image.channels, image.pixels);
        fit_to_picture(spec, full, image.channels, image.integers);
        image.width = std::uint32_t(full.width);
        image.height = std::uint32_t(full.height);
    }
    input.close();
    return image;
}

// Alpha stays apart from colour: textures filter and blend it themselves.
oiio::ImageSpec reading_options() {
    oiio::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    return config;
}

bool is_known(const oiio::ImageInput& input) {
    return std::find(std::begin(known_formats), std::end(known_formats), input.format_name()) !=
           std::end(known_formats);
}

Error not_an_image(const std::string& why, const std::string& place) {
    return {ErrorCode::syntax, "no image format recognises this file: " + why, place};
}

// The reader of a format alone, given by an ending: ImageInput::open() tries all of them, and some
// end the process.
std::unique_ptr<oiio::ImageInput> open_as(std::string_view format, const std::string& place,
                                          const oiio::ImageSpec& config, std::string& reason) {
    auto input = oiio::ImageInput::create(std::string(format), false);
    oiio::ImageSpec spec;
    if (input && input->open(place, spec, config)) return input;
    reason = reason_of(input ? input->geterror() : std::string());
    return nullptr;
}

Result<Image> decode(std::span<const std::byte> bytes, const std::string& name,
                     std::string_view format) {
    if (bytes.empty()) return Error{ErrorCode::syntax, "the image has no bytes", name};
    if (auto complete = check_complete(bytes, name); !complete) return complete.error();
    // Only the ending matters to the library: nothing is looked up on the disk.
    std::string ending = std::filesystem::path(name).extension().string();
    if (const std::string_view sniffed = detail::picture_kind(bytes); !sniffed.empty())
        ending = std::string(".").append(sniffed);
    if (ending.empty())
        return Error{ErrorCode::unsupported,
                     "the image's format is not recognised from its first bytes, and its name has "
                     "no ending",
                     name};
    const std::string stand_in = "memory" + ending;
    const oiio::ImageSpec config = reading_options();
    oiio::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes.data()), bytes.size());
    // By the format's name the library asks no other decoder.
    auto input = format.empty() ? oiio::ImageInput::create(stand_in, false, nullptr, &memory)
                                : oiio::ImageInput::create(std::string(format), false);
    if (!input) return not_an_image(reason_of({}), name);
    if (!is_known(*input))
        return Error{ErrorCode::unsupported,
                     std::string("images of the format '") + input->format_name() +
                         "' are not read; convert it to PNG or EXR",
                     name};
    if (!input->supports("ioproxy")) {
        // A few readers only take files.
        const detail::OwnDirectory own;
        if (own.path().empty()) return detail::no_own_directory(name);
        const std::filesystem::path file = own.path() / ("picture" + ending);
        if (auto written = write_file(file, bytes); !written) return written.error();
        auto image = detail::read_picture_file(file, ImageChannels::color, format);
        if (!image) image.error().place = name;
        return image;
    }
    oiio::ImageSpec spec;
    input->set_ioproxy(&memory);
    if (!input->open(stand_in, spec, config))
        return Error{ErrorCode::syntax,
                     "the image cannot be decoded: " + reason_of(input->geterror()), name};
    return read(*input, ImageChannels::color, bytes.size(), name);
}

}  // namespace

Result<Image> detail::read_picture_bytes(std::span<const std::byte> bytes, const std::string& name,
                                         std::string_view format) {
    return detail::guarded(ErrorCode::syntax, name,
                           [&]() -> Result<Image> { return decode(bytes, name, format); });
}

Result<Image> detail::read_picture_file(const std::filesystem::path& path, ImageChannels channels,
                                        std::string_view format) {
    const std::string place = path.string();
    return detail::guarded(ErrorCode::syntax, place, [&]() -> Result<Image> {
        std::error_code error;
        const auto status = std::filesystem::status(path, error);
        if (!std::filesystem::exists(status))
            return Error{ErrorCode::io, "the image file does not exist", place};
        if (!std::filesystem::is_regular_file(status))
            return Error{ErrorCode::io, "this is not a file; an image file is needed", place};
        const std::uint64_t size = std::filesystem::file_size(path, error);
        if (error) return Error{ErrorCode::io, "cannot read the file: " + error.message(), place};
        if (auto complete = check_complete(path, size, place); !complete) return complete.error();
        const oiio::ImageSpec config = reading_options();
        std::string reason;
        auto input = format.empty() ? oiio::ImageInput::open(place, &config)
                                    : open_as(format, place, config, reason);
        if (!input) return not_an_image(format.empty() ? reason_of({}) : reason, place);
        if (!is_known(*input))
            return Error{ErrorCode::unsupported,
                         std::string("images of the format '") + input->format_name() +
                             "' are not read; convert it to PNG or EXR",
                         place};
        return read(*input, channels, size, place);
    });
}

}  // namespace prep
