// The maps and the noise that a scene's meshes are displaced by: what is read alike is read once,
// and confined to the charts of all meshes together, so that those side by side in it join.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
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
        std::vector<std::string> names;        // of the pictures
        std::vector<MapPrecision> precisions;  // likewise
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
    Result<const Image*> picture(const Scene& scene, std::uint32_t image);
    // A mesh, and of a limit surface its areas over the faces where a band limit needs them.
    struct Surface {
        const Mesh& mesh;
        bool is_limit = false;
        std::vector<double> face_areas;
    };
    // What a map is read as, and by the faces of which materials.
    struct Reading {
        std::uint32_t image = no_index;  // of the scene; no_index: that of the options
        DisplacementKind kind = DisplacementKind::height;
        HeightMapOptions map;
        std::uint32_t uv_set = 0;
        // By mesh that has some of them, ascending; nothing: all materials of all meshes.
        std::map<std::uint32_t, std::vector<std::uint32_t>> materials = {};
        bool default_midlevel = false;  // nobody said it
        // Made for the first mesh that has it.
        MapPrecision precision = {};
        bool in_object_space = false;
        std::optional<HeightMap> heights = {};  // as the file has it, where a band limit reads that
        std::optional<VectorMap> vectors = {};
        Displacement confined = {};  // without a band limit

        std::string key() const;  // equal where they are read alike, whatever their faces
    };
    void find_readings(const Scene& scene, const HeightMapOptions& heights);
    Result<void> make_heights(const Scene& scene, Reading& as, bool of_cages);
    Result<void> make_vectors(const Scene& scene, Reading& as, bool of_cages);
    template <class Map>
    auto confined(const Scene& scene, const Reading& as, const Map& map, bool of_cages) const;
    Result<Surface> surface(const Mesh& mesh, const SubdivideOptions* subdivision) const;
    // `materials`: those of the reading that the mesh has.
    Result<void> add(const Scene& scene, Reading& as, std::span<const std::uint32_t> materials,
                     const Surface& surface, OfMesh& to);
    Result<Displacement> read(const Scene& scene, Reading& as, const ChartFaces& faces,
                              const Surface& surface, OfMesh& to);
    bool keeps_as_read() const { return options_.band_limit > 0 && options_.residual; }
    bool reads_confined() const { return !(options_.band_limit > 0) || options_.residual; }
    // With a band limit, which each mesh has in its own charts.
    template <class Map>
    auto limited(const Map& map, const ChartFaces& faces, const Surface& surface, OfMesh& to) const;

    const DisplaceOptions& options_;
    int threads_;
    std::set<std::uint32_t> used_;                                    // materials
    std::map<std::uint32_t, std::unique_ptr<const Image>> pictures_;  // by image
    bool found_ = false;                                              // the readings
    std::vector<Reading> readings_;
    std::vector<std::uint32_t> reading_of_;  // by material
};

}  // namespace prep::detail
