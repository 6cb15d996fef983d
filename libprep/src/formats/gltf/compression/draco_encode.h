// KHR_draco_mesh_compression, written: how a primitive's data came, and the same way back.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/gltf/document.h"

namespace prep::detail {

// How Draco stores the values of an attribute. Without quantisation every bit stays.
struct DracoValues {
    enum class Form : std::uint8_t { exact, grid, octahedral };
    Form form = Form::exact;
    int bits = 0;
    // Of the grid: its first value on each axis, and the length of all its axes.
    std::vector<float> origin;
    float range = 0;
};

struct DracoCoding {
    // Vertices and triangles in the order in which they were given; else in one that compresses
    // better (Edgebreaker), each triangle beginning with any of its corners.
    bool keeps_order = false;
    std::map<std::string, DracoValues> values;  // by semantic; others are stored exactly
};

// How the data of a primitive that has the extension were made. Errors: those of decode_draco().
Result<DracoCoding> draco_coding(const GltfDocument& document, const Json& primitive,
                                 const std::string& pointer);

struct DracoSource {
    std::vector<std::pair<std::string, RawAccessor>> attributes;  // POSITION among them
    std::vector<std::uint32_t> indices;                           // three to a triangle
};

struct DracoData {
    std::vector<std::byte> bytes;
    std::map<std::string, std::uint32_t> ids;  // by semantic
    // What comes out of the decoder: Edgebreaker joins vertices that are the same in everything.
    std::size_t vertices = 0, triangles = 0;
    bool keeps_order = false;        // that of the source; else it is Edgebreaker's
    std::vector<float> least, most;  // of the positions
};

// Values on a grid that they have left get one of their own, of as many bits. Triangles with two
// corners in one place would be lost to Edgebreaker: a primitive that has any keeps its order.
// None where Draco cannot hold the primitive. Deterministic. O(n log n).
std::optional<DracoData> encode_draco(const DracoSource& source, const DracoCoding& coding);

}  // namespace prep::detail
