#include "draws/instance.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rast::detail {
namespace {

constexpr float largest_color = 1e18f;

bool usable(const glm::vec4& c) {
    bool good = true;
    for (int k = 0; k < 4; ++k) good = good && std::abs(c[k]) <= largest_color;  // NaN fails
    return good;
}

glm::vec4 repaired(const glm::vec4& c) {
    for (int k = 0; k < 4; ++k)
        if (!std::isfinite(c[k])) return glm::vec4(1.0f);
    return glm::clamp(c, -largest_color, largest_color);
}

}  // namespace

RenderInstance::RenderInstance(const prep::VertexMesh& mesh, std::uint32_t node,
                               const glm::dmat4& world, const View& view, std::uint32_t width,
                               std::uint32_t height, std::vector<VertexRecord> storage)
    : records(std::move(storage)), mesh_(&mesh), node_(node) {
    const glm::dmat3 linear(world);
    mirrored_ = prep::mirrors(linear);
    normal_matrix_ = prep::normal_matrix(linear);
    from_eye_ = glm::dmat4(linear);
    from_eye_[3] = glm::dvec4((glm::dvec3(world[3]) - view.eye()) + linear * mesh.origin, 1.0);

    const glm::dmat4 rotation(glm::dmat3(view.world_to_view));
    const double aspect = view.aspect > 0 ? view.aspect : double(width) / height;
    glm::dmat4 to_screen = projection(view, aspect) * rotation * from_eye_;
    for (int c = 0; c < 4; ++c) {
        task_.rows[0][c] = to_screen[c][0] * 0.5 * width;
        task_.rows[1][c] = to_screen[c][1] * -0.5 * height;
        task_.rows[2][c] = to_screen[c][2];
        task_.rows[3][c] = to_screen[c][3];
    }
    records.resize(mesh.vertex_count());
    if (!mesh.positions.empty()) task_.positions = &mesh.positions[0].x;
    if (mesh.colors.empty()) return;
    const std::vector<glm::vec4>& colors = mesh.colors[0];
    if (std::all_of(colors.begin(), colors.end(), usable)) return;
    repaired_colors_.resize(colors.size());
    std::transform(colors.begin(), colors.end(), repaired_colors_.begin(), repaired);
}

const float* RenderInstance::colors() const {
    if (mesh_->colors.empty()) return nullptr;
    return repaired_colors_.empty() ? &mesh_->colors[0][0].x : &repaired_colors_[0].x;
}

ScreenVertex RenderInstance::homogeneous(std::uint32_t vertex) const {
    const glm::dvec3 p(mesh_->positions[vertex]);
    const auto row = [&](int r) {  // the kernel's order of operations
        const double* m = task_.rows[r];
        return ((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3];
    };
    return {row(0), row(1), row(2), row(3)};
}

void RenderInstance::transform(const Kernels& kernels, std::size_t begin, std::size_t end) {
    TransformTask task = task_;  // a copy: several threads are here
    task.out = records.data();   // the instance may have moved
    kernels.transform(task, begin, end);
}

}  // namespace rast::detail
