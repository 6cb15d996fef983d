// A mesh in its place, ready for the kernels: matrices composed in double.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "geometry/homogeneous_triangle.h"
#include "kernels/kernels.h"
#include "prep/mesh.h"
#include "rast/view.h"

namespace rast::detail {

class RenderInstance final : public VertexSource {
  public:
    // The mesh's origin and the world's offset meet the eye in double; only what is left is ever
    // rounded to float, so that places far from the world's zero are as sharp as those near it.
    // `storage` becomes the records' memory.
    RenderInstance(const prep::VertexMesh& mesh, std::uint32_t node, const glm::dmat4& world,
                   const View& view, std::uint32_t width, std::uint32_t height,
                   std::vector<VertexRecord> storage = {});

    const prep::VertexMesh& mesh() const { return *mesh_; }
    std::uint32_t node() const { return node_; }
    bool mirrored() const { return mirrored_; }  // the transform turns the winding round
    // Normals to world axes: prep::normal_matrix of the linear part.
    const glm::dmat3& normal_matrix() const { return normal_matrix_; }
    // Position about the mesh's origin → position from the eye, in world axes.
    const glm::dmat4& from_eye() const { return from_eye_; }

    // Four floats per vertex, or null. Values that are not finite count as white and none is beyond
    // 1e18, so that no product with light, material and texture leaves the range of floats.
    const float* colors() const;

    ScreenVertex homogeneous(std::uint32_t vertex) const override;
    void transform(const Kernels& kernels, std::size_t begin, std::size_t end);

    std::vector<VertexRecord> records;
    std::vector<float> vertex_light;  // Gouraud: vertex_light_floats per vertex

  private:
    const prep::VertexMesh* mesh_;
    std::uint32_t node_;
    bool mirrored_ = false;
    glm::dmat3 normal_matrix_{1.0};
    glm::dmat4 from_eye_{1.0};
    TransformTask task_;
    std::vector<glm::vec4> repaired_colors_;  // where the mesh's own are out of range
};

}  // namespace rast::detail
