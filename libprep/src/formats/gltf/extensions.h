// What is made of glTF extensions: one row each.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/gltf/document.h"

namespace prep::detail {

enum class ExtensionUse : std::uint8_t {
    read,         // obeyed
    carried,      // written back as it is: preparing changes nothing that it speaks of
    remapped,     // numbers vertices; put right where vertices are split
    per_vertex,   // numbers vertices or triangles in a way that a split breaks
    undecodable,  // holds vertex data that cannot be read
};

struct GltfExtension {
    std::string_view name;
    ExtensionUse use;
    std::string_view reason;  // in words, for what is not read
};

// Ordered by use, then by name. Null: not in the table.
std::span<const GltfExtension> gltf_extensions();
const GltfExtension* gltf_extension(std::string_view name);

// A file that requires `name`: an error where it cannot be prepared without harm, else a warning or
// nothing (an empty text). `allowed`: names that the user vouches for, or "all".
Result<std::string> required_extension(const std::string& name,
                                       const std::vector<std::string>& allowed);

// A primitive whose vertices were split or dropped. `old_vertices` are the elements of the file's
// accessors behind its vertices, `indices` its triangles now.
struct ChangedPrimitive {
    std::span<const std::uint32_t> old_vertices, indices;
};

// Its extensions that number vertices are put right, or left out; what was left out is named in
// `notes`, once a name. `append` writes indices and gives the number of their accessor.
void adapt_extensions(const GltfDocument& document, Json& primitive,
                      const ChangedPrimitive& changed,
                      const std::function<std::size_t(const std::vector<std::uint32_t>&)>& append,
                      std::vector<std::string>& notes);

// The pairs of new vertices along the edges of triangles that `pairs` of old ones name, each once,
// ascending (CESIUM_primitive_outline).
std::vector<std::uint32_t> remapped_edges(std::span<const std::uint32_t> pairs,
                                          const ChangedPrimitive& changed);

// FB_ngon_encoding: the triangles of an n-gon stand together and begin with one vertex, which the
// next n-gon's do not begin with.
bool keeps_polygons(const ChangedPrimitive& changed);

// EXT_mesh_features: a set of feature IDs without attribute and texture goes by the vertex's
// number.
bool numbers_features_by_vertex(const Json& mesh_features);

}  // namespace prep::detail
