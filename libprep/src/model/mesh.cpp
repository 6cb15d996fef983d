#include "prep/mesh.h"

namespace prep {

MeshView::MeshView(const Mesh& mesh, std::size_t uv_set)
    : positions(mesh.positions),
      face_offsets(mesh.face_offsets),
      corner_vertices(mesh.corner_vertices),
      normals(mesh.normals),
      face_materials(mesh.face_materials),
      face_smoothing(mesh.face_smoothing),
      smoothing_kind(mesh.smoothing_kind),
      hard_marks(mesh.hard_marks),
      creases(mesh.subdivision.creases) {
    if (uv_set < mesh.uvs.size()) uv = mesh.uvs[uv_set];
}

}  // namespace prep
