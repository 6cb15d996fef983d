// What is drawn of a scene, over all instances, as far as plans ask.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "prep/prepared_scene.h"
#include "rast/render.h"

namespace rast::detail {

struct DrawnContents {
    std::set<std::uint32_t> materials;
    std::vector<std::uint32_t> meshes;  // ascending, those that some node has
    bool default_material = false;
    bool lit = false;  // some triangle has a material that light reaches
    bool normals_missing = false;
    std::uint64_t triangles = 0, vertices = 0;
    std::uint64_t most_triangles = 0, most_vertices = 0;  // of a mesh
};
DrawnContents drawn_contents(const prep::PreparedScene& prepared);

// Of the normals that meshes bring: whether some draw reads them, and some mesh then has them.
struct NormalsRead {
    bool read = false, there = false;
};
NormalsRead normals_read(const prep::PreparedScene& prepared, const DrawnContents& drawn,
                         const prep::Consumer& consumer);

// What becomes of a material's maps, bit k: MapKind k. Those that are proved to change nothing are
// in none of these.
struct MapsOfMaterial {
    std::uint32_t wanted = 0;       // the plan's shading reads it
    std::uint32_t placed = 0;       // and some mesh has all that it needs
    std::uint32_t without_uvs = 0;  // wanted, and no mesh has its UV set
    bool uvs_missing = false;       // some mesh has not that of a map that is wanted
    bool tangents_missing = false;  // nor the tangents of one that bends normals
};
// By Scene::materials, by plan.request and plan.skips.
std::vector<MapsOfMaterial> maps_of_materials(const prep::PreparedScene& prepared,
                                              const DrawnContents& drawn, const RenderPlan& plan);

}  // namespace rast::detail
