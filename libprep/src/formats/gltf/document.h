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
#include <string_view>
#include <vector>

#include "base/shared_bytes.h"
#include "formats/gltf/gltf.h"
#include "text/json_pointer.h"

namespace prep {

namespace detail {

using Json = nlohmann::ordered_json;

// What may be decoded of a file whose accessors name the same bytes again and again.
constexpr std::uint64_t decoded_limit(std::uint64_t input_bytes) {
    return (std::uint64_t(256) << 20) + 64 * input_bytes;
}

// What sparse accessors may come to in all their uses by primitives: each is decoded whole every
// time, however few of its elements are wanted. Some seconds.
constexpr std::uint64_t sparse_limit(std::uint64_t input_bytes) {
    return (std::uint64_t(16) << 30) + 64 * input_bytes;
}

// Elements of an accessor, tightly packed in their own component type, sparse values applied.
struct RawAccessor {
    int component_type = 5126;
    int width = 1;  // components to an element
    bool normalized = false;
    std::size_t count = 0;
    // `count` elements; where they lie in the document's buffer as they are: that part of it.
    SharedBytes bytes;
    std::size_t element_size() const;
};

std::size_t component_size(int component_type);  // 0: no such type
int components_of(const std::string& type);      // 0: no such type
const char* type_of_width(int components);       // a vector's, or a matrix's of 9 or 16

inline std::string primitive_pointer(std::size_t mesh, std::size_t primitive) {
    return "/meshes/" + std::to_string(mesh) + "/primitives/" + std::to_string(primitive);
}

// Bytes of one element in a bufferView: matrices of small components have padded columns.
std::size_t stored_size(const std::string& type, int component_type);
constexpr std::uint64_t max_elements = std::uint64_t(1) << 31;  // of an accessor

// Where one primitive's vertices went in its Mesh.
struct GltfPrimitive {
    std::uint32_t first_vertex = 0, vertex_count = 0;  // in the Mesh
    bool triangles = false;
    // The accessors' element behind each of these vertices, ascending; empty: vertex i is element
    // i. Primitives that share their accessors with others keep only what they use.
    std::vector<std::uint32_t> elements;
    std::uint32_t element_of(std::uint32_t vertex) const {
        return elements.empty() ? vertex : elements[vertex];
    }
    // Attributes (by semantic) that KHR_draco_mesh_compression held; accessors say nothing of them.
    std::map<std::string, RawAccessor> draco;
    std::vector<std::uint32_t> draco_indices;
};

}  // namespace detail

class GltfDocument final : public RetainedFile {
  public:
    detail::Json json;
    // The bytes of each buffer, cut to its byteLength; or why they are not there, which matters
    // only once something refers to them.
    std::vector<Result<detail::SharedBytes>> buffers;
    std::uint64_t input_bytes = 0;      // of the file and its buffers
    std::vector<std::string> warnings;  // odd but read
    std::filesystem::path directory;
    std::vector<std::filesystem::path> texture_directories;
    std::string name;
    std::vector<std::vector<detail::GltfPrimitive>> primitives;  // per mesh
    std::vector<Node> nodes;                                     // as they were read

    // "name#/pointer" for messages.
    std::string place(const std::string& pointer) const { return name + "#" + pointer; }
    KeptOrder kept_order(std::size_t mesh, std::size_t part) const override;  // extensions.cpp
    Error bad(const std::string& pointer, std::string text,
              ErrorCode code = ErrorCode::invalid) const {
        return {code, std::move(text), place(pointer)};
    }

    // The bytes of a bufferView, decompressed if need be; kept for the next call.
    Result<detail::SharedBytes> view(std::size_t index) const;
    // A view as it is stored, by EXT_meshopt_compression; or decompressed, its filter not undone.
    Result<detail::SharedBytes> stored_view(std::size_t index) const;
    Result<std::vector<std::byte>> filtered_view(std::size_t index) const;
    // Only after check_structure(). Errors: the data are not there, or cannot be decompressed.
    Result<detail::RawAccessor> raw_accessor(std::size_t index) const;
    // Only these of its elements, all of which it must have, in this order: the cost is theirs, but
    // for sparse accessors.
    Result<detail::RawAccessor> raw_elements(std::size_t index,
                                             const std::vector<std::uint32_t>& elements) const;
    // Whether an accessor's sparse indices are there, ascend and are below its count.
    Result<void> check_sparse_indices(std::size_t index) const;

  private:
    mutable std::map<std::size_t, detail::SharedBytes> decompressed_;
};

namespace detail {

// Container, JSON, buffers; the structure below is not looked at yet.
Result<GltfDocument> open_gltf(const SharedBytes& bytes, const GltfOptions& options);

// The files that the document's buffers lie in.
std::vector<std::filesystem::path> files_of_buffers(const GltfDocument& document);

// The file that a URI names, whatever its spelling; empty for data.
std::string file_of_uri(const GltfDocument& document, const std::string& uri);

// Bytes behind a URI: data: or a regular file, by a path relative to the document's folder.
// Errors: io (also where there is no folder), syntax, unsupported (other schemes).
Result<std::vector<std::byte>> resolve_uri(const GltfDocument& document, const std::string& uri,
                                           const std::string& pointer);

// Elements as vertex data are stored: columns of small matrices padded, each from a multiple of
// four bytes on.
struct StoredElements {
    SharedBytes bytes;
    std::size_t stride = 0;
    bool apart = false;  // there is something between them
};
StoredElements stored_elements(const RawAccessor& raw, const std::string& type);

// Only these elements, in this order.
RawAccessor selected(const RawAccessor& raw, const std::vector<std::uint32_t>& elements);

// An accessor as floats, normalised integers mapped to 0 … 1 or −1 … 1.
std::vector<float> to_floats(const RawAccessor& raw);
// The same into elements of `width` floats; components that the accessor lacks stay as they are.
void write_floats(const RawAccessor& raw, int width, float* out);
std::vector<std::uint32_t> to_indices(const RawAccessor& raw);
bool same_indices(const RawAccessor& raw, std::span<const std::uint32_t> indices);

// The document that a scene came from, to be written back; null: it came from none.
const GltfDocument* gltf_document(const Scene& scene);

// Those that KHR_materials_variants may put in place of a primitive's own; whatever is no index is
// left out.
std::vector<std::uint32_t> materials_of_variants(const Json& primitive);

// The n of "TEXCOORD_n" for the prefix "TEXCOORD_"; none for other names.
std::optional<std::size_t> set_number(std::string_view semantic, std::string_view prefix);

// Decodes a primitive's Draco data: its attributes into `out` and its indices.
Result<std::vector<std::uint32_t>> decode_draco(const GltfDocument& document, const Json& primitive,
                                                const std::string& pointer,
                                                std::map<std::string, RawAccessor>& out);

// An object's "name"; empty where it has none.
std::string name_of(const Json& object);
// An extension of an object; null where there is none, or it is no object.
const Json* extension_of(const Json& object, const char* name);
// A member of `count` numbers (1: the number itself); `out` is left as it is where it is absent.
Result<void> read_numbers(const GltfDocument& document, const Json& object, const char* key,
                          const std::string& pointer, std::span<double> out);
Result<void> read_numbers(const GltfDocument& document, const Json& object, const char* key,
                          const std::string& pointer, std::span<float> out);
// A member that must be an index into an array of `size`; no_index where it is absent.
Result<std::uint32_t> index_member(const GltfDocument& document, const Json& object,
                                   const char* key, const std::string& pointer, std::size_t size);
// A member that must be a whole number in [low, high]; `otherwise` where it is absent.
Result<std::uint64_t> whole_member(const GltfDocument& document, const Json& object,
                                   const char* key, const std::string& pointer, std::uint64_t low,
                                   std::uint64_t high, std::optional<std::uint64_t> otherwise);
// The same for a value that is there already.
Result<std::uint32_t> index_value(const GltfDocument& document, const Json& value,
                                  const std::string& pointer, std::size_t size);
// The array under a top-level key; empty where it is absent. Errors: invalid, when it is none or
// has members that are no objects.
Result<const Json*> top_array(const GltfDocument& document, const char* key);

}  // namespace detail
}  // namespace prep
