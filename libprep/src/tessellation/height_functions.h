// Height maps as functions that tessellation reads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

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

// Of the fan of triangles around the mean of each face's corners.
std::vector<double> polygon_areas(const Mesh& mesh);

// The map as samples of the surface so far apart carry it (HeightMap::limited), in the same charts;
// `face_areas`: of the surface over each face; empty: of the polygons.
Result<HeightMap::Limited> band_limited(const HeightMap& map, const Mesh* charts,
                                        std::size_t uv_set, std::uint32_t material, double spacing,
                                        std::span<const double> face_areas, int threads);
Result<VectorMap::Limited> band_limited(const VectorMap& map, const Mesh* charts,
                                        std::size_t uv_set, std::uint32_t material, double spacing,
                                        std::span<const double> face_areas, int threads);

}  // namespace prep::detail
