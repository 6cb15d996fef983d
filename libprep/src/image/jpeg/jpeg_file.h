// JPEG in, by libjpeg: most pictures of glTF files that are no PNG. OpenImageIO, which writes them,
// would read them as well, after it has loaded 250 libraries.
#pragma once

#include <optional>
#include <string>

#include "image/picture_source.h"
#include "prep/image.h"

namespace prep::detail {

// Nothing where the picture is of another kind than grey or coloured with 8 bits a channel: CMYK is
// left to OpenImageIO. `place` is for messages. Errors: syntax (cut short, too), invalid (a header
// that promises what no file of that size holds), limit (of the extent and of scans).
Result<std::optional<Image>> read_jpeg(PictureSource& source, ImageChannels channels,
                                       const std::string& place);

}  // namespace prep::detail
