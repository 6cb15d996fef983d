#include "formats/gltf/nodes/far_plane.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/finite.h"

namespace prep::detail {
namespace {

bool has_far_plane(const Camera& lens) {
    return lens.perspective || (lens.zfar > lens.znear && std::isfinite(lens.zfar));
}

}  // namespace

FarPlanes::FarPlanes(const PreparedScene& prepared)
    : scene_(prepared.scene), low_(HUGE_VAL), high_(-HUGE_VAL) {
    if (std::all_of(scene_.cameras.begin(), scene_.cameras.end(), has_far_plane)) return;
    world_ = world_transforms(scene_);
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n) {
        if (scene_.nodes[n].mesh == no_index) continue;
        const VertexMesh& mesh = prepared.meshes[scene_.nodes[n].mesh];
        for (const glm::vec3& p : mesh.positions) {
            const glm::dvec3 at(world_[n] * glm::dvec4(glm::dvec3(p) + mesh.origin, 1));
            if (!is_finite(at)) continue;
            low_ = glm::min(low_, at);
            high_ = glm::max(high_, at);
        }
    }
}

double FarPlanes::of(std::size_t camera) const {
    const Camera& lens = scene_.cameras[camera];
    if (has_far_plane(lens)) return lens.zfar;
    double farthest = 0;
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n) {
        if (scene_.nodes[n].camera != camera || !(low_.x <= high_.x)) continue;
        const glm::dvec3 eye(world_[n][3]);
        farthest = std::max(farthest, glm::length(glm::max(high_ - eye, eye - low_)));
    }
    // Within floats, as readers have it.
    const double most = std::numeric_limits<float>::max();
    return std::min(std::max({1.01 * farthest, 2 * lens.znear, lens.znear + 1}), most);
}

}  // namespace prep::detail
