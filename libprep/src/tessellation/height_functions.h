// Height maps as functions that tessellation reads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "displacement/height_field.h"
#include "prep/displacement/tessellate.h"

namespace prep::detail {

// Faces at whose UVs a map is read.
struct ChartFaces {
    const Mesh* mesh = nullptr;  // null: it is read anywhere
    std::size_t uv_set = 0;
    std::span<const std::uint32_t> materials = {};  // of the faces, ascending; empty: all
    bool of_cage = false;  // a limit surface lies over them, else they are its polygons

    bool has(std::size_t face) const {
        return materials.empty() ||
               (!mesh->face_materials.empty() &&
                std::binary_search(materials.begin(), materials.end(), mesh->face_materials[face]));
    }
};

// The map, confined to the UVs of all these faces, as fans of the domain lie over them.
std::shared_ptr<const HeightFunction> height_function(const HeightMap& map,
                                                      std::span<const ChartFaces> faces,
                                                      int threads);
std::shared_ptr<const VectorFunction> vector_function(const VectorMap& map,
                                                      std::span<const ChartFaces> faces,
                                                      int threads);

// Of the fan of triangles around the mean of each face's corners.
std::vector<double> fan_areas(const Mesh& mesh);

// The map as samples of the surface so far apart carry it (HeightMap::limited), in the same charts;
// `face_areas`: of the surface over each face; empty: of the fans.
Result<HeightMap::Limited> band_limited(const HeightMap& map, const ChartFaces& faces,
                                        double spacing, std::span<const double> face_areas,
                                        int threads);
Result<VectorMap::Limited> band_limited(const VectorMap& map, const ChartFaces& faces,
                                        double spacing, std::span<const double> face_areas,
                                        int threads);

}  // namespace prep::detail
