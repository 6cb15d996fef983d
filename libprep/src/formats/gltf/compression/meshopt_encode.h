// EXT_meshopt_compression, written: the bytes of a bufferView by one of the extension's codecs.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace prep::detail {

enum class MeshoptMode { attributes, triangles, indices };
const char* name_of(MeshoptMode mode);  // as the extension spells it

// Whether the codec takes elements of `stride` bytes, `size` bytes of them: whole elements, of a
// multiple of 4 up to 256 bytes for attributes, of 2 or 4 for indices, triangles whole.
bool meshopt_holds(MeshoptMode mode, std::size_t stride, std::size_t size);

// `bytes` are whole elements of `stride` bytes, a filter's input where the view has one. Every byte
// comes back; triangles may begin with another of their corners. None where the codec does not hold
// them (meshopt_holds), or where the result is no smaller. Deterministic. O(bytes).
std::optional<std::vector<std::byte>> encode_meshopt(MeshoptMode mode, std::size_t stride,
                                                     std::span<const std::byte> bytes);

}  // namespace prep::detail
