// What a scene's materials and the request call for, decided once, before anything is computed.
#pragma once

#include <string>
#include <vector>

#include "prep/calls/calls_for.h"
#include "prep/calls/reason.h"
#include "prep/scene.h"

namespace prep {

// What the caller wants to do with the result.
struct Request {
    enum class Level : std::uint8_t { never, as_called_for, always };
    Level normals = Level::as_called_for;   // as_called_for: wherever there are faces to be lit
    Level tangents = Level::as_called_for;  // as_called_for: where a tangent-space map is used
    Consumer consumer = {};                 // who calls for them: any renderer, or one picture
};

struct Need {
    bool needed = false;
    std::string reason;  // names the scene data that decided: "material 'brick' has a normal map"
    bool asked = false;  // the request asks for it, whatever the scene calls for
    Reason why = {};     // of which the reason is the sentence
};

struct MaterialUvSet {
    std::uint32_t material = no_index;  // none: the default one
    std::uint32_t uv_set = 0;
};

struct MeshRequirements {  // one per Scene::meshes entry
    Need normals;
    Need tangents;
    Need uvs;                          // whether any material samples a texture on this mesh
    std::uint32_t tangent_uv_set = 0;  // the set that the first normal map samples
    // Materials whose own map in the tangent frame samples another: their faces' tangents follow
    // it. Each once.
    std::vector<MaterialUvSet> other_tangent_uv_sets = {};
    std::uint32_t tangent_uv_set_of(std::uint32_t material) const;
    AttributeReads provided = {};  // the attributes that are to be there
    // Materials (none: the default one) that are drawn as others that read tangents.
    std::vector<std::uint32_t> drawn_in_frame = {};
};

// The UVs that each face's tangents follow, none of faces whose material's set is not there; empty
// where all follow `tangent_uv_set`. O(corners + values of all sets).
CornerLayer<glm::vec2> mixed_tangent_uvs(const Mesh& mesh, const MeshRequirements& need);

// Pure: the same scene and request give the same answer. O(faces + materials).
std::vector<MeshRequirements> requirements(const Scene& scene, const Request& request = {});

}  // namespace prep
