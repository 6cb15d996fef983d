// Values that glTF forbids, in attributes that are written back: made valid, and said so.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "formats/gltf/document.h"

namespace prep::detail {

// Kinds of changes, as bits.
enum Mend : std::uint8_t {
    mend_uv = 1,
    mend_color = 2,
    mend_weight = 4,
    mend_weight_sum = 8,
    mend_other = 16,
};
inline constexpr unsigned mend_kinds = 5;
extern const char* const mend_notes[mend_kinds];  // by bit

// Floats that are not finite become 0. Of a primitive's own attributes, colours are clamped to 0 …
// 1 and weights below 0 become 0; what a morph target adds may have any sign. Integers are left
// alone. Returns what was changed. O(values).
enum class MendOf { attribute, morph_target };
unsigned mend_values(const std::string& semantic, MendOf of, RawAccessor& values);

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
