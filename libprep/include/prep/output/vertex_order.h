// An order of triangles and vertices that graphics hardware reads with the least work: triangles
// that share vertices follow each other (vertex cache), patches that lie outside come before what
// they may hide (overdraw), vertices stand in the order in which triangles name them (fetch).
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "prep/mesh.h"

namespace prep {

// What an order asks of a cache that holds the 16 vertices shaded last, first in, first out.
struct OrderCost {
    std::uint64_t shaded = 0;  // vertices, each as often as it is not in the cache
    double acmr = 0;           // shaded / triangles: 0.5 at best on a closed mesh, 3 at worst
    double atvr = 0;           // shaded / vertices that triangles use: 1 at best
};

struct OrderChange {
    std::uint64_t triangles = 0, vertices = 0;  // that stand in another place now
    std::uint64_t kept_triangles = 0;           // whose order was not allowed to change
    OrderCost before, after;
};

struct Reordered {
    OrderChange change;
    std::vector<std::uint32_t> old_vertices;  // per vertex: its number before
};

OrderCost order_cost(const VertexMesh& mesh);

// Triangles stay in their range, corners in their triangle, and no value changes; a range in which
// more vertices would be shaded than before keeps its triangles where they are, and so does one of
// which `kept` says it. Vertices of lines and points alone come last. O(corners).
Reordered optimize_order(VertexMesh& mesh,
                         const std::function<KeptOrder(const VertexMesh::Range&)>& kept = nullptr);

// A list by vertex of the mesh before, in its new order; one that is empty stays so.
template <class T>
void take_in_order(std::vector<T>& values, const std::vector<std::uint32_t>& old_vertices) {
    if (values.empty()) return;
    std::vector<T> now;
    now.reserve(old_vertices.size());
    for (const std::uint32_t v : old_vertices) now.push_back(values[v]);
    values = std::move(now);
}

}  // namespace prep
