// Layers of corners that some faces have no values of.
#pragma once

#include <algorithm>
#include <vector>

#include "base/finite.h"
#include "prep/mesh.h"

namespace prep::detail {

struct PartialFaces {
    std::vector<bool> without;  // per face: a corner has no value, or one that is not finite
    bool torn = false;          // such a face has values in other corners
    bool any() const { return std::find(without.begin(), without.end(), true) != without.end(); }
    bool all() const { return std::find(without.begin(), without.end(), false) == without.end(); }
};

// Of a layer that is there.
template <class T>
PartialFaces partial_faces(const Mesh& mesh, const CornerLayer<T>& layer) {
    PartialFaces result;
    result.without.resize(mesh.face_count());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        std::uint32_t missing = 0;
        bool damaged = false;
        for (std::uint32_t c = begin; c < end; ++c) {
            const std::uint32_t index = layer.indices[c];
            const bool is_there = index < layer.values.size();
            damaged = damaged || (is_there && !is_finite(layer.values[index]));
            missing += !is_there;
        }
        result.without[f] = missing > 0 || damaged;
        result.torn = result.torn || damaged || (missing > 0 && missing < end - begin);
    }
    return result;
}

// Without the values that no corner has; the order of the others stays.
template <class T>
void drop_unused_values(CornerLayer<T>& layer) {
    std::vector<std::uint32_t> kept(layer.values.size(), no_index);
    for (const std::uint32_t index : layer.indices)
        if (index != no_index) kept[index] = 0;
    std::uint32_t count = 0;
    for (std::uint32_t k = 0; k < kept.size(); ++k)
        if (kept[k] != no_index) {
            layer.values[count] = layer.values[k];
            kept[k] = count++;
        }
    layer.values.resize(count);
    for (std::uint32_t& index : layer.indices)
        if (index != no_index) index = kept[index];
}

}  // namespace prep::detail
