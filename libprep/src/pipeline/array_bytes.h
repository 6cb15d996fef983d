// How many bytes the arrays of a mesh have: what a stage must read and write at the least.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prep/corner_normals.h"
#include "prep/face_normals.h"
#include "prep/hard_edges.h"
#include "prep/mesh.h"
#include "prep/tangents.h"
#include "prep/topology.h"
#include "surface/vertex_corners.h"

namespace prep::detail {

template <class T>
std::uint64_t array_bytes(std::span<const T> values) {
    return values.size_bytes();
}
template <class T>
std::uint64_t array_bytes(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}
template <class T>
std::uint64_t array_bytes(const CornerLayerView<T>& layer) {
    return layer.values.size_bytes() + layer.indices.size_bytes();
}
template <class T>
std::uint64_t array_bytes(const CornerLayer<T>& layer) {
    return array_bytes(CornerLayerView<T>(layer));
}
// Positions and faces, without attributes.
inline std::uint64_t surface_bytes(const MeshView& mesh) {
    return array_bytes(mesh.positions) + array_bytes(mesh.face_offsets) +
           array_bytes(mesh.corner_vertices);
}
inline std::uint64_t array_bytes(const VertexCorners& around) {
    return array_bytes(around.offsets) + array_bytes(around.corners);
}
inline std::uint64_t array_bytes(const Topology& t) {
    return array_bytes(t.welded) + array_bytes(t.corner_faces) + array_bytes(t.opposite) +
           array_bytes(t.kinds) + array_bytes(t.point_offsets) + array_bytes(t.point_corners);
}
inline std::uint64_t array_bytes(const FaceNormals& faces) {
    return array_bytes(faces.area_vectors) + array_bytes(faces.states);
}
inline std::uint64_t array_bytes(const HardEdges& hard) {
    return array_bytes(hard.reasons);
}
inline std::uint64_t array_bytes(const Mesh& mesh) {
    std::uint64_t sum = surface_bytes(MeshView(mesh)) + array_bytes(mesh.normals) +
                        array_bytes(mesh.tangents) + array_bytes(mesh.face_materials);
    for (const auto& layer : mesh.uvs) sum += array_bytes(layer);
    for (const auto& layer : mesh.colors) sum += array_bytes(layer);
    return sum;
}
inline std::uint64_t array_bytes(const VertexMesh& mesh) {
    std::uint64_t sum = array_bytes(mesh.positions) + array_bytes(mesh.normals) +
                        array_bytes(mesh.tangents) + array_bytes(mesh.indices) +
                        array_bytes(mesh.triangle_faces) + array_bytes(mesh.source_vertices) +
                        array_bytes(mesh.source_corners) + array_bytes(mesh.split_reasons) +
                        array_bytes(mesh.corner_vertices);
    for (const auto& set : mesh.uvs) sum += array_bytes(set);
    for (const auto& set : mesh.colors) sum += array_bytes(set);
    return sum;
}

}  // namespace prep::detail
