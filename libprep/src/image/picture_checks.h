// What can be a picture's file, whatever its format.
#pragma once

#include <string>

#include "prep/image.h"
#include "prep/result.h"

namespace prep::detail {

// `place` is for messages. Errors: invalid (empty, too many channels, another number of values than
// of the size), limit.
Result<void> check_picture(const Image& image, const std::string& place);
// Errors: invalid (empty, integers beside what is no 32-bit float), limit.
Result<void> check_picture(const ImageLayout& layout, const std::string& place);

}  // namespace prep::detail
