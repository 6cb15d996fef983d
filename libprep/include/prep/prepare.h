// prepare(): the whole pipeline, from a loaded scene to meshes that a renderer can shade.
//
// requirements → repair (where asked for) → weld/topology → hard edges → normals → tangents →
// split. Each stage says whether it ran and why; what no material and no request calls for is not
// computed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "prep/corner_normals.h"
#include "prep/findings.h"
#include "prep/hard_edges.h"
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

enum class WeldMode : std::uint8_t {
    automatic,  // exact for vertex-indexed formats (glTF, PLY, …), none where the file indexes
                // positions apart from attributes (OBJ, OFF)
    none,
    exact,  // equal positions (−0 equals 0) are one vertex for adjacency
    // But with `none`: where no corner shares a vertex (STL, soups; not glTF, whose skins and morph
    // targets count on its vertices), those at equal positions are made one for good.
};

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

struct StageReport {
    std::string stage;  // "weld", "normals", …
    bool run = false;
    std::string reason;  // why it ran or was skipped, tied to scene data
    double milliseconds = 0;
    // Faces, edges or fans that doubles could not tell: exact arithmetic decided them.
    std::uint64_t exact = 0;
};

struct SplitCounts {  // vertices added, by reason (a vertex can count under several)
    std::uint64_t hard_edge = 0, smoothing_group = 0, authored_normal = 0, uv_seam = 0,
                  mirrored_uv = 0, tangent = 0, color = 0, material = 0;
};

// What a morph target adds to the normals and tangents of a mesh's vertices at weight 1 where those
// were computed: the shape's own, found in the same way on the same hard edges, minus the mesh's.
// w stays the mesh's (UVs do not move). Empty: as in the file.
struct MorphDeltas {
    std::vector<glm::vec3> normals, tangents;  // one per vertex of PreparedScene::meshes
};

// scene.meshes[i] carries the prepared corner layers (normals, tangents); meshes[i] is the same
// mesh split into vertices and triangles.
struct PreparedScene {
    Scene scene;
    std::vector<VertexMesh> meshes;
    std::vector<std::vector<MorphDeltas>> morphs;  // by mesh, then by target of its glTF document
    std::vector<MeshRequirements> requirements;
    std::vector<StageReport> stages;
    std::vector<Finding> findings;
    std::vector<RepairStep> repairs;  // by mesh, in the order in which they ran
    SplitCounts splits;
};

// Takes the scene by value: move it in to avoid a copy. Errors: limit (more than 2^32 − 2
// vertices and corners together, or 2^30 triangles where tangents are computed), invalid (options
// out of range).
Result<PreparedScene> prepare(Scene scene, const PrepareOptions& options = {});

}  // namespace prep
