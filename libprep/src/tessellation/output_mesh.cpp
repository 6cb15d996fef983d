// What a mesh has besides its triangles: sides of vertices, normals, layers, groups.
#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <unordered_map>

#include "base/parallel.h"
#include "model/partial_layers.h"
#include "tessellation/polygon_surface.h"
#include "tessellation/tessellation.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

constexpr std::size_t triangles_at_once = 4096;  // on one thread

// A vertex as one root has it. Those of a vertex are consecutive.
struct Side {
    Index vertex, root;
    Index corner;  // 3 t + k of the tessellation that is there; no_index where the vertex is the
                   // middle of an edge within one root (BisectionMesh::only_edge)
};

struct Sides {
    std::vector<Side> sides;                       // by vertex
    ScratchBuffer<Index> of_corner;                // per corner
    std::vector<std::pair<Index, Index>> several;  // first and last side + 1 of other vertices
    std::vector<Index> of_several;                 // their sides, one vertex after the other
};

// Sizes a vector whose elements are then set on all threads.
template <class T>
void size_to_fill(std::vector<T>& vector, std::size_t size) {
    vector.reserve(size);
    advise_large_pages(vector.data(), size * sizeof(T));
    vector.resize(size);
}

Sides find_sides(const BisectionMesh& mesh, const Domain& domain, int threads) {
    const auto triangles = mesh.triangles();
    const auto root_at = [&](Index t, Index k) {
        const BisectedTriangle& triangle = triangles[t];
        if (!triangle.is_closed()) return triangle.root;
        return TrianglePoints(domain, triangle.root, 0).corner(k).root;
    };
    const auto for_corners = [&](const auto& body) {
        parallel_blocks(triangles.size(), triangles_at_once, threads,
                        [&](std::size_t begin, std::size_t end) {
                            for (auto t = Index(begin); t < end; ++t)
                                for (Index k = 0; k < 3; ++k) body(t, k, triangles[t].vertices[k]);
                        });
    };
    std::vector<std::vector<Side>> in_blocks((triangles.size() + triangles_at_once - 1) /
                                             triangles_at_once);
    for_corners([&](Index t, Index k, Index v) {
        if (!mesh.only_edge(v))
            in_blocks[t / triangles_at_once].push_back({v, root_at(t, k), 3 * t + k});
    });
    std::vector<Side> others;
    for (std::vector<Side>& in_block : in_blocks) {
        others.insert(others.end(), in_block.begin(), in_block.end());
        release(in_block);
    }
    const auto key = [](const Side& s) { return std::uint64_t(s.vertex) << 32 | s.root; };
    std::stable_sort(others.begin(), others.end(),
                     [&](const Side& a, const Side& b) { return key(a) < key(b); });
    Sides result;
    result.sides.reserve(mesh.vertex_count() + others.size());
    result.of_corner = ScratchBuffer<Index>(3 * triangles.size());
    ScratchBuffer<Index> side_of(mesh.vertex_count());
    std::size_t next = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
        side_of[v] = Index(result.sides.size());
        if (const BisectionMesh::HalvedEdge* const edge = mesh.only_edge(v)) {
            result.sides.push_back({v, edge->root, no_index});
            continue;
        }
        for (; next < others.size() && others[next].vertex == v; ++next) {
            if (result.sides.size() == side_of[v] || result.sides.back().root != others[next].root)
                result.sides.push_back(others[next]);
            result.of_corner[others[next].corner] = Index(result.sides.size() - 1);
        }
        if (result.sides.size() > side_of[v])
            result.several.emplace_back(side_of[v], Index(result.sides.size()));
        for (Index s = side_of[v]; s < result.sides.size(); ++s) result.of_several.push_back(s);
    }
    for_corners([&](Index t, Index k, Index v) {
        if (mesh.only_edge(v)) result.of_corner[3 * t + k] = side_of[v];
    });
    return result;
}

// Values by vertex: one of each of one side, and of the others' sides what they share.
template <class T>
struct Shared {
    std::vector<Index> of_side;  // by side of several, one vertex after the other: which of its
    std::vector<Index> counts;   // by vertex of several: values
    std::vector<T> values;
};

// Of the directions at a vertex those that may be within `reach` of one, itself and those after it,
// in order: all where they are few, else by a grid of cells of that size.
class NearDirections {
  public:
    NearDirections(std::span<const glm::dvec3> all, double reach) : all_(all), reach_(reach) {
        constexpr std::size_t few = 32;
        if (all.size() <= few) return;
        for (Index k = 0; k < all.size(); ++k) cells_[key(cell(all[k]))].push_back(k);
    }

    template <class Body>
    void each(Index from, const Body& body) const {
        if (cells_.empty()) {
            for (Index k = from; k < all_.size(); ++k) body(k);
            return;
        }
        std::vector<Index> found;
        const std::array<std::int64_t, 3> at = cell(all_[from]);
        for (std::int64_t x = -1; x <= 1; ++x)
            for (std::int64_t y = -1; y <= 1; ++y)
                for (std::int64_t z = -1; z <= 1; ++z)
                    if (const auto there = cells_.find(key({at[0] + x, at[1] + y, at[2] + z}));
                        there != cells_.end())
                        for (const Index k : there->second)
                            if (k >= from) found.push_back(k);
        std::sort(found.begin(), found.end());
        for (const Index k : found) body(k);
    }

  private:
    // Of unit vectors: 21 bits an axis.
    std::array<std::int64_t, 3> cell(const glm::dvec3& d) const {
        const auto along = [&](double x) { return std::int64_t(std::floor(x / reach_)); };
        return {along(d.x), along(d.y), along(d.z)};
    }
    static std::uint64_t key(const std::array<std::int64_t, 3>& c) {
        constexpr std::uint64_t mask = (std::uint64_t(1) << 21) - 1;
        return (std::uint64_t(c[0]) & mask) << 42 | (std::uint64_t(c[1]) & mask) << 21 |
               (std::uint64_t(c[2]) & mask);
    }
    std::span<const glm::dvec3> all_;
    double reach_;
    std::unordered_map<std::uint64_t, std::vector<Index>> cells_;
};

// Values that compare equal have equal bits.
template <class T>
using Bits = std::array<std::uint32_t, std::size_t(T::length())>;
template <class T>
Bits<T> bits_of(const T& value) {
    Bits<T> bits;
    for (glm::length_t k = 0; k < T::length(); ++k)
        bits[std::size_t(k)] = std::bit_cast<std::uint32_t>(value[k] + 0.0F);
    return bits;
}
template <class T>
struct BitsHash {
    std::size_t operator()(const Bits<T>& bits) const {
        std::uint64_t hash = 0;
        for (const std::uint32_t b : bits) hash = (hash ^ b) * 0x9e3779b97f4a7c15U;
        return std::size_t(hash ^ hash >> 29);
    }
};

class Output {
  public:
    Output(const Mesh& cage, const Domain& domain, const DisplacedSurface& surface,
           const Refinement& refinement, const TessellationHooks& hooks, int threads)
        : cage_(cage),
          domain_(domain),
          surface_(surface),
          refinement_(refinement),
          hooks_(hooks),
          threads_(threads),
          triangles_(refinement.mesh().triangles()),
          sides_(find_sides(refinement.mesh(), domain, threads)) {}

    TessellatedMesh make() {
        Mesh& mesh = out_.mesh;
        mesh.name = cage_.name;
        mesh.origin = cage_.origin;
        mesh.parts = cage_.parts;
        mesh.smoothing_kind = cage_.smoothing_kind;
        mesh.variant_materials = cage_.variant_materials;
        vertices();
        faces();
        normals();
        for (const auto& uv : cage_.uvs) layer(uv, mesh.uvs, out_.uv_sets_left_out);
        for (const auto& color : cage_.colors) layer(color, mesh.colors, out_.color_sets_left_out);
        hard_marks();
        return std::move(out_);
    }

  private:
    RootPoint point(const Side& side) const {
        if (side.corner == no_index) return refinement_.mesh().only_edge(side.vertex)->middle();
        return surface_.points(triangles_[side.corner / 3]).corner(side.corner % 3);
    }
    bool is_separate(const Side& side) const {
        return !hooks_.share_positions && refinement_.samples()[side.vertex].shared;
    }

    void vertices() {
        const auto& sides = sides_.sides;
        Mesh& mesh = out_.mesh;
        ScratchBuffer<Index> vertex_of_side(sides.size());
        std::vector<Index> first_side;
        first_side.reserve(refinement_.mesh().vertex_count());
        for (Index s = 0; s < sides.size(); ++s) {
            if (s == 0 || sides[s - 1].vertex != sides[s].vertex || is_separate(sides[s]))
                first_side.push_back(s);
            vertex_of_side[s] = Index(first_side.size() - 1);
        }
        parallel_both(
            threads_,
            [&] {
                size_to_fill(mesh.positions, first_side.size());
                size_to_fill(out_.cage_vertices, first_side.size());
            },
            [&] { size_to_fill(mesh.corner_vertices, sides_.of_corner.size()); });
        parallel_blocks(first_side.size(), triangles_at_once, threads_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i) {
                                const Side& side = sides[first_side[i]];
                                const Index v = side.vertex;
                                mesh.positions[i] = is_separate(side)
                                                        ? glm::vec3(surface_.truth(point(side)))
                                                        : refinement_.samples()[v].position;
                                out_.cage_vertices[i] = v < domain_.cage_vertices ? v : no_index;
                            }
                        });
        spread(vertex_of_side, mesh.corner_vertices);
    }

    void faces() {
        Mesh& mesh = out_.mesh;
        const std::size_t count = triangles_.size();
        size_to_fill(mesh.face_offsets, count + 1);
        size_to_fill(out_.cage_faces, count);
        if (hooks_.places) hooks_.places->resize(count);
        parallel_blocks(count, triangles_at_once, threads_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t t = begin; t < end; ++t) {
                                mesh.face_offsets[t + 1] = Index(3 * (t + 1));
                                out_.cage_faces[t] = domain_.roots[triangles_[t].root].face;
                                if (hooks_.places)
                                    (*hooks_.places)[t] = {triangles_[t].path, triangles_[t].root};
                            }
                        });
        const auto inherit = [&](const std::vector<Index>& from, std::vector<Index>& to) {
            if (from.empty()) return;
            to.resize(count);
            for (std::size_t t = 0; t < count; ++t) to[t] = from[out_.cage_faces[t]];
        };
        inherit(cage_.face_materials, mesh.face_materials);
        inherit(cage_.face_smoothing, mesh.face_smoothing);
        inherit(cage_.face_parts, mesh.face_parts);
    }

    // One a vertex and side of a hard edge: sides that the base shades alike have one normal.
    void normals() {
        const auto& sides = sides_.sides;
        const std::vector<Index>& several = sides_.of_several;
        std::vector<glm::dvec3> shading(several.size()), displaced(several.size());
        const auto frames_of = [&](std::size_t count, const auto& side, const auto& take) {
            std::vector<RootPoint> points(count);
            for (std::size_t k = 0; k < count; ++k) points[k] = point(sides[side(k)]);
            std::vector<BaseFrame> frames(count);
            surface_.base().frames(points, frames);
            for (std::size_t k = 0; k < count; ++k)
                take(k, frames[k].normal, surface_.normal(frames[k], points[k]));
        };
        parallel_blocks(several.size(), 1024, threads_, [&](std::size_t begin, std::size_t end) {
            frames_of(
                end - begin, [&](std::size_t k) { return several[begin + k]; },
                [&](std::size_t k, const glm::dvec3& shade, const glm::dvec3& normal) {
                    shading[begin + k] = shade;
                    displaced[begin + k] = normal;
                });
        });
        Shared<glm::vec3> shared;
        shared.of_side.resize(several.size());
        std::vector<Index> group;
        std::size_t at = 0;  // of the vertex' sides in `several`
        for (const auto& [first, last] : sides_.several) {
            constexpr double same = 1e-6;
            const std::size_t count = last - first;
            const auto shades = std::span<const glm::dvec3>(shading).subspan(at, count);
            const auto moved = std::span<const glm::dvec3>(displaced).subspan(at, count);
            std::vector<std::uint8_t> done(count, 0);
            const NearDirections near(shades, same);
            Index values = 0;
            for (Index s = 0; s < count; ++s) {
                if (done[s]) continue;
                group.clear();
                glm::dvec3 sum(0.0);
                near.each(s, [&](Index k) {
                    const glm::dvec3 step = shades[k] - shades[s];
                    if (done[k] || !(glm::dot(step, step) <= same * same)) return;
                    done[k] = 1;
                    group.push_back(k);
                    sum += moved[k];
                });
                const bool alike = std::all_of(group.begin(), group.end(),
                                               [&](Index k) { return moved[k] == moved[s]; });
                for (const Index k : group) shared.of_side[at + k] = values;
                if (group.empty()) shared.of_side[at + s] = values;
                shared.values.push_back(glm::vec3(alike ? moved[s] : unit_or(sum, shades[s])));
                ++values;
            }
            shared.counts.push_back(values);
            at += count;
        }
        CornerLayer<glm::vec3>& layer = out_.mesh.normals;
        fill(shared, layer, [&](std::size_t count, const auto& side, const auto& take) {
            frames_of(count, side,
                      [&](std::size_t k, const glm::dvec3& shade, const glm::dvec3& normal) {
                          take(k, glm::vec3(normal == normal ? normal : shade));
                      });
        });
    }

    // values_of(count, side, take) calls take(k, value) for side(0) … side(count − 1).
    template <class T, class ValuesOf>
    void fill(const Shared<T>& shared, CornerLayer<T>& layer, const ValuesOf& values_of) const {
        const auto& sides = sides_.sides;
        ScratchBuffer<Index> value(sides.size());  // by side
        Index next = 0, s = 0;
        std::size_t at = 0;
        const auto alone_until = [&](Index end) {
            for (; s < end; ++s) value[s] = next++;
        };
        std::vector<Index> firsts;
        for (std::size_t v = 0; v < sides_.several.size(); ++v) {
            const auto [first, last] = sides_.several[v];
            alone_until(first);
            firsts.push_back(next);
            for (; s < last; ++s, ++at) value[s] = next + shared.of_side[at];
            next += shared.counts[v];
        }
        alone_until(Index(sides.size()));
        parallel_both(
            threads_, [&] { size_to_fill(layer.values, next); },
            [&] { size_to_fill(layer.indices, sides_.of_corner.size()); });
        std::size_t from = 0;
        for (std::size_t v = 0; v < firsts.size(); ++v)
            for (Index k = 0; k < shared.counts[v]; ++k)
                layer.values[firsts[v] + k] = shared.values[from++];
        parallel_blocks(sides.size(), 1024, threads_, [&](std::size_t begin, std::size_t end) {
            std::vector<Index> alone;
            for (auto k = Index(begin); k < end; ++k)
                if (is_alone(k)) alone.push_back(k);
            values_of(
                alone.size(), [&](std::size_t k) { return alone[k]; },
                [&](std::size_t k, const T& made) { layer.values[value[alone[k]]] = made; });
        });
        spread(value, layer.indices);
    }

    // A side of a vertex that has no other.
    bool is_alone(Index s) const { return sides_.sides[s].corner == no_index; }

    void spread(std::span<const Index> value_of_side, std::vector<Index>& indices) const {
        parallel_blocks(indices.size(), triangles_at_once, threads_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t c = begin; c < end; ++c)
                                indices[c] = value_of_side[sides_.of_corner[c]];
                        });
    }

    // Linear over each root; at its centre the mean of the face's corners. Faces that lack it in a
    // corner have none.
    template <class T>
    void layer(const CornerLayer<T>& in, std::vector<CornerLayer<T>>& out,
               std::uint64_t& left_out) const {
        out.emplace_back();
        if (in.empty()) return;
        const PartialFaces faces = partial_faces(cage_, in);
        left_out += faces.torn;
        if (faces.all()) return;
        using Wide = glm::vec<T::length(), double>;
        const auto at = [&](Index corner) { return Wide(in.values[in.indices[corner]]); };
        std::vector<Wide> centres(domain_.fans(), Wide(0.0));
        for (Index fan = 0; fan < domain_.fans(); ++fan) {
            if (faces.without[domain_.roots[domain_.fan_roots[fan]].face]) continue;
            for_fan_corners(domain_, fan, [&](Index c) { centres[fan] += at(c); });
            centres[fan] /= double(domain_.fan_roots[fan + 1] - domain_.fan_roots[fan]);
        }
        const auto value_of = [&](const Side& side) {
            const DomainRoot& root = domain_.roots[side.root];
            if (faces.without[root.face]) return T(0.0F);  // until no corner has it
            const glm::dvec3 w = point(side).weights;
            if (w.x == 1 || w.y == 1) return in.values[in.indices[root.corners[w.x == 1 ? 0 : 1]]];
            return T(w.x * at(root.corners[0]) + w.y * at(root.corners[1]) +
                     w.z * centres[root.fan]);
        };
        const std::vector<Index>& several = sides_.of_several;
        std::vector<T> values(several.size());
        parallel_blocks(several.size(), 1024, threads_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                values[k] = value_of(sides_.sides[several[k]]);
        });
        Shared<T> shared;
        for (const auto& [first, last] : sides_.several) {
            constexpr Index few = 32;  // comparisons take less than a table
            const std::size_t before = shared.values.size();
            const auto none = [&] { return Index(shared.values.size() - before); };
            std::unordered_map<Bits<T>, Index, BitsHash<T>> known;
            for (Index s = first; s < last; ++s) {
                const T value = values[shared.of_side.size()];
                Index found = none();
                if (last - first <= few) {
                    for (Index k = 0; k < found; ++k)
                        if (shared.values[before + k] == value) found = k;
                } else if (value == value) {
                    found = known.emplace(bits_of(value), found).first->second;
                }
                shared.of_side.push_back(found);
                if (found == none()) shared.values.push_back(value);
            }
            shared.counts.push_back(none());
        }
        fill(shared, out.back(), [&](std::size_t count, const auto& side, const auto& take) {
            for (std::size_t k = 0; k < count; ++k) take(k, value_of(sides_.sides[side(k)]));
        });
        if (!faces.any()) return;
        CornerLayer<T>& made = out.back();
        for (std::size_t c = 0; c < made.indices.size(); ++c)
            if (faces.without[out_.cage_faces[c / 3]]) made.indices[c] = no_index;
        drop_unused_values(made);
    }

    // The pieces of the cage's.
    void hard_marks() {
        std::vector<std::pair<Index, Index>> marked;
        for (const glm::uvec2& mark : cage_.hard_marks)
            marked.push_back(std::minmax(mark.x, mark.y));
        if (marked.empty()) return;
        std::sort(marked.begin(), marked.end());
        Mesh& mesh = out_.mesh;
        std::vector<std::pair<Index, Index>> pieces;
        for (Index t = 0; t < triangles_.size(); ++t)
            for (Index k = 0; k < 3; ++k) {
                if ((triangles_[t].on_border >> k & 1) == 0) continue;
                const TrianglePoints points = surface_.points(triangles_[t]);
                const DomainRoot& root = domain_.roots[points.edge_root(k)];
                const std::pair<Index, Index> edge = std::minmax(
                    cage_.corner_vertices[root.corners[0]], cage_.corner_vertices[root.corners[1]]);
                if (!std::binary_search(marked.begin(), marked.end(), edge)) continue;
                pieces.push_back(std::minmax(mesh.corner_vertices[3 * t + k],
                                             mesh.corner_vertices[3 * t + (k + 1) % 3]));
            }
        std::sort(pieces.begin(), pieces.end());
        pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
        for (const auto& [a, b] : pieces) mesh.hard_marks.emplace_back(a, b);
    }

    const Mesh& cage_;
    const Domain& domain_;
    const DisplacedSurface& surface_;
    const Refinement& refinement_;
    const TessellationHooks& hooks_;
    int threads_;
    std::span<const BisectedTriangle> triangles_;
    Sides sides_;
    TessellatedMesh out_;
};

}  // namespace

TessellatedMesh output_mesh(const Mesh& cage, const Domain& domain, const DisplacedSurface& surface,
                            const Refinement& refinement, const TessellationHooks& hooks,
                            int threads) {
    return Output(cage, domain, surface, refinement, hooks, threads).make();
}

}  // namespace prep::detail
