// One surface of a file's parts: which of the vertices at one position are one.
#include <algorithm>
#include <numeric>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "base/finite.h"
#include "repair/repair_steps.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Where the vertex that stays is of a part without skin weights, those of another are its own.
void take_influences(Mesh& mesh, const std::vector<Index>& target) {
    for (Index v = 0; v < target.size() && !mesh.skin_influences.empty(); ++v) {
        const Index to = mesh.file_vertex(target[v]), from = mesh.file_vertex(v);
        if (to == from || has_weights(mesh, to) || !has_weights(mesh, from)) continue;
        for (SkinInfluences& set : mesh.skin_influences) {
            set.joints[to] = set.joints[from];
            set.weights[to] = set.weights[from];
        }
    }
}

// Parts join a layer one after the other, in their order; what would lie on it goes to the next.
class PartJoints {
  public:
    PartJoints(const Mesh& mesh, const std::vector<Index>& points)
        : mesh_(mesh),
          points_(points),
          target_(mesh.vertex_count()),
          is_shared_(mesh.vertex_count(), 0) {
        std::iota(target_.begin(), target_.end(), Index(0));
        const std::vector<Index> parts = parts_of_vertices(mesh);
        for (Index v = 0; v < points_.size(); ++v)
            if (is_finite(mesh.positions[v]) && parts[points_[v]] != parts[v])
                is_shared_[points_[v]] = 1;
    }

    void run() {
        std::vector<Index> faces(mesh_.face_count());
        std::iota(faces.begin(), faces.end(), Index(0));
        std::stable_sort(faces.begin(), faces.end(), [&](Index a, Index b) {
            return mesh_.face_parts[a] < mesh_.face_parts[b];
        });
        for (std::size_t begin = 0; begin < faces.size();) {
            std::size_t end = begin + 1;
            while (end < faces.size() &&
                   mesh_.face_parts[faces[end]] == mesh_.face_parts[faces[begin]])
                ++end;
            add({faces.data() + begin, end - begin});
            begin = end;
        }
    }
    const std::vector<Index>& target() const { return target_; }
    std::uint64_t kept_apart() const { return kept_apart_; }

  private:
    struct Layer {
        std::unordered_map<Index, Index> vertices;     // by point, the one that parts share there
        std::unordered_map<std::uint64_t, int> edges;  // their faces, between shared points
        std::set<std::vector<Index>> faces;            // by their points, of shared ones alone
    };
    // Of one part, by the points between which its faces are.
    struct Part {
        std::unordered_map<std::uint64_t, int> edges;
        std::set<std::vector<Index>> faces;
    };

    void add(std::span<const Index> faces) {
        std::unordered_map<Index, Index> pending;  // by shared point the part's own vertex
        for (const Index f : faces)
            for (Index c = mesh_.face_offsets[f]; c < mesh_.face_offsets[f + 1]; ++c)
                if (const Index v = mesh_.corner_vertices[c]; is_shared_[points_[v]])
                    pending.emplace(points_[v], v);
        constexpr std::size_t most_layers = 8;  // beyond, parts stay by themselves
        for (std::size_t k = 0; k < most_layers && !pending.empty(); ++k) {
            if (k == layers_.size()) layers_.emplace_back();
            const std::unordered_set<Index> apart = conflicts(layers_[k], faces, pending);
            if (k == 0) kept_apart_ += apart.size();
            std::unordered_map<Index, Index> rest;
            for (const Index point : apart) rest.insert(*pending.find(point));
            for (const Index point : apart) pending.erase(point);
            join(layers_[k], faces, pending);
            pending = std::move(rest);
        }
    }

    Part between(std::span<const Index> faces,
                 const std::unordered_map<Index, Index>& points) const {
        Part part;
        std::vector<Index> corners;
        for (const Index f : faces) {
            corners.clear();
            for (Index c = mesh_.face_offsets[f]; c < mesh_.face_offsets[f + 1]; ++c)
                corners.push_back(points_[mesh_.corner_vertices[c]]);
            bool whole = true;
            for (std::size_t k = 0; k < corners.size(); ++k) {
                const Index a = corners[k], b = corners[(k + 1) % corners.size()];
                if (!is_shared_[a] || !points.contains(a))
                    whole = false;
                else if (is_shared_[b] && points.contains(b))
                    ++part.edges[edge_key(a, b)];
            }
            std::sort(corners.begin(), corners.end());
            if (whole) part.faces.insert(corners);
        }
        return part;
    }

    std::unordered_set<Index> conflicts(const Layer& layer, std::span<const Index> faces,
                                        const std::unordered_map<Index, Index>& pending) const {
        std::unordered_set<Index> found;
        if (layer.vertices.empty()) return found;
        const Part part = between(faces, pending);
        for (const auto& [edge, count] : part.edges) {
            const auto there = layer.edges.find(edge);
            if (there == layer.edges.end() || there->second + count <= 2) continue;
            found.insert(Index(edge >> 32));
            found.insert(Index(edge));
        }
        for (const std::vector<Index>& face : part.faces)
            if (layer.faces.contains(face)) found.insert(face.begin(), face.end());
        return found;
    }

    void join(Layer& layer, std::span<const Index> faces,
              const std::unordered_map<Index, Index>& joined) {
        for (const auto& [point, vertex] : joined)
            target_[vertex] = layer.vertices.emplace(point, vertex).first->second;
        Part part = between(faces, joined);
        for (const auto& [edge, count] : part.edges) layer.edges[edge] += count;
        layer.faces.merge(part.faces);
    }

    const Mesh& mesh_;
    const std::vector<Index>& points_;  // by vertex, the first of its point
    std::vector<Index> target_;
    std::vector<std::uint8_t> is_shared_;  // by point: several parts have it
    std::vector<Layer> layers_;
    std::uint64_t kept_apart_ = 0;
};

}  // namespace

std::uint64_t join_parts(Mesh& mesh, const std::vector<Index>& points) {
    if (!mesh.tied_to_file || mesh.face_parts.empty()) return 0;
    const auto [low, high] = std::minmax_element(mesh.face_parts.begin(), mesh.face_parts.end());
    if (*low == *high) return 0;
    PartJoints joints(mesh, points);
    joints.run();
    take_influences(mesh, joints.target());
    put_in_place(mesh, joints.target());
    return joints.kept_apart();
}

}  // namespace prep::detail
