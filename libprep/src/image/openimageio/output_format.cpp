#include "image/openimageio/output_format.h"

#include <cctype>
#include <fstream>

#include "completeness.h"

namespace prep::detail {

Result<std::unique_ptr<OIIO::ImageOutput>> output_for(const std::filesystem::path& path,
                                                      std::string& ending) {
    ending = path.extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    auto output = OIIO::ImageOutput::create("memory" + ending);
    if (!output) {
        (void)OIIO::geterror();
        return Error{ErrorCode::unsupported,
                     "this OpenImageIO has no writer for '" + ending + "'; use .png, .jpg or .exr",
                     path.string()};
    }
    return output;
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
    // Half the time of zlib's level 6 for a tenth more bytes.
    spec.attribute("png:compressionLevel", 4);
    for (const char* dated : {".exr", ".tif", ".tiff"})
        if (ending == dated) spec.attribute("DateTime", "1970:01:01 00:00:00");
}

}  // namespace prep::detail
