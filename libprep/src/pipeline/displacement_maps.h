// The height maps that a scene's meshes are displaced by: pictures are read once, and confined to
// the charts of each mesh.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "displacement/height_field.h"
#include "prep/displacement/tessellate.h"
#include "prep/prepare.h"
#include "prep/scene.h"

namespace prep::detail {

class DisplacementMaps {
  public:
    DisplacementMaps(const DisplaceOptions& options, int threads)
        : options_(options), threads_(threads) {}

    // What displaces a mesh: `displacements` and `material_displacements` as tessellate() reads
    // them; both empty where nothing does.
    struct OfMesh {
        std::vector<Displacement> displacements;
        std::vector<std::uint32_t> material_displacements;
        std::vector<std::string> names;           // of the pictures
        std::vector<Quantisation> quantisations;  // likewise
        std::uint64_t vector_maps = 0;            // that are left out
    };
    // Errors: those of load_image and HeightMap::make; invalid where the mesh lacks the UVs.
    Result<OfMesh> of(const Scene& scene, const Mesh& mesh);

    // Takes the maps that displaced a mesh from their materials.
    void forget(Scene& scene) const;

  private:
    Result<const Image*> picture(const ImageRef& ref);
    Result<void> add(const ImageRef& image, const HeightMapOptions& heights, std::uint32_t uv_set,
                     const Mesh& mesh, std::uint32_t material, OfMesh& to);

    const DisplaceOptions& options_;
    int threads_;
    std::set<std::uint32_t> used_;  // materials
    std::map<const ImageRef*, std::unique_ptr<const Image>> pictures_;
    std::map<std::uint32_t, HeightMap> maps_;  // by material; no_index: the options'
};

}  // namespace prep::detail
