// What a mesh has besides its triangles: sides of vertices, normals, layers, groups.
#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <unordered_map>

#include "base/parallel.h"
#include "tessellation/polygon_surface.h"
#include "tessellation/tessellation.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// A vertex as one root has it; at `corner` (3 t + k) of the tessellation. Those of a vertex are
// consecutive.
struct Side {
    Index vertex, root, corner;
};

struct Sides {
    std::vector<Side> sides;       // by vertex
    std::vector<Index> of_corner;  // per corner
};

Sides find_sides(const BisectionMesh& mesh, const Domain& domain) {
    const auto triangles = mesh.triangles();
    const auto root_at = [&](Index t, Index k) {
        const BisectedTriangle& triangle = triangles[t];
        if (!triangle.is_closed()) return triangle.root;
        return TrianglePoints(domain, triangle.root, 0).corner(k).root;
    };
    constexpr Index several = no_index - 1;
    std::vector<Index> only_root(mesh.vertex_count(), no_index), first_corner(mesh.vertex_count());
    for (Index t = 0; t < triangles.size(); ++t)
        for (Index k = 0; k < 3; ++k) {
            const Index v = triangles[t].vertices[k];
            const Index root = root_at(t, k);
            if (only_root[v] == no_index)
                only_root[v] = root, first_corner[v] = 3 * t + k;
            else if (only_root[v] != root)
                only_root[v] = several;
        }
    std::vector<Side> shared;
    for (Index t = 0; t < triangles.size(); ++t)
        for (Index k = 0; k < 3; ++k)
            if (only_root[triangles[t].vertices[k]] == several)
                shared.push_back({triangles[t].vertices[k], root_at(t, k), 3 * t + k});
    const auto key = [](const Side& s) { return std::uint64_t(s.vertex) << 32 | s.root; };
    std::stable_sort(shared.begin(), shared.end(),
                     [&](const Side& a, const Side& b) { return key(a) < key(b); });
    Sides result;
    result.of_corner.resize(3 * triangles.size());
    std::vector<Index> side_of(mesh.vertex_count(), no_index);
    std::size_t next = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
        if (only_root[v] == no_index) continue;
        side_of[v] = Index(result.sides.size());
        if (only_root[v] != several) {
            result.sides.push_back({v, only_root[v], first_corner[v]});
            continue;
        }
        for (; next < shared.size() && shared[next].vertex == v; ++next) {
            if (result.sides.size() == side_of[v] || result.sides.back().root != shared[next].root)
                result.sides.push_back(shared[next]);
            result.of_corner[shared[next].corner] = Index(result.sides.size() - 1);
        }
    }
    for (Index t = 0; t < triangles.size(); ++t)
        for (Index k = 0; k < 3; ++k) {
            const Index v = triangles[t].vertices[k];
            if (only_root[v] != several) result.of_corner[3 * t + k] = side_of[v];
        }
    return result;
}

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
          sides_(find_sides(refinement.mesh(), domain)) {}

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
        return surface_.points(triangles_[side.corner / 3]).corner(side.corner % 3);
    }
    bool is_separate(const Side& side) const {
        return !hooks_.share_positions && refinement_.samples()[side.vertex].shared;
    }

    void vertices() {
        const auto& sides = sides_.sides;
        std::vector<Index> vertex_of_side(sides.size());
        Mesh& mesh = out_.mesh;
        mesh.positions.reserve(refinement_.mesh().vertex_count());
        out_.cage_vertices.reserve(refinement_.mesh().vertex_count());
        for (Index s = 0; s < sides.size(); ++s) {
            const Index v = sides[s].vertex;
            if (s == 0 || sides[s - 1].vertex != v || is_separate(sides[s])) {
                mesh.positions.push_back(is_separate(sides[s])
                                             ? glm::vec3(surface_.truth(point(sides[s])))
                                             : refinement_.samples()[v].position);
                out_.cage_vertices.push_back(v < domain_.cage_vertices ? v : no_index);
            }
            vertex_of_side[s] = Index(mesh.positions.size() - 1);
        }
        mesh.corner_vertices.resize(sides_.of_corner.size());
        for (std::size_t c = 0; c < sides_.of_corner.size(); ++c)
            mesh.corner_vertices[c] = vertex_of_side[sides_.of_corner[c]];
    }

    void faces() {
        Mesh& mesh = out_.mesh;
        const std::size_t count = triangles_.size();
        mesh.face_offsets.resize(count + 1);
        for (std::size_t t = 0; t <= count; ++t) mesh.face_offsets[t] = Index(3 * t);
        out_.cage_faces.resize(count);
        for (std::size_t t = 0; t < count; ++t)
            out_.cage_faces[t] = domain_.roots[triangles_[t].root].face;
        if (hooks_.places) {
            hooks_.places->resize(count);
            for (std::size_t t = 0; t < count; ++t)
                (*hooks_.places)[t] = {triangles_[t].path, triangles_[t].root};
        }
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
        std::vector<glm::dvec3> shading(sides.size()), displaced(sides.size());
        parallel_blocks(sides.size(), 1024, threads_, [&](std::size_t begin, std::size_t end) {
            std::vector<RootPoint> points;
            for (std::size_t s = begin; s < end; ++s) points.push_back(point(sides[s]));
            std::vector<BaseFrame> frames(points.size());
            surface_.base().frames(points, frames);
            for (std::size_t s = begin; s < end; ++s) {
                shading[s] = frames[s - begin].normal;
                displaced[s] = surface_.normal(frames[s - begin], points[s - begin]);
            }
        });
        Mesh& mesh = out_.mesh;
        constexpr double same = 1e-6;
        std::vector<Index> value(sides.size());
        std::vector<Index> group;
        mesh.normals.values.reserve(mesh.positions.size());
        for (Index first = 0, last = 0; first < sides.size(); first = last) {
            while (last < sides.size() && sides[last].vertex == sides[first].vertex) ++last;
            if (last - first == 1 && displaced[first] == displaced[first]) {
                value[first] = Index(mesh.normals.values.size());
                mesh.normals.values.push_back(glm::vec3(displaced[first]));
                continue;
            }
            std::vector<std::uint8_t> done(last - first, 0);
            const NearDirections near(
                std::span<const glm::dvec3>(shading).subspan(first, last - first), same);
            for (Index s = first; s < last; ++s) {
                if (done[s - first]) continue;
                group.clear();
                glm::dvec3 sum(0.0);
                near.each(s - first, [&](Index k) {
                    const Index r = first + k;
                    const glm::dvec3 step = shading[r] - shading[s];
                    if (done[k] || !(glm::dot(step, step) <= same * same)) return;
                    done[k] = 1;
                    group.push_back(r);
                    sum += displaced[r];
                });
                const bool alike = std::all_of(group.begin(), group.end(), [&](Index r) {
                    return displaced[r] == displaced[s];
                });
                for (const Index r : group) value[r] = Index(mesh.normals.values.size());
                if (group.empty()) value[s] = Index(mesh.normals.values.size());
                mesh.normals.values.push_back(
                    glm::vec3(alike ? displaced[s] : unit_or(sum, shading[s])));
            }
        }
        spread(value, mesh.normals.indices);
    }

    void spread(const std::vector<Index>& value_of_side, std::vector<Index>& indices) const {
        indices.resize(sides_.of_corner.size());
        for (std::size_t c = 0; c < indices.size(); ++c)
            indices[c] = value_of_side[sides_.of_corner[c]];
    }

    // Linear over each root; at its centre the mean of the face's corners.
    template <class T>
    void layer(const CornerLayer<T>& in, std::vector<CornerLayer<T>>& out,
               std::uint64_t& left_out) const {
        out.emplace_back();
        if (in.empty()) return;
        for (const DomainRoot& root : domain_.roots)
            if (in.indices[root.corners[0]] == no_index) {
                ++left_out;
                return;
            }
        using Wide = glm::vec<T::length(), double>;
        const auto at = [&](Index corner) { return Wide(in.values[in.indices[corner]]); };
        std::vector<Wide> centres(domain_.fans(), Wide(0.0));
        for (Index fan = 0; fan < domain_.fans(); ++fan) {
            for_fan_corners(domain_, fan, [&](Index c) { centres[fan] += at(c); });
            centres[fan] /= double(domain_.fan_roots[fan + 1] - domain_.fan_roots[fan]);
        }
        const auto& sides = sides_.sides;
        std::vector<T> values(sides.size());
        parallel_blocks(sides.size(), 1024, threads_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t s = begin; s < end; ++s) {
                const DomainRoot& root = domain_.roots[sides[s].root];
                const glm::dvec3 w = point(sides[s]).weights;
                if (w.x == 1 || w.y == 1)
                    values[s] = in.values[in.indices[root.corners[w.x == 1 ? 0 : 1]]];
                else
                    values[s] = T(w.x * at(root.corners[0]) + w.y * at(root.corners[1]) +
                                  w.z * centres[root.fan]);
            }
        });
        CornerLayer<T>& made = out.back();
        std::vector<Index> value(sides.size());
        for (Index first = 0, last = 0; first < sides.size(); first = last) {
            while (last < sides.size() && sides[last].vertex == sides[first].vertex) ++last;
            if (last - first == 1) {
                value[first] = Index(made.values.size());
                made.values.push_back(values[first]);
                continue;
            }
            constexpr Index few = 32;  // comparisons take less than a table
            std::unordered_map<Bits<T>, Index, BitsHash<T>> known;
            for (Index s = first; s < last; ++s) {
                Index found = Index(made.values.size());
                if (last - first <= few) {
                    for (Index r = first; r < s; ++r)
                        if (values[r] == values[s]) found = std::min(found, value[r]);
                } else if (values[s] == values[s]) {
                    found = known.emplace(bits_of(values[s]), found).first->second;
                }
                value[s] = found;
                if (found == made.values.size()) made.values.push_back(values[s]);
            }
        }
        spread(value, made.indices);
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
