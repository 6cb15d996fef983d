// PreparedScene: what prepare() makes of a scene, and what renderers and writers take.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "prep/displacement/residual.h"
#include "prep/displacement/tessellate.h"
#include "prep/findings.h"
#include "prep/output/vertex_order.h"
#include "prep/repair.h"
#include "prep/requirements.h"
#include "prep/scene.h"

namespace prep {

struct StageReport {
    std::string stage;  // "weld", "normals", …
    bool run = false;
    std::string reason;  // why it ran or was skipped, tied to scene data
    // Hard edges and normals that come out of one walk are both timed under "hard edges".
    double milliseconds = 0;
    // Faces, edges or fans that doubles could not tell: exact arithmetic decided them.
    std::uint64_t exact = 0;
    // Of the whole process: pages touched first while the stage ran, and memory at most, from the
    // process' start to the stage's end.
    std::uint64_t page_faults = 0, peak_bytes = 0;
    // The arrays that the stage read and wrote, each once: what memory has to carry at the least.
    // 0: not counted.
    std::uint64_t moved_bytes = 0;
};

struct SplitCounts {  // vertices added, by reason (a vertex can count under several)
    std::uint64_t hard_edge = 0, smoothing_group = 0, authored_normal = 0, uv_seam = 0,
                  mirrored_uv = 0, tangent = 0, color = 0, material = 0;
};
struct SplitCountName {
    SplitReason reason;
    std::uint64_t SplitCounts::*count;
    const char *key, *text;  // in JSON, in words
};
inline constexpr SplitCountName split_count_names[] = {
    {SplitReason::hard_edge, &SplitCounts::hard_edge, "hard_edge", "hard edge"},
    {SplitReason::smoothing_group, &SplitCounts::smoothing_group, "smoothing_group",
     "smoothing group"},
    {SplitReason::authored_normal, &SplitCounts::authored_normal, "authored_normal",
     "authored normal"},
    {SplitReason::uv_seam, &SplitCounts::uv_seam, "uv_seam", "UV seam"},
    {SplitReason::mirrored_uv, &SplitCounts::mirrored_uv, "mirrored_uv", "mirrored UV"},
    {SplitReason::tangent, &SplitCounts::tangent, "tangent", "tangent"},
    {SplitReason::color, &SplitCounts::color, "color", "colour"},
    {SplitReason::material, &SplitCounts::material, "material", "material"}};
// Adds a mesh's.
void count_splits(const VertexMesh& mesh, SplitCounts& counts);

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
    std::vector<bool> welded;      // by mesh: equal positions are one point for adjacency
    std::vector<bool> subdivided;  // by mesh: refined, so that no vertex is the file's own
    std::vector<std::optional<TessellationCertificate>> tessellated;  // by mesh
    std::vector<ResidualMap> residual_maps;                           // by material, ascending
    std::vector<Mesh> cages;  // by mesh: what was refined, where keep_cages asks for it
    // By mesh what is proved of each face (TessellatedMesh::errors), where keep_cages asks for it.
    std::vector<std::vector<float>> tessellation_errors;
    std::vector<bool> normals_made;                  // by mesh: none of its normals is the file's
    std::vector<std::optional<OrderChange>> orders;  // by mesh: its triangles are in another order
    std::vector<StageReport> stages;
    std::vector<Finding> findings;
    std::vector<RepairStep> repairs;  // by mesh, in the order in which they ran
    SplitCounts splits;
};

}  // namespace prep
