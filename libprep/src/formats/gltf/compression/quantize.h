// KHR_mesh_quantization, written: the vertices of a glTF document that is about to be written, as
// whole numbers of few bits.
#pragma once

#include <string>
#include <vector>

#include "formats/gltf/document.h"
#include "formats/gltf/references.h"
#include "prep/save.h"

namespace prep::detail {

// Positions lie on a grid of cubes, the same for a whole mesh: its origin is the least corner of
// the mesh's box, 2^bits − 1 steps reach along the longest side. The node that has the mesh gets a
// child that scales and moves them back and has the mesh in its place; skins' inverse bind matrices
// do the same (quantized_nodes.h). Morph targets move by steps of the grid; their normals and
// tangents stay floats. Normals, tangents and UVs are normalised numbers; of fewer bits than their
// type has, the nearest that the type holds. Values that the type does not hold stay floats, with a
// remark: UVs outside 0 … 1, meshes where the grid has no place (instances, lengths of materials,
// extensions that speak of nodes), values that are not finite.
//
// The document's data lie in `packed`, none compressed. `report` gets how far what is written is
// from what was there, as exact numbers have it. `notes` get what the document's own accessors lack
// (pack_buffer). O(values + document). Errors: those of GltfDocument::view.
Result<PackedBuffer> quantize_gltf(Json& json, PackedBuffer packed, const Quantization& bits,
                                   QuantizationReport& report, std::vector<std::string>& notes);

}  // namespace prep::detail
