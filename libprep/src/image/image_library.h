// The library that reads and writes pictures, loaded when first asked for.
#pragma once

#include "image/image_backend.h"

namespace prep::detail {

// Errors: unsupported (it is not there, or is another build's).
const Result<const ImageBackend*>& image_backend();

}  // namespace prep::detail
