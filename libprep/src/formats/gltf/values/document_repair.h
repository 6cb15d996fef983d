// What glTF forbids in the parts of a document that are written as the file had them.
#pragma once

#include <string>
#include <vector>

#include "formats/gltf/appended_data.h"
#include "formats/gltf/document.h"

namespace prep::detail {

// A note for each kind of what is repaired:
// - Bounds of accessors that say other than the values, and those that positions and times of
//   animations lack, are computed.
// - Vertex data whose elements do not lie at multiples of 4 bytes, or that shares a view without
//   saying its stride, gets a stride, or views of its own (no matrices; up to four times the
//   input's bytes, as accessors may name the same ones again and again).
// - Extensions that are used and not declared are declared; KHR_mesh_quantization as well, where
//   vertex data has types that it allows.
// Of what Draco holds nothing is looked at; of what EXT_meshopt_compression holds bounds alone; who
// compresses declares both. After check_structure() and all that changes references, before
// pack_buffer(). O(values of the file's own accessors that are still referred to).
void repair_document(const GltfDocument& document, Json& json, AppendedData& appended,
                     std::vector<std::string>& notes);

}  // namespace prep::detail
