// PreparedScene: what prepare() makes of a scene, and what renderers and writers take.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "prep/findings.h"
#include "prep/repair.h"
#include "prep/requirements.h"
#include "prep/scene.h"

namespace prep {

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
    std::vector<std::vector<MorphDeltas>> morphs;  // by mesh, then by Mesh::morph_targets
    std::vector<MeshRequirements> requirements;
    std::vector<StageReport> stages;
    std::vector<Finding> findings;
    std::vector<RepairStep> repairs;  // by mesh, in the order in which they ran
    SplitCounts splits;
};

}  // namespace prep
