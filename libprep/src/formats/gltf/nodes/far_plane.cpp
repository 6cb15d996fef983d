#include "formats/gltf/nodes/far_plane.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/finite.h"

namespace prep::detail {

double orthographic_far_plane(const PreparedScene& prepared, std::size_t camera) {
    const Scene& scene = prepared.scene;
    const Camera& lens = scene.cameras[camera];
    if (lens.zfar > lens.znear && std::isfinite(lens.zfar)) return lens.zfar;
    const std::vector<glm::dmat4> world = world_transforms(scene);
    glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
        if (scene.nodes[n].mesh == no_index) continue;
        const VertexMesh& mesh = prepared.meshes[scene.nodes[n].mesh];
        for (const glm::vec3& p : mesh.positions) {
            const glm::dvec3 at(world[n] * glm::dvec4(glm::dvec3(p) + mesh.origin, 1));
            if (!is_finite(at)) continue;
            low = glm::min(low, at);
            high = glm::max(high, at);
        }
    }
    double farthest = 0;
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
        if (scene.nodes[n].camera != camera || !(low.x <= high.x)) continue;
        const glm::dvec3 eye(world[n][3]);
        farthest = std::max(farthest, glm::length(glm::max(high - eye, eye - low)));
    }
    // Within floats, as readers have it.
    const double most = std::numeric_limits<float>::max();
    return std::min(std::max({1.01 * farthest, 2 * lens.znear, lens.znear + 1}), most);
}

}  // namespace prep::detail
