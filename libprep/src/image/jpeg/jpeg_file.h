// JPEG in, by libjpeg: most pictures of glTF files that are no PNG. OpenImageIO, which writes them,
// would read them as well, after it has loaded 250 libraries.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "prep/image.h"

namespace prep::detail {

// Nothing where the picture is of another kind than grey or coloured with 8 bits a channel: CMYK is
// left to OpenImageIO. `place` is for messages. Errors: syntax (cut short, too), invalid (a header
// that promises what no file of that size holds), limit.
Result<std::optional<Image>> read_jpeg(std::span<const std::byte> bytes, ImageChannels channels,
                                       const std::string& place);

}  // namespace prep::detail
