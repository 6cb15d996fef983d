// Pictures as the bytes of a file. Writing them is libprep's, as of every other output.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "image/image_backend.h"
#include "prep/image.h"

namespace prep::detail {

// The format is that of the path's ending. Errors: limit, unsupported, io.
Result<std::vector<std::byte>> encode_image(const std::filesystem::path& path, const Image& image,
                                            PixelType type);

// See ImageBackend::open_rows. Errors: those of ImageFiles::open().
Result<std::unique_ptr<RowWriter>> open_rows(const std::filesystem::path& path,
                                             const std::filesystem::path& file,
                                             const ImageLayout& layout);

}  // namespace prep::detail
