#include "repair/flat_faces.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/disjoint_sets.h"
#include "repair/repair_steps.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

class FlatFaceFinder {
  public:
    FlatFaceFinder(const Mesh& mesh, const FaceNormals& faces, const Topology& topology,
                   const std::vector<Index>& parts)
        : mesh_(mesh), faces_(faces), topology_(topology), parts_(parts) {}

    FlatFaces run() {
        out_.keep.assign(mesh_.face_count(), 1);
        numbers_.assign(mesh_.face_count(), no_index);
        for (Index f = 0; f < mesh_.face_count(); ++f) {
            if (faces_.states[f] != FaceState::zero_area) continue;
            out_.keep[f] = 0;
            // Other polygons without area go by themselves: a bow tie has no line.
            if (!is_on_a_line(f)) continue;
            numbers_[f] = Index(flat_.size());
            flat_.push_back(f);
        }
        if (flat_.empty()) return std::move(out_);
        find_lines();
        gather_points();
        for (const Side& side : sides_) cut(side);
        drop_what_stays();
        std::stable_sort(
            out_.insertions.begin(), out_.insertions.end(),
            [](const Insertion& a, const Insertion& b) { return a.before < b.before; });
        return std::move(out_);
    }

  private:
    // An edge beside a flat face: of a face with area, from this corner to the next.
    struct Side {
        Index corner, flat;  // and the place of a flat face that has it
    };
    struct Unpaired {
        std::uint64_t key;
        Index flat;
    };
    // A vertex of a line's faces; one for each point and part.
    struct Member {
        float at;  // along the line's axis
        Index point, part, vertex;
    };
    struct Line {
        std::vector<Member> members;  // along the axis
        glm::length_t axis = 0;
        std::size_t inserted = 0;
        bool stays = false;
    };

    const glm::vec3& position(Index corner) const {
        return mesh_.positions[mesh_.corner_vertices[corner]];
    }
    Index point(Index corner) const { return topology_.welded[mesh_.corner_vertices[corner]]; }
    std::uint64_t key(Index f, Index corner) const {
        return edge_key(point(corner), point(next_corner(mesh_.face_offsets, f, corner)));
    }
    bool is_flat(Index f) const { return numbers_[f] != no_index; }

    bool is_on_a_line(Index f) const {
        const Index begin = mesh_.face_offsets[f], end = mesh_.face_offsets[f + 1];
        if (end - begin == 3) return true;
        const glm::dvec3 from(position(begin));
        glm::dvec3 along(0.0);
        for (Index c = begin; c < end; ++c)
            if (const glm::dvec3 to = glm::dvec3(position(c)) - from;
                glm::dot(to, to) > glm::dot(along, along))
                along = to;
        for (Index c = begin; c < end; ++c)
            if (glm::cross(along, glm::dvec3(position(c)) - from) != glm::dvec3(0.0)) return false;
        return true;
    }

    // Neighbours as topology has them; edges that it pairs with none, for they run the same way or
    // have more than two faces, meet all that have none.
    void find_lines() {
        DisjointSets sets(flat_.size());
        std::vector<Unpaired> unpaired;
        for (Index i = 0; i < flat_.size(); ++i)
            for (Index c = mesh_.face_offsets[flat_[i]]; c < mesh_.face_offsets[flat_[i] + 1];
                 ++c) {
                const Index across = topology_.opposite[c];
                if (across == no_index) {
                    unpaired.push_back({key(flat_[i], c), i});
                } else if (const Index f = topology_.corner_faces[across]; is_flat(f)) {
                    sets.unite(i, numbers_[f]);
                } else {
                    sides_.push_back({across, i});
                }
            }
        std::sort(unpaired.begin(), unpaired.end(), [](const Unpaired& a, const Unpaired& b) {
            return a.key != b.key ? a.key < b.key : a.flat < b.flat;
        });
        for (std::size_t k = 1; k < unpaired.size(); ++k)
            if (unpaired[k].key == unpaired[k - 1].key)
                sets.unite(unpaired[k].flat, unpaired[k - 1].flat);
        for (Index f = 0; f < mesh_.face_count() && !unpaired.empty(); ++f) {
            if (is_flat(f)) continue;
            for (Index c = mesh_.face_offsets[f]; c < mesh_.face_offsets[f + 1]; ++c) {
                if (topology_.opposite[c] != no_index) continue;
                const std::uint64_t own = key(f, c);
                const auto at = std::lower_bound(
                    unpaired.begin(), unpaired.end(), own,
                    [](const Unpaired& u, std::uint64_t wanted) { return u.key < wanted; });
                if (at != unpaired.end() && at->key == own) sides_.push_back({c, at->flat});
            }
        }
        lines_of_.resize(flat_.size());
        for (Index i = 0; i < flat_.size(); ++i) {
            const Index first = sets.find(i);  // the lowest, so it has its line already
            lines_of_[i] = first == i ? Index(lines_.size()) : lines_of_[first];
            if (first == i) lines_.emplace_back();
        }
    }

    void gather_points() {
        for (Index i = 0; i < flat_.size(); ++i)
            for (Index c = mesh_.face_offsets[flat_[i]]; c < mesh_.face_offsets[flat_[i] + 1];
                 ++c) {
                const Index v = mesh_.corner_vertices[c];
                lines_[lines_of_[i]].members.push_back({0, point(c), parts_[v], v});
            }
        for (Line& line : lines_) {
            glm::vec3 low = mesh_.positions[line.members.front().vertex], high = low;
            for (const Member& m : line.members) {
                low = glm::min(low, mesh_.positions[m.vertex]);
                high = glm::max(high, mesh_.positions[m.vertex]);
            }
            const glm::dvec3 size = glm::dvec3(high) - glm::dvec3(low);
            for (glm::length_t k = 1; k < 3; ++k)
                if (size[k] > size[line.axis]) line.axis = k;
            for (Member& m : line.members) m.at = mesh_.positions[m.vertex][line.axis];
            // Of several vertices the first that a face has.
            std::stable_sort(line.members.begin(), line.members.end(),
                             [](const Member& a, const Member& b) {
                                 if (a.at != b.at) return a.at < b.at;
                                 return a.point != b.point ? a.point < b.point : a.part < b.part;
                             });
            const auto same = [](const Member& a, const Member& b) {
                return a.point == b.point && a.part == b.part;
            };
            line.members.erase(std::unique(line.members.begin(), line.members.end(), same),
                               line.members.end());
        }
    }

    // Puts what lies between its ends into the edge, in its direction.
    void cut(const Side& side) {
        const Index number = lines_of_[side.flat];
        Line& line = lines_[number];
        const Index f = topology_.corner_faces[side.corner];
        const Index to = next_corner(mesh_.face_offsets, f, side.corner);
        const float a = position(side.corner)[line.axis], b = position(to)[line.axis];
        const Index part = parts_[mesh_.corner_vertices[side.corner]];
        const auto begin =
            std::upper_bound(line.members.begin(), line.members.end(), std::min(a, b),
                             [](float value, const Member& m) { return value < m.at; });
        const auto end =
            std::lower_bound(begin, line.members.end(), std::max(a, b),
                             [](const Member& m, float value) { return m.at < value; });
        line.inserted += std::size_t(std::max(end - begin, std::ptrdiff_t(0)));
        line.stays |= line.inserted > most_per_member * line.members.size();
        if (line.stays) return;
        const std::size_t first = insertions_.size();
        for (auto m = begin; m < end;) {
            const Index at = m->point;
            Index vertex = no_index;
            const double t = (double(m->at) - double(a)) / (double(b) - double(a));
            for (; m < end && m->point == at; ++m)
                if (m->part == part) vertex = m->vertex;
            line.stays |= vertex == no_index;
            if (vertex != no_index)
                insertions_.push_back({{to, vertex, float(std::min(t, 1.0))}, number});
        }
        if (a > b) std::reverse(insertions_.begin() + std::ptrdiff_t(first), insertions_.end());
    }

    void drop_what_stays() {
        for (const auto& [insertion, line] : insertions_)
            if (!lines_[line].stays) out_.insertions.push_back(insertion);
        for (Index i = 0; i < flat_.size(); ++i)
            if (lines_[lines_of_[i]].stays) {
                out_.keep[flat_[i]] = 1;
                ++out_.left;
            }
    }

    // A vertex is beside an edge or two of other faces. Where a line's edges run to and fro, each
    // would take all vertices.
    static constexpr std::size_t most_per_member = 16;

    struct OfLine {
        Insertion insertion;
        Index line;
    };

    const Mesh& mesh_;
    const FaceNormals& faces_;
    const Topology& topology_;
    const std::vector<Index>& parts_;
    std::vector<Index> flat_, numbers_;  // faces on a line; by face: its place among them
    std::vector<Index> lines_of_;        // by place
    std::vector<Line> lines_;
    std::vector<Side> sides_;
    std::vector<OfLine> insertions_;
    FlatFaces out_;
};

}  // namespace

FlatFaces take_out_flat_faces(const Mesh& mesh, const FaceNormals& faces, const Topology& topology,
                              const std::vector<Index>& parts) {
    return FlatFaceFinder(mesh, faces, topology, parts).run();
}

}  // namespace prep::detail
