#include "image/openimageio/output_format.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string_view>

#include "completeness.h"
#include "prep/image.h"
#include "text/lower_case.h"

namespace prep::detail {

Result<std::unique_ptr<OIIO::ImageOutput>> output_for(const std::filesystem::path& path,
                                                      std::string& ending) {
    ending = lower_case(path.extension().string());
    auto output = OIIO::ImageOutput::create("memory" + ending);
    if (!output) {
        (void)OIIO::geterror();
        return Error{ErrorCode::unsupported,
                     "this OpenImageIO has no writer for '" + ending + "'; use .png, .jpg or .exr",
                     path.string()};
    }
    return output;
}

Result<void> check_shape(const std::string& ending, std::uint32_t width, std::uint32_t height,
                         std::size_t channels, const std::string& place) {
    struct Shape {
        std::string_view ending, channels;
        std::uint32_t largest;
    };
    constexpr std::uint32_t any = max_image_extent;
    constexpr Shape shapes[] = {{".webp", "3 or 4", 16383}, {".hdr", "3", any},
                                {".bmp", "1, 3 or 4", any}, {".ppm", "1 or 3", any},
                                {".pnm", "1 or 3", any},    {".pgm", "1 or 3", any}};
    for (const Shape& shape : shapes) {
        if (shape.ending != ending) continue;
        if (shape.channels.find(std::to_string(channels)) == std::string_view::npos)
            return Error{ErrorCode::unsupported,
                         "files of the ending '" + ending + "' have " +
                             std::string(shape.channels) + " channels, not " +
                             std::to_string(channels) + "; use .png or .exr",
                         place};
        if (std::max(width, height) > shape.largest)
            return Error{ErrorCode::limit,
                         "files of the ending '" + ending + "' have at most " +
                             std::to_string(shape.largest) +
                             " pixels in one direction; use .png or .exr",
                         place};
    }
    return {};
}

bool takes_proxies(const OIIO::ImageOutput& output, const std::string& ending) {
    return output.supports("ioproxy") && ending != ".tif" && ending != ".tiff";
}

Result<void> check_written(const std::filesystem::path& file, const std::string& place) {
    std::error_code error;
    std::ifstream in(file, std::ios::binary);
    ByteSource source;
    source.size = std::filesystem::file_size(file, error);
    source.read = [&in](std::uint64_t offset, std::span<std::byte> out) {
        in.seekg(std::streamoff(offset));
        in.read(reinterpret_cast<char*>(out.data()), std::streamsize(out.size()));
        return bool(in);
    };
    const std::string missing = error ? error.message() : missing_part_of_written_tiff(source);
    if (missing.empty()) return {};
    return Error{ErrorCode::io,
                 "the image cannot be written: " + missing + "; the disk may be full", place};
}

void set_options(OIIO::ImageSpec& spec, const std::string& ending) {
    for (const char* dated : {".exr", ".tif", ".tiff"})
        if (ending == dated) spec.attribute("DateTime", "1970:01:01 00:00:00");
}

}  // namespace prep::detail
