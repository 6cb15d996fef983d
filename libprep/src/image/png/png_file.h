// PNG in and out, by libpng: nearly every picture of a glTF file, and nearly every one that is
// drawn. OpenImageIO would do it as well, after it has loaded 250 libraries.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "image/image_backend.h"
#include "image/picture_source.h"
#include "prep/image.h"

namespace prep::detail {

// Values, channels, names and `srgb` as of the file: palettes as colours, transparent colours as
// alpha, 1, 2 and 4 bits as 8. It says sRGB where its chunk sRGB or nothing does, and not where
// only gAMA tells of a curve. `place` is for messages. Errors: syntax, invalid (a header that
// promises what no file of that size holds), limit.
Result<Image> read_png(PictureSource& source, ImageChannels channels, const std::string& place);

// Whether files of that name are written here.
bool is_png_name(const std::filesystem::path& path);
// What was checked (picture_checks.h), as u8 or u16. Errors: io.
Result<std::vector<std::byte>> png_bytes(const Image& image, PixelType type,
                                         const std::string& place);
// As ImageBackend::open_rows. Errors: io, unsupported (channels).
Result<std::unique_ptr<RowWriter>> open_png_rows(const std::filesystem::path& path,
                                                 const std::filesystem::path& file,
                                                 const ImageLayout& layout);

}  // namespace prep::detail
