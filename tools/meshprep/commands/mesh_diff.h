// Comparing the normals or tangents of two files, corner by corner.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "prep/result.h"
#include "prep/scene.h"

namespace meshprep {

enum class Attribute : std::uint8_t { normals, tangents };

struct WorstCorner {
    std::uint32_t mesh = 0, face = 0, corner = 0;  // in the first file; corner within its face
    double degrees = 0;
};

struct AttributeDiff {
    Attribute attribute = Attribute::normals;
    bool same_order = false;      // triangles in the same order; otherwise matched by position
    std::uint64_t compared = 0;   // corners of triangles
    std::uint64_t unmatched = 0;  // triangles of either file without a partner
    std::uint64_t identical = 0;  // corners equal to the last bit (−0 and 0 are not)
    std::uint64_t invalid = 0;    // corners without a finite direction of length above zero
    std::uint64_t sign_differences = 0;  // tangents: w of the other sign
    // Degrees. Median: the mean of the two middle ones of an even number. p99: the nearest rank,
    // the ⌈0.99 n⌉-th smallest of n.
    double mean = 0, rms = 0, median = 0, p99 = 0, largest = 0;
    std::vector<WorstCorner> worst;  // the largest angles, at most 8
};

// Meshes of a file are taken together, in their own space. Triangles are matched in order where
// both files have the same positions in the same order, else by their three positions (rounded to
// float) and UVs; polygons by their triangulation. Errors: invalid (a file has no such attribute,
// or no triangle).
prep::Result<AttributeDiff> diff_attribute(const prep::Scene& a, const prep::Scene& b,
                                           Attribute attribute);

bool has_attribute(const prep::Scene& scene, Attribute attribute);

}  // namespace meshprep
