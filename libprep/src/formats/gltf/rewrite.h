// Writing a glTF document back: only the prepared attributes change.
#pragma once

#include <string>
#include <vector>

#include "formats/gltf/compression/compress.h"
#include "formats/gltf/document.h"
#include "prep/prepare.h"
#include "prep/save.h"

namespace prep::detail {

struct RewrittenGltf {
    Json json;
    PackedBuffer packed;
    CompressionPlan plan;  // what is still to be compressed as it was
};

// Triangle primitives get the split vertices: every attribute and morph target is gathered through
// the way back to its source vertex, in its own component type; NORMAL and TANGENT come from
// prepare() as floats. All other members of the document stay as they are. Accessors and
// bufferViews that nothing refers to any more are dropped, unless an extension is in use whose
// references are not known here: then all are kept.
//
// With Compression::keep, what stays as it is stays compressed, byte for byte; what changes is
// compressed as it was: by meshopt here, filters' input gathered like any other values, so that
// nothing is rounded twice; by Draco by the plan.
Result<RewrittenGltf> rewrite_gltf(const PreparedScene& prepared, Compression compression,
                                   std::vector<std::string>& notes);

}  // namespace prep::detail
