// A prepared scene as the bytes of a GLB file.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/binary_parts.h"
#include "prep/prepared_scene.h"
#include "prep/result.h"
#include "prep/save.h"

namespace prep::detail {

struct GlbFile {
    std::vector<std::byte> head;  // of the file and of the JSON chunk
    std::string json;
    std::vector<std::byte> binary_head;
    BinaryParts binary;  // in part the prepared scene's own arrays
    // The file, in order; refers to this object.
    std::vector<std::span<const std::byte>> parts() const;
};

// The scene must outlive the result. Errors: limit (over 4 GiB), and those of rewrite_gltf().
// Of the options: how values are stored.
Result<GlbFile> encode_glb(const PreparedScene& prepared, std::vector<std::string>& notes,
                           const SaveOptions& options = {});

}  // namespace prep::detail
