// prepare(): the whole pipeline, from a loaded scene to meshes that a renderer can shade.
//
// requirements → repair (where asked for) → weld/topology → hard edges → normals → tangents →
// split. Each stage says whether it ran and why; what no material and no request calls for is not
// computed.
#pragma once

#include <cstdint>

#include "prep/corner_normals.h"
#include "prep/enum_names.h"
#include "prep/hard_edges.h"
#include "prep/prepared_scene.h"
#include "prep/repair.h"
#include "prep/requirements.h"
#include "prep/result.h"
#include "prep/scene.h"
#include "prep/tangents.h"

namespace prep {

// What happens to authored normals or tangents (those that the file brings).
enum class Authored : std::uint8_t {
    keep,     // kept where the file has them, computed where it does not or they are no direction
    replace,  // computed everywhere
    // Kept, but for the bad ones: zero, non-finite or non-unit; normals against their face;
    // tangents out of their normal's plane (by over 1.1°) or against the UVs (by over 60°, or of
    // other sign).
    repair,
};
constexpr auto names_of(Authored) {
    return std::to_array<EnumName<Authored>>(
        {{"keep", Authored::keep}, {"replace", Authored::replace}, {"repair", Authored::repair}});
}

enum class WeldMode : std::uint8_t {
    automatic,  // exact for vertex-indexed formats (glTF, PLY, …), none where the file indexes
                // positions apart from attributes (OBJ, OFF)
    none,
    exact,  // equal positions (−0 equals 0) are one vertex for adjacency
    // But with `none`: where no corner shares a vertex (STL, soups; not where vertices are tied to
    // the file or carry skins or morph targets), those at equal positions are made one for good.
};
constexpr auto names_of(WeldMode) {
    return std::to_array<EnumName<WeldMode>>(
        {{"auto", WeldMode::automatic}, {"none", WeldMode::none}, {"exact", WeldMode::exact}});
}

struct PrepareOptions {
    Request request;
    RepairOptions repair;  // off unless asked for
    WeldMode weld = WeldMode::automatic;
    Authored normals = Authored::keep;
    NormalOptions normal;        // weight, precision
    HardEdgeOptions hard_edges;  // angle, borders
    Authored tangents = Authored::keep;
    TangentOptions tangent;  // neighbour rule, fallback, threshold
    int threads = 0;         // 0: all cores; the result does not depend on it
};

// Takes the scene by value: move it in to avoid a copy. Errors: limit (more than 2^32 − 2
// vertices and corners together, or 2^30 triangles where tangents are computed), invalid (options
// out of range).
Result<PreparedScene> prepare(Scene scene, const PrepareOptions& options = {});

}  // namespace prep
