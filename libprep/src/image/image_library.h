// The library that reads and writes pictures, loaded when first asked for.
#pragma once

#include <string_view>

#include "image/image_backend.h"

namespace prep::detail {

// Errors: io (it is not there, or is another build's).
const Result<const ImageBackend*>& image_backend();

// Pictures decoded in this process. Errors: those of load_image() and decode_image().
Result<Image> load_picture(const std::filesystem::path& path, ImageChannels channels,
                           std::string_view format = {});
Result<Image> decode_picture(std::span<const std::byte> bytes, const std::string& name,
                             std::string_view format = {});

}  // namespace prep::detail
