// The residual normal maps of a scene: which materials get one, baked mesh by mesh, put into the
// scene in the end.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "baking/residual_picture.h"
#include "pipeline/displacement_maps.h"
#include "prep/prepare.h"

namespace prep::detail {

// Errors: invalid (size or bits; no normals or tangents by the request).
Result<void> check_residual_options(const PrepareOptions& options);

class ResidualMaps {
  public:
    ResidualMaps(const ResidualMapOptions& options, int threads)
        : options_(options), threads_(threads) {}

    // A finding: kind, how many faces, what is said.
    using Report = std::function<void(const char*, std::uint64_t, const std::string&)>;

    struct OfMesh {
        std::vector<std::uint32_t> materials;  // ascending; empty: nothing is baked
        std::uint32_t uv_set = 0;
    };
    // Before the mesh is tessellated: `displaced` is what displaces it. Faces without a material
    // get one, which is added to the scene.
    OfMesh choose(Scene& scene, Mesh& mesh, const TessellateOptions& displaced,
                  const Report& report) const;
    // When mesh number `index` has its tangents and its vertices.
    Result<void> bake(const Scene& scene, std::uint32_t index, const Mesh& cage,
                      const TessellateOptions& displaced, const OfMesh& of, const VertexMesh& mesh,
                      std::span<const TrianglePlace> places, const Report& report);
    // After the last mesh. Errors: those of encode_png.
    Result<void> finish(PreparedScene& prepared);

  private:
    struct Made {
        ResidualPicture picture;
        std::uint32_t uv_set = 0;
        std::uint32_t mesh = 0;  // the first that has it
    };
    ResidualMapOptions options_;
    int threads_;
    std::map<std::uint32_t, Made> made_;  // by material
};

}  // namespace prep::detail
