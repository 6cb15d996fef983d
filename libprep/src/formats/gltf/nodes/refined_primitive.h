// A primitive whose mesh was subdivided: its vertices are new, and so is every accessor. What the
// primitive says beside its data stays in the document.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/appended_data.h"
#include "prep/prepared_scene.h"
#include "text/name_list.h"

namespace prep::detail {

// Whether preparation for one picture took this attribute of the document from the mesh. (Normals
// and tangents are written where the mesh has them.)
bool is_left_out(const PreparedScene& prepared, std::size_t mesh, const std::string& semantic);

// Attributes that refined meshes do not carry.
struct RefinedLosses {
    NameList attributes, of_targets;
    void note(std::vector<std::string>& notes) const;
};

// Replaces attributes, targets and indices of `primitive`. `used` are the vertices of the mesh that
// it has, ascending; `indices` are into these.
void write_refined_primitive(const PreparedScene& prepared, std::uint32_t mesh,
                             const std::vector<std::uint32_t>& used,
                             std::span<const std::uint32_t> indices, bool with_tangents,
                             AppendedData& data, Json& json, Json& primitive, RefinedLosses& lost);

// Takes height maps that have displaced the positions out of the materials' extras: a reader must
// not do it again.
void drop_used_heights(const PreparedScene& prepared, Json& json);

// Primitives without a material whose faces got one for their residual normal map have it; before
// the primitives are written, as it calls for tangents.
void assign_residual_materials(const PreparedScene& prepared, Json& json);

// Residual normal maps as pictures, textures and normalTexture of their materials.
void write_residual_maps(const PreparedScene& prepared, AppendedData& data, Json& json);

}  // namespace prep::detail
