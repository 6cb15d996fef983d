// What the image library of this project (libprep/images, loaded when a picture is first read or
// written) offers to libprep. Both sides come from one build.
#pragma once

#include "prep/image.h"

namespace prep::detail {

struct ImageBackend {
    Result<Image> (*load)(const std::filesystem::path&);
    Result<Image> (*decode)(std::span<const std::byte>, const std::string&);
    Result<std::vector<std::byte>> (*encode)(const std::filesystem::path&, const Image&, PixelType);
    Result<std::vector<std::byte>> (*encode_png)(const Image&, PixelType);
};

// The library exports this function under the name `image_backend_name`; it carries the version.
using ImageBackendFunction = const ImageBackend* (*)();

}  // namespace prep::detail
