// The residual normal maps of a scene: which materials get one, baked mesh by mesh, put into the
// scene in the end.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "baking/residual_picture.h"
#include "pipeline/displacement_maps.h"
#include "prep/prepare.h"

namespace prep::detail {

// Errors: invalid (size or bits; no normals or tangents by the request), limit (maps of materials
// that several meshes share would take more than max_residual_bytes).
Result<void> check_residual_options(const PrepareOptions& options, const Scene& scene);

class ResidualMaps {
  public:
    ResidualMaps(const Scene& scene, const ResidualMapOptions& options, int threads);

    // A finding: kind, how many faces, what is said.
    using Report = std::function<void(const char*, std::uint64_t, const std::string&)>;

    struct OfMesh {
        std::vector<std::uint32_t> materials;  // ascending; empty: nothing is baked
        std::uint32_t uv_set = 0;
    };
    // Before mesh number `index` is tessellated: `displaced` is what displaces it. Faces without a
    // material get one, which is added to the scene.
    OfMesh choose(Scene& scene, std::uint32_t index, const TessellateOptions& displaced,
                  const Report& report) const;
    // When mesh number `index` has its tangents and its vertices. Errors: those of encode_png.
    Result<void> bake(const Scene& scene, std::uint32_t index, const Mesh& cage,
                      const TessellateOptions& displaced, const OfMesh& of, const VertexMesh& mesh,
                      std::span<const TrianglePlace> places, const Report& report);
    // After the last mesh. Errors: those of encode_png.
    Result<void> finish(PreparedScene& prepared);

  private:
    struct Made {
        std::optional<ResidualPicture> picture;  // none: it is encoded
        ResidualMap report;
        std::vector<std::byte> png;
        std::uint32_t mesh = 0;  // the first that has it
    };
    Result<void> encode(Made& made) const;
    std::optional<std::string> unbaked_user(const PreparedScene& prepared,
                                            std::uint32_t material) const;

    ResidualMapOptions options_;
    int threads_;
    std::map<std::uint32_t, Made> made_;                       // by material
    std::set<std::pair<std::uint32_t, std::uint32_t>> baked_;  // material, mesh
    std::vector<std::uint32_t> last_user_;                     // by material: mesh
    // By mesh: the UV set of which the materials' own maps need tangents.
    std::vector<std::optional<std::uint32_t>> tangents_of_;
};

}  // namespace prep::detail
