#include "formats/face_colors.h"

#include <algorithm>
#include <cstdint>

#include "prep/mesh.h"

namespace prep::detail {

void set_face_colors(Mesh& mesh, std::vector<glm::vec4> colors) {
    colors.resize(mesh.face_count(), glm::vec4(1.0f));
    CornerLayer<glm::vec4> layer;
    layer.indices.resize(mesh.corner_count());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        std::fill(layer.indices.begin() + mesh.face_offsets[f],
                  layer.indices.begin() + mesh.face_offsets[f + 1], std::uint32_t(f));
    layer.values = std::move(colors);
    mesh.colors.insert(mesh.colors.begin(), std::move(layer));
}

}  // namespace prep::detail
