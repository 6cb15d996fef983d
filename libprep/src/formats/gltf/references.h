// What in a glTF document refers to accessors and bufferViews, and what follows from it when the
// document is rewritten.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/appended_data.h"
#include "formats/gltf/binary_parts.h"
#include "formats/gltf/document.h"

namespace prep::detail {

// A member of what may be anything; null where it is not there.
template <class AnyJson>
AnyJson* member(AnyJson& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto it = object.find(key);
    return it == object.end() ? nullptr : &*it;
}
// body(item) for those of a list, where there is one.
template <class AnyJson, class Each>
void each(AnyJson& object, const char* key, const Each& body) {
    if (AnyJson* list = member(object, key); list && list->is_array())
        for (AnyJson& item : *list) body(item);
}

// Every index of an accessor, by primitives, animations, skins and instances; of a bufferView, by
// accessors and their sparse parts, pictures and Draco data. What is no whole number is left out;
// one with a fraction of 0 becomes an integer.
using ReferenceVisit = std::function<void(Json& index)>;
void visit_accessors(Json& json, const ReferenceVisit& visit);
void visit_views(Json& json, const ReferenceVisit& visit);

// The bytes of all bufferViews, the only buffer that has any. Views by EXT_meshopt_compression lie
// in it as they are compressed, and stand for parts of a second buffer, of which there is only its
// length.
struct PackedBuffer {
    BinaryParts bytes;
    std::uint64_t fallback_bytes = 0;
};

// Drops the accessors and bufferViews that nothing refers to, unless an extension is in use whose
// references are not known, and renumbers the rest. Errors: those of GltfDocument::view.
Result<PackedBuffer> pack_buffer(const GltfDocument& document, Json& json,
                                 const AppendedData& appended, std::vector<std::string>& notes);

// Whether the indices name each of 0 … `count` − 1, and nothing else. O(indices).
bool name_all(std::span<const std::uint32_t> indices, std::size_t count);

// The indices' values, each once and ascending; the indices become places in this list.
std::vector<std::uint32_t> number_anew(std::vector<std::uint32_t>& indices);

// A note where data that are carried over untouched (lines and points, animations, skins,
// instances) have values that are not finite.
void note_non_finite_data(const GltfDocument& document, Json& json,
                          std::vector<std::string>& notes);

// glTF forbids empty lists; they say what an absent one says.
void remove_empty_lists(Json& json);

}  // namespace prep::detail
