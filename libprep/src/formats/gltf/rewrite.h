// Writing a glTF document back: only the prepared attributes change.
#pragma once

#include <string>
#include <vector>

#include "formats/gltf/document.h"
#include "prep/prepare.h"

namespace prep::detail {

struct RewrittenGltf {
    Json json;
    std::vector<std::byte> binary;  // the only buffer
};

// Triangle primitives get the split vertices: every attribute and morph target is gathered through
// the way back to its source vertex, in its own component type; NORMAL and TANGENT come from
// prepare() as floats. All other members of the document stay as they are. Accessors and
// bufferViews that nothing refers to any more are dropped, unless an extension is in use whose
// references are not known here: then all are kept.
Result<RewrittenGltf> rewrite_gltf(const PreparedScene& prepared, std::vector<std::string>& notes);

}  // namespace prep::detail
