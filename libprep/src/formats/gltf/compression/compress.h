// A glTF document that is about to be written, made smaller: its primitives by Draco, or its
// bufferViews by meshopt.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "formats/gltf/appended_data.h"
#include "formats/gltf/compression/draco_encode.h"
#include "formats/gltf/compression/meshopt_encode.h"
#include "formats/gltf/document.h"
#include "formats/gltf/references.h"

namespace prep::detail {

struct CompressionPlan {
    bool draco = false;      // every primitive of triangles
    bool meshopt = false;    // every bufferView but pictures
    bool optimized = false;  // there is a note where Draco does not keep the order
    // Those that came by Draco, by mesh and primitive, with what is to be kept of how they came.
    std::map<std::pair<std::size_t, std::size_t>, DracoCoding> kept_draco;
    bool nothing() const { return !draco && !meshopt && kept_draco.empty(); }
};

// Whatever is compressed already stays so. What a codec cannot hold stays as it is, with a note.
// Values by Draco are exact but where `kept_draco` says how they came. Vertices are put in another
// order only where nothing beside the primitive's own attributes and indices numbers them.
// Errors: those of GltfDocument::view.
Result<PackedBuffer> compress_gltf(Json& json, PackedBuffer packed, const CompressionPlan& plan,
                                   std::vector<std::string>& notes);

// Stores a view of the document by meshopt. Whether it could be.
bool compress_view(Json& json, AppendedData& appended, std::size_t view, MeshoptMode mode,
                   std::size_t stride, std::span<const std::byte> bytes,
                   const std::string& filter = "NONE");

// Puts the extensions of compression that the document uses into its lists; those that it no longer
// uses are taken out.
void declare_compression(Json& json);

// The document's "buffers": the one that there is, and the empty one that compressed views stand
// for.
Json buffers_of(std::size_t bytes, std::uint64_t fallback_bytes);

}  // namespace prep::detail
