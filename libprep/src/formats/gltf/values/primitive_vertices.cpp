#include "formats/gltf/values/primitive_vertices.h"

#include <numeric>

#include "formats/gltf/references.h"

namespace prep::detail {

PrimitiveTriangles::PrimitiveTriangles(const VertexMesh& mesh, std::size_t part) {
    for (const VertexMesh::Range& range : mesh.ranges) {
        if (range.part != part || range.triangle_count == 0) continue;
        const auto some = std::span(mesh.indices)
                              .subspan(3 * std::size_t(range.first_triangle),
                                       3 * std::size_t(range.triangle_count));
        if (empty())
            indices_ = some;
        else
            change([&](auto& own) { own.insert(own.end(), some.begin(), some.end()); });
    }
}

UsedVertices number_used(const VertexMesh& mesh, PrimitiveTriangles& triangles) {
    UsedVertices used;
    used.all = name_all(triangles.indices(), mesh.positions.size());
    if (used.all) {
        used.list.resize(mesh.positions.size());
        std::iota(used.list.begin(), used.list.end(), std::uint32_t(0));
    } else {
        triangles.change([&](auto& indices) { used.list = number_anew(indices); });
    }
    return used;
}

}  // namespace prep::detail
