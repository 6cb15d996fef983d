#include "surface/soup.h"

namespace prep::detail {

bool is_soup(const Mesh& mesh) {
    if (mesh.corner_count() == 0 || mesh.corner_count() != mesh.vertex_count()) return false;
    if (!mesh.hard_marks.empty() || !mesh.subdivision.creases.empty() ||
        !mesh.subdivision.corners.empty() || !mesh.line_vertices.empty() || !mesh.points.empty())
        return false;
    std::vector<bool> used(mesh.vertex_count(), false);
    for (const std::uint32_t v : mesh.corner_vertices) {
        if (used[v]) return false;
        used[v] = true;
    }
    return true;
}

}  // namespace prep::detail
