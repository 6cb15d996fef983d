// Height maps as functions that tessellation reads.
#pragma once

#include <cstdint>
#include <memory>

#include "displacement/height_field.h"
#include "prep/displacement/tessellate.h"

namespace prep::detail {

// The map, confined to the UVs of the faces of `charts` (null: as it is) that have this material
// (no_index: all faces), as fans of the domain lie over them.
std::shared_ptr<const HeightFunction> height_function(const HeightMap& map, const Mesh* charts,
                                                      std::size_t uv_set, std::uint32_t material,
                                                      int threads);

// A vector map, confined likewise.
std::shared_ptr<const VectorFunction> vector_function(const VectorMap& map, const Mesh* charts,
                                                      std::size_t uv_set, std::uint32_t material,
                                                      int threads);

}  // namespace prep::detail
