#include "formats/gltf/values/primitive_vertices.h"

#include <algorithm>
#include <numeric>

#include "formats/gltf/references.h"

namespace prep::detail {

RangesByPart::RangesByPart(const VertexMesh& mesh) : mesh_(mesh), order_(mesh.ranges.size()) {
    std::iota(order_.begin(), order_.end(), std::uint32_t(0));
    std::stable_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
        return mesh.ranges[a].part < mesh.ranges[b].part;
    });
}

std::span<const std::uint32_t> RangesByPart::of(std::size_t part) const {
    const auto first = std::partition_point(
        order_.begin(), order_.end(), [&](std::uint32_t r) { return mesh_.ranges[r].part < part; });
    const auto last = std::partition_point(
        first, order_.end(), [&](std::uint32_t r) { return mesh_.ranges[r].part == part; });
    return {first, last};
}

PrimitiveTriangles::PrimitiveTriangles(const VertexMesh& mesh,
                                       std::span<const std::uint32_t> ranges) {
    for (const std::uint32_t r : ranges) {
        const VertexMesh::Range& range = mesh.ranges[r];
        if (range.triangle_count == 0) continue;
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
