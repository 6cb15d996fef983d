// What the merging of authored normals and of authored tangents share.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/mesh.h"

namespace prep::detail {

// Gives the corners whose faults intersect `replace` the computed values, each of them once; values
// that are then nobody's go.
// `computed` has a value at each of those corners. O(corners).
template <class T>
void replace_faulty(CornerLayer<T>& authored, const std::vector<std::uint8_t>& faults,
                    unsigned replace, const CornerLayer<T>& computed) {
    std::vector<std::uint32_t> taken(computed.values.size(), no_index);
    for (std::size_t c = 0; c < faults.size(); ++c) {
        if (!(faults[c] & replace)) continue;
        std::uint32_t& at = taken[computed.indices[c]];
        if (at == no_index) {
            at = std::uint32_t(authored.values.size());
            authored.values.push_back(computed.values[computed.indices[c]]);
        }
        authored.indices[c] = at;
    }
    // What no corner has any more may be what was wrong.
    std::vector<std::uint32_t> kept(authored.values.size(), no_index);
    for (const std::uint32_t i : authored.indices)
        if (i != no_index) kept[i] = 0;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        if (kept[i] == no_index) continue;
        authored.values[count] = authored.values[i];
        kept[i] = count++;
    }
    if (count == authored.values.size()) return;
    authored.values.resize(count);
    for (std::uint32_t& i : authored.indices)
        if (i != no_index) i = kept[i];
}

}  // namespace prep::detail
