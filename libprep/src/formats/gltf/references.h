// What in a glTF document refers to accessors and bufferViews, and what follows from it when the
// document is rewritten.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/appended_data.h"
#include "formats/gltf/binary_parts.h"
#include "formats/gltf/document.h"

namespace prep::detail {

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
