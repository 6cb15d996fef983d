// The maps and the noise that a scene's meshes are displaced by: pictures are read once, and
// confined to the charts of each mesh.
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
#include "tessellation/height_functions.h"

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
        // With a band limit: the same without it where residual maps are made, and how much it
        // changes heights (or vectors) at most, by picture or noise.
        std::vector<Displacement> as_read;
        std::vector<double> changes;
    };
    // Errors: those of load_image and HeightMap::make; invalid where the mesh lacks the UVs, or the
    // axes of tangent space are those of object space.
    // `subdivision`: of the limit surface; null: the polygons are displaced.
    Result<OfMesh> of(const Scene& scene, const Mesh& mesh, const SubdivideOptions* subdivision);

    // Takes the maps that displaced a mesh from their materials, unless a mesh that was left as it
    // is has such a one: then a finding says so.
    void forget(PreparedScene& prepared) const;

  private:
    Result<const Image*> picture(const ImageRef& ref);
    // A mesh, and of a limit surface its areas over the faces where a band limit needs them.
    struct Surface {
        const Mesh& mesh;
        bool is_limit = false;
        std::vector<double> face_areas;
    };
    // What a map is read as, and where.
    struct Reading {
        DisplacementKind kind = DisplacementKind::height;
        HeightMapOptions map;
        std::uint32_t uv_set = 0;
        std::vector<std::uint32_t> materials = {};  // whose faces; empty: all
        bool default_midlevel = false;              // nobody said it

        ChartFaces faces(const Surface& surface) const;
        std::uint32_t key() const { return materials.empty() ? no_index : materials.front(); }
        bool is_read_as(const Reading& other) const;  // whatever its faces
    };
    Result<Surface> surface(const Mesh& mesh, const SubdivideOptions* subdivision) const;
    Result<void> add(const ImageRef& image, const Reading& as, const Surface& surface, OfMesh& to);
    Result<Displacement> read(const ImageRef& image, const Reading& as, const std::string& name,
                              const Surface& surface, OfMesh& to);
    bool keeps_as_read() const { return options_.band_limit > 0 && options_.residual; }
    // The map's function, with a band limit, and where that is kept its own without it.
    template <class Map, class Function>
    Result<Function> function(const Map& map, const Reading& as, const Surface& surface, OfMesh& to,
                              Function& as_read);

    const DisplaceOptions& options_;
    int threads_;
    std::set<std::uint32_t> used_;  // materials
    std::map<const ImageRef*, std::unique_ptr<const Image>> pictures_;
    // By Reading::key(): materials' own readings do not change.
    std::map<std::uint32_t, HeightMap> maps_;
    std::map<std::uint32_t, VectorMap> vector_maps_;
};

}  // namespace prep::detail
