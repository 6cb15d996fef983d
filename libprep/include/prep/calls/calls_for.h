// What a scene calls for: the one table from features to what they read. Preparation makes what is
// in it (requirements.h), a renderer reads what is in it (rast::plan) and nothing else.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "prep/calls/reason.h"
#include "prep/render_choices.h"
#include "prep/scene.h"

namespace prep {

// What a picture draws where the scene has another material.
struct StandIn {
    std::uint32_t material = no_index;  // of the scene; none: the default material
    // None: itself. Its textures are not the scene's: that they are there is what counts.
    std::optional<Material> drawn = {};
};

// Who is going to draw.
struct Consumer {
    // False: any renderer, whatever it may draw of a material; the rest is not read then. True: the
    // one picture that is described here.
    bool exact = false;
    Shading shading = Shading::normal_mapped;
    bool textures = true;
    bool colors = true;                 // colours are kept
    bool normals = false, uvs = false;  // buffers of them are
    bool lights = true;                 // some light has a direction or a place
    // Ascending by material. One with several is drawn as each somewhere, one with none as itself.
    std::vector<StandIn> stand_ins = {};
};

enum class Feature : std::uint8_t {
    lighting,
    normal_buffer,
    uv_buffer,
    vertex_colors,
    texture_map,
    tangent_map,  // a texture map whose texels are in the frame of tangents
    anisotropy,
};
constexpr auto names_of(Feature) {
    return std::to_array<EnumName<Feature>>({{"lighting", Feature::lighting},
                                             {"normal buffer", Feature::normal_buffer},
                                             {"UV buffer", Feature::uv_buffer},
                                             {"vertex colours", Feature::vertex_colors},
                                             {"texture map", Feature::texture_map},
                                             {"tangent-space map", Feature::tangent_map},
                                             {"anisotropy", Feature::anisotropy}});
}

// Attributes of vertices, apart from positions, which everything reads.
struct AttributeReads {
    bool normals = false, tangents = false, colors = false;
    std::vector<std::uint32_t> uv_sets = {};  // ascending
    friend bool operator==(const AttributeReads&, const AttributeReads&) = default;
    AttributeReads& operator|=(const AttributeReads& other);
    // Whether there is nothing that `other` has not.
    bool within(const AttributeReads& other) const;
};

struct Call {
    Feature feature = Feature::lighting;
    std::uint32_t material = no_index;  // none: the default material
    bool unlit = false;                 // what is drawn for it is
    const MaterialMap* map = nullptr;   // of the two features of maps
    std::uint32_t uv_set = no_index;    // that it reads
    AttributeReads reads;               // nothing, where the mesh lacks the UV set
    bool missing_uvs = false;           // the mesh has no such set
    Reason why;
};

// What is drawn where the scene has a material (none: the default one): itself or its stand-ins.
// The pointers are into the scene and the consumer.
std::vector<const Material*> drawn_as(const Scene& scene, std::uint32_t material,
                                      const Consumer& consumer);

// The table's rule for maps: whether what a map of the material says reaches what is kept. The
// material has it, or could have it.
bool map_is_read(const Material& material, const MaterialMap& map, const Consumer& consumer);

// What of a mesh the table looks at, so that meshes of either kind can be asked for.
struct MeshContents {
    bool faces = false, normals = false, colors = false;
    std::vector<std::uint32_t> uv_sets;    // those that have values, ascending
    std::vector<std::uint32_t> materials;  // in use, ascending
    std::vector<std::uint32_t> variants;   // further ones that may take their place
    bool default_material = false;         // some face has none
};
MeshContents contents_of(const Mesh& mesh, std::size_t material_count);
MeshContents contents_of(const VertexMesh& mesh, std::size_t material_count);

// One mesh's: the default material's first, then by material in the order above, each by rows of
// the table. O(materials).
std::vector<Call> calls_for(const Scene& scene, const MeshContents& mesh, const Consumer& consumer);
// Of each of Scene::meshes. Pure. O(faces + materials).
std::vector<std::vector<Call>> calls_for(const Scene& scene, const Consumer& consumer = {});

AttributeReads reads_of(const std::vector<Call>& calls);

}  // namespace prep
