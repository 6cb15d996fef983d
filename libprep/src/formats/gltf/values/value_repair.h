// Values that glTF forbids, in attributes that are written back: made valid, and said so.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/document.h"

namespace prep::detail {

// Kinds of changes, as bits.
enum ValueRepair : std::uint8_t {
    repaired_uv = 1,
    repaired_color = 2,
    repaired_weight = 4,
    repaired_weight_sum = 8,
    repaired_other = 16,
};
inline constexpr unsigned repair_kinds = 5;
extern const char* const repair_notes[repair_kinds];  // by bit

// Floats that are not finite become 0. Of a primitive's own attributes, colours are clamped to 0 …
// 1 and weights below 0 become 0; what a morph target adds may have any sign. Integers are left
// alone. Returns what was changed. O(values).
enum class RepairOf { attribute, morph_target };
unsigned repair_values(const std::string& semantic, RepairOf of, RawAccessor& values);

// Whether normals or tangents are as the format asks: whole numbers normalised, lengths off by no
// more than rounding to bytes leaves.
bool are_unit(const RawAccessor& vectors);

// Drops triangles with positions that are not finite; how many. Where all are such, all go and the
// primitive with them, which is told elsewhere: 0.
std::uint64_t drop_non_finite(std::span<const glm::vec3> positions,
                              std::vector<std::uint32_t>& indices);

// Scales the weights of each vertex, in all its sets together, to the sum 1, which the format asks
// for; their ratios stay. Vertices whose weights are 0 throughout, or whose sum is 1 within the
// tolerance of the format's validator (2e-7 for each weight that is not 0), keep their bits.
//
// Floats are divided by the sum. Normalised integers get the whole sum, 255 or 65535 of their
// steps, by largest remainder (Hamilton's method; ties go to the earlier weight), so that they add
// up to 1 exactly. In a mix of types the coarser take their share of the sum, rounded down to a
// step, among themselves by largest remainder; the finer share what is left to 1. Weights that are
// 0 stay 0. Sets of one vertex count; integers that are not normalised are left alone.
// Returns whether anything changed. O(weights).
bool normalise_weights(std::span<RawAccessor* const> sets);

}  // namespace prep::detail
