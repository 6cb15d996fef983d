// A prepared scene as the bytes of a GLB file.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "prep/prepared_scene.h"
#include "prep/result.h"
#include "prep/save.h"

namespace prep::detail {

struct GlbFile {
    std::vector<std::byte> head;  // of the file and of the JSON chunk
    std::string json;
    std::vector<std::byte> binary_head, binary;
    // The file, in order; refers to this object.
    std::array<std::span<const std::byte>, 4> parts() const;
};

// Errors: limit (over 4 GiB), and those of rewrite_gltf().
Result<GlbFile> encode_glb(const PreparedScene& prepared, std::vector<std::string>& notes,
                           Compression compression = Compression::keep);

}  // namespace prep::detail
