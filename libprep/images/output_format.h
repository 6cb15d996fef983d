// The writer that a picture's name asks for.
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <memory>
#include <string>

#include "prep/result.h"

namespace prep::detail {

// By the ending of `path`, which is given back in lower case. Errors: unsupported (no ending, or
// one that no writer knows).
Result<std::unique_ptr<OIIO::ImageOutput>> output_for(const std::filesystem::path& path,
                                                      std::string& ending);

}  // namespace prep::detail
