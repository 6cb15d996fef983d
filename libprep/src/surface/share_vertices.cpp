#include "surface/share_vertices.h"

#include "prep/topology.h"

namespace prep::detail {

void share_equal_vertices(Mesh& mesh, int threads) {
    std::vector<std::uint32_t> shared = weld_exact(mesh.positions, threads);
    std::uint32_t kept = 0;
    for (std::uint32_t v = 0; v < shared.size(); ++v) {
        if (shared[v] == v) {
            mesh.positions[kept] = mesh.positions[v];
            shared[v] = kept++;
        } else {
            shared[v] = shared[shared[v]];  // the lowest vertex of the point: renumbered already
        }
    }
    mesh.positions.resize(kept);
    mesh.vertex_colors.clear();  // of vertices that no face uses: a soup has none
    for (std::uint32_t& v : mesh.corner_vertices) v = shared[v];
}

}  // namespace prep::detail
