// What inspect says about the conventions of tangents and normal maps.
#pragma once

#include <string>
#include <vector>

#include "meshprep/output/report_json.h"
#include "prep/scene.h"
#include "prep/tangent_conventions.h"

namespace meshprep {

struct MeshConventions {
    std::uint32_t mesh = 0;
    std::uint32_t uv_set = 0;
    prep::TangentConventions tangents;
};

struct MapConventions {
    std::uint32_t material = 0;  // the first that uses the map
    std::string image;
    std::string unreadable;    // why it was not looked at, else empty
    bool marked_down = false;  // the material says that its green points down
    prep::GreenChannel green;
};

struct SceneConventions {
    std::vector<MeshConventions> meshes;  // those with tangents of their own
    std::vector<MapConventions> maps;     // tangent-space normal maps of materials in use
};

SceneConventions scene_conventions(const prep::Scene& scene, int threads);

// Lines for people, each with its figures.
std::vector<std::string> conventions_text(const SceneConventions& conventions,
                                          const prep::Scene& scene);
Json to_json(const SceneConventions& conventions, const prep::Scene& scene);

}  // namespace meshprep
