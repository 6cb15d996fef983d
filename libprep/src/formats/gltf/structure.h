// Checks on a glTF document that need no vertex data: every bufferView and accessor, used or not.
#pragma once

#include "formats/gltf/document.h"

namespace prep::detail {

// Members present and of their types, references in range, every accessor inside its bufferView and
// every bufferView inside its buffer (by declared lengths, in 64 bit), alignment to the component,
// sparse parts; the indices of sparse accessors are decoded and checked too. Accessors without a
// bufferView cost the file nothing: each may stand for 256 MiB of zeros, together for 4 GiB.
// Compressed views may together decompress to 64 times the file, the most that the codecs reach.
// Errors: invalid, limit; whatever decoding a sparse part gives.
Result<void> check_structure(const GltfDocument& document);

}  // namespace prep::detail
