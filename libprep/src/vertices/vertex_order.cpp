#include "prep/output/vertex_order.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr unsigned cached_vertices = 16;
// How many more vertices the order of patches may shade than the cache's: meshoptimizer's advice.
constexpr float overdraw_threshold = 1.05f;

std::uint64_t shaded(std::span<const Index> indices, std::size_t vertices) {
    if (indices.empty()) return 0;
    return meshopt_analyzeVertexCache(indices.data(), indices.size(), vertices, cached_vertices, 0,
                                      0)
        .vertices_transformed;
}

// The vertices of one range after the other, numbered by first use: what is told of a range takes
// time by its own size, not by the mesh's.
class LocalNumbers {
  public:
    explicit LocalNumbers(const VertexMesh& mesh)
        : mesh_(mesh), numbers_(mesh.vertex_count(), no_index) {}

    void take(const VertexMesh::Range& range) {
        for (const Index v : used_) numbers_[v] = no_index;
        used_.clear();
        indices_.clear();
        const auto whole = std::span(mesh_.indices)
                               .subspan(3 * std::size_t(range.first_triangle),
                                        3 * std::size_t(range.triangle_count));
        for (const Index v : whole) {
            if (numbers_[v] == no_index) {
                numbers_[v] = Index(used_.size());
                used_.push_back(v);
            }
            indices_.push_back(numbers_[v]);
        }
    }
    const std::vector<Index>& indices() const { return indices_; }
    const std::vector<Index>& used() const { return used_; }

  private:
    const VertexMesh& mesh_;
    std::vector<Index> numbers_, used_, indices_;
};

// Triangles by their corners, those with the same corners by number. O(triangles) where few begin
// with the same vertex.
std::vector<Index> by_corners(std::span<const Index> indices, std::size_t vertices) {
    std::vector<Index> ends(vertices + 1, 0), sorted(indices.size() / 3);
    for (std::size_t t = 0; t < sorted.size(); ++t) ++ends[indices[3 * t] + 1];
    for (std::size_t v = 0; v < vertices; ++v) ends[v + 1] += ends[v];
    for (Index t = 0; t < sorted.size(); ++t) sorted[ends[indices[3 * std::size_t(t)]]++] = t;
    const auto key = [&](Index t) {
        return std::tuple(indices[3 * std::size_t(t) + 1], indices[3 * std::size_t(t) + 2], t);
    };
    for (std::size_t begin = 0, v = 0; v < vertices; begin = ends[v++])
        std::sort(sorted.begin() + std::ptrdiff_t(begin), sorted.begin() + std::ptrdiff_t(ends[v]),
                  [&](Index a, Index b) { return key(a) < key(b); });
    return sorted;
}

// Which triangle of `before` stands at each place of `now`, which has the same in another order.
std::vector<Index> old_places(std::span<const Index> before, std::span<const Index> now,
                              std::size_t vertices) {
    const std::vector<Index> from = by_corners(before, vertices), to = by_corners(now, vertices);
    std::vector<Index> places(to.size());
    for (std::size_t k = 0; k < to.size(); ++k) places[to[k]] = from[k];
    return places;
}

// meshoptimizer looks at all triangles of a vertex that are left whenever it puts one of them down:
// that a vertex of many is several of `most` each keeps its time linear. By vertex, theirs come in
// the order of the triangles.
std::vector<Index> parted_poles(const std::vector<Index>& indices, std::vector<Index>& vertices) {
    constexpr Index most = 1024;
    std::vector<Index> parted(indices), current(vertices.size()), uses(vertices.size(), 0);
    std::iota(current.begin(), current.end(), Index(0));
    for (Index& v : parted) {
        const Index own = v;
        if (uses[own] == most) {
            current[own] = Index(vertices.size());
            vertices.push_back(own);
            uses[own] = 0;
        }
        ++uses[own];
        v = current[own];
    }
    return parted;
}

std::vector<Index> cache_order(const std::vector<Index>& indices, std::size_t count) {
    std::vector<Index> vertices(count);  // what each is of the range's
    std::iota(vertices.begin(), vertices.end(), Index(0));
    const std::vector<Index> parted = parted_poles(indices, vertices);
    std::vector<Index> ordered(indices.size());
    meshopt_optimizeVertexCache(ordered.data(), parted.data(), parted.size(), vertices.size());
    for (Index& v : ordered) v = vertices[v];
    return ordered;
}

// The range's triangles in a better order, by its own numbers; empty: there is none.
std::vector<Index> better_order(const VertexMesh& mesh, const LocalNumbers& local) {
    const std::vector<Index>&indices = local.indices(), &used = local.used();
    if (indices.empty()) return {};
    std::vector<glm::vec3> positions;
    positions.reserve(used.size());
    for (const Index v : used) positions.push_back(mesh.positions[v]);
    const std::vector<Index> cached = cache_order(indices, used.size());
    std::vector<Index> ordered(indices.size());
    meshopt_optimizeOverdraw(ordered.data(), cached.data(), cached.size(), &positions[0].x,
                             used.size(), sizeof(glm::vec3), overdraw_threshold);
    const std::uint64_t before = shaded(indices, used.size());
    if (shaded(ordered, used.size()) <= before) return ordered;
    if (shaded(cached, used.size()) <= before) return cached;
    return {};
}

// Puts a range's triangles into a better order. How many moved.
std::uint64_t order_triangles(VertexMesh& mesh, const VertexMesh::Range& range,
                              const LocalNumbers& local) {
    const std::vector<Index> now = better_order(mesh, local);
    if (now.empty()) return 0;
    const std::vector<Index> places = old_places(local.indices(), now, local.used().size());
    const auto first = std::ptrdiff_t(range.first_triangle);
    const std::vector<Index> faces(mesh.triangle_faces.begin() + first,
                                   mesh.triangle_faces.begin() + first + range.triangle_count);
    std::uint64_t moved = 0;
    for (std::size_t t = 0; t < places.size(); ++t) {
        moved += places[t] != t;
        mesh.triangle_faces[std::size_t(range.first_triangle) + t] = faces[places[t]];
    }
    for (std::size_t i = 0; i < now.size(); ++i)
        mesh.indices[3 * std::size_t(range.first_triangle) + i] = local.used()[now[i]];
    return moved;
}

// Numbers vertices by their first use, range by range; where all of a range's order is kept, those
// that it is first to use come as they came. Per vertex: its number before.
std::vector<Index> order_vertices(VertexMesh& mesh, std::span<const KeptOrder> kept) {
    std::vector<Index> old, now(mesh.vertex_count(), no_index);
    old.reserve(mesh.vertex_count());
    const auto take = [&](Index v) {
        if (now[v] != no_index) return;
        now[v] = Index(old.size());
        old.push_back(v);
    };
    for (std::size_t r = 0; r < mesh.ranges.size(); ++r) {
        const auto first = mesh.indices.begin() + std::ptrdiff_t(mesh.ranges[r].first_triangle) * 3;
        std::vector<Index> named(first, first + std::ptrdiff_t(mesh.ranges[r].triangle_count) * 3);
        if (kept[r] == KeptOrder::all) std::sort(named.begin(), named.end());
        for (const Index v : named) take(v);
    }
    for (Index v = 0; v < mesh.vertex_count(); ++v) take(v);
    take_in_order(mesh.positions, old);
    take_in_order(mesh.normals, old);
    take_in_order(mesh.tangents, old);
    for (auto& set : mesh.uvs) take_in_order(set, old);
    for (auto& set : mesh.colors) take_in_order(set, old);
    take_in_order(mesh.source_vertices, old);
    take_in_order(mesh.source_corners, old);
    take_in_order(mesh.split_reasons, old);
    for (std::vector<Index>* const list :
         {&mesh.indices, &mesh.corner_vertices, &mesh.lines, &mesh.points})
        for (Index& v : *list)
            if (v != no_index) v = now[v];
    return old;
}

}  // namespace

OrderCost order_cost(const VertexMesh& mesh) {
    OrderCost cost;
    std::uint64_t used = 0;
    LocalNumbers local(mesh);
    for (const VertexMesh::Range& range : mesh.ranges) {
        local.take(range);
        cost.shaded += shaded(local.indices(), local.used().size());
        used += local.used().size();
    }
    if (mesh.triangle_count() == 0) return cost;
    cost.acmr = double(cost.shaded) / double(mesh.triangle_count());
    cost.atvr = double(cost.shaded) / double(used);
    return cost;
}

Reordered optimize_order(VertexMesh& mesh,
                         const std::function<KeptOrder(const VertexMesh::Range&)>& kept) {
    Reordered out;
    out.change.before = order_cost(mesh);
    LocalNumbers local(mesh);
    std::vector<KeptOrder> of_ranges;
    for (const VertexMesh::Range& range : mesh.ranges) {
        of_ranges.push_back(kept ? kept(range) : KeptOrder::none);
        if (of_ranges.back() != KeptOrder::none) {
            out.change.kept_triangles += range.triangle_count;
            continue;
        }
        local.take(range);
        out.change.triangles += order_triangles(mesh, range, local);
    }
    out.old_vertices = order_vertices(mesh, of_ranges);
    for (std::size_t v = 0; v < out.old_vertices.size(); ++v)
        out.change.vertices += out.old_vertices[v] != v;
    out.change.after = order_cost(mesh);
    return out;
}

}  // namespace prep
