// Which triangles and vertices of a prepared mesh are a primitive's, when a document is written
// back: the mesh's own arrays where the primitive has all of them, copies of some otherwise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

#include "base/finite.h"
#include "base/shared_bytes.h"
#include "prep/mesh.h"

namespace prep::detail {

// Which ranges of triangles are a part's, found once for all parts. The mesh must outlive this.
class RangesByPart {
  public:
    explicit RangesByPart(const VertexMesh& mesh);
    // In the mesh's order.
    std::span<const std::uint32_t> of(std::size_t part) const;

  private:
    const VertexMesh& mesh_;
    std::vector<std::uint32_t> order_;
};

// By the numbers of the mesh's vertices.
class PrimitiveTriangles {
  public:
    // Ranges are per part and material; a primitive has one material. The mesh must outlive this.
    PrimitiveTriangles(const VertexMesh& mesh, std::span<const std::uint32_t> ranges);
    PrimitiveTriangles(PrimitiveTriangles&&) = default;  // copies would refer to another's indices

    bool empty() const { return indices_.empty(); }
    std::span<const std::uint32_t> indices() const { return indices_; }
    // To be changed by change(indices), a vector.
    template <class Change>
    void change(const Change& change) {
        if (own_.empty()) own_.assign(indices_.begin(), indices_.end());
        change(own_);
        indices_ = own_;
    }
    // The last that is asked of it.
    SharedBytes bytes() && {
        return own_.empty() ? SharedBytes::lent(std::as_bytes(indices_))
                            : SharedBytes::of(std::move(own_));
    }

  private:
    std::vector<std::uint32_t> own_;  // empty: the mesh's
    std::span<const std::uint32_t> indices_;
};

// The vertices that triangles use.
struct UsedVertices {
    std::vector<std::uint32_t> list;  // ascending
    bool all = false;                 // of the mesh
};
// The triangles' indices become places in the list.
UsedVertices number_used(const VertexMesh& mesh, PrimitiveTriangles& triangles);

// None where the mesh has none.
template <class T>
std::vector<T> values_at(const std::vector<T>& values, const std::vector<std::uint32_t>& vertices) {
    std::vector<T> result;
    if (values.empty()) return result;
    result.reserve(vertices.size());
    for (const std::uint32_t v : vertices) result.push_back(values[v]);
    return result;
}

// Vectors of the vertices, of 3 or 4 floats.
template <class T>
struct VertexVectors {
    static constexpr int width = int(T::length());
    SharedBytes bytes;
    VertexVectors() = default;
    explicit VertexVectors(std::vector<T> own) : bytes(SharedBytes::of(std::move(own))) {}
    bool empty() const { return bytes.empty(); }
    std::span<const T> values() const {
        return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
    }
};
// The mesh's own where the primitive has all of them and they are finite; else none.
template <class T>
VertexVectors<T> own_vectors(const std::vector<T>& values, const UsedVertices& used) {
    VertexVectors<T> result;
    if (used.all && all_finite(floats_of(values)))
        result.bytes = SharedBytes::lent(std::as_bytes(std::span(values)));
    return result;
}

}  // namespace prep::detail
