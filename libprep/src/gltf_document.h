// The retained glTF file: its JSON, its buffers, and where each primitive went.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "prep/gltf.h"

namespace prep {

namespace detail {

using Json = nlohmann::ordered_json;

// Elements of an accessor, tightly packed in their own component type, sparse values applied.
struct RawAccessor {
    int component_type = 5126;
    int width = 1;  // components to an element
    bool normalized = false;
    std::size_t count = 0;
    std::vector<std::byte> bytes;
    std::size_t element_size() const;
};

std::size_t component_size(int component_type);  // 0: no such type
int components_of(const std::string& type);      // 0: no such type

// Where one primitive's vertices went in its Mesh.
struct GltfPrimitive {
    std::uint32_t first_vertex = 0, vertex_count = 0;
    bool triangles = false;
    // Attributes (by semantic) that KHR_draco_mesh_compression held; accessors say nothing of them.
    std::map<std::string, RawAccessor> draco;
};

}  // namespace detail

class GltfDocument {
  public:
    detail::Json json;
    std::vector<std::vector<std::byte>> buffers;
    std::filesystem::path directory;
    std::string name;
    std::vector<std::vector<detail::GltfPrimitive>> primitives;  // per mesh

    // "name#/pointer" for messages.
    std::string place(const std::string& pointer) const { return name + "#" + pointer; }

    // The bytes of a bufferView, decompressed if need be; kept for the next call.
    Result<std::span<const std::byte>> view(std::size_t index) const;
    Result<detail::RawAccessor> raw_accessor(std::size_t index) const;

  private:
    mutable std::map<std::size_t, std::vector<std::byte>> decompressed_;
};

namespace detail {

// Container, JSON, buffers; the structure below is not looked at yet.
Result<GltfDocument> open_gltf(std::span<const std::byte> bytes, const GltfOptions& options);

// Bytes behind a URI: data: or a file beside the document. Errors: io, syntax, unsupported.
Result<std::vector<std::byte>> resolve_uri(const GltfDocument& document, const std::string& uri,
                                           const std::string& pointer);

// An accessor as floats, normalised integers mapped to 0 … 1 or −1 … 1.
std::vector<float> to_floats(const RawAccessor& raw);
std::vector<std::uint32_t> to_indices(const RawAccessor& raw);

// Decodes a primitive's Draco data: its attributes into `out` and its indices.
Result<std::vector<std::uint32_t>> decode_draco(const GltfDocument& document, const Json& primitive,
                                                const std::string& pointer,
                                                std::map<std::string, RawAccessor>& out);

// A member that must be an index into an array of `size`; no_index where it is absent.
Result<std::uint32_t> index_member(const GltfDocument& document, const Json& object,
                                   const char* key, const std::string& pointer, std::size_t size);
// A member that must be a whole number in [low, high]; `otherwise` where it is absent.
Result<std::uint64_t> whole_member(const GltfDocument& document, const Json& object,
                                   const char* key, const std::string& pointer, std::uint64_t low,
                                   std::uint64_t high, std::optional<std::uint64_t> otherwise);
// The array under a top-level key; empty where it is absent. Errors: invalid, when it is none or
// has members that are no objects.
Result<const Json*> top_array(const GltfDocument& document, const char* key);

}  // namespace detail
}  // namespace prep
