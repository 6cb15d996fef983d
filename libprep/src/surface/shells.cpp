#include "surface/shells.h"

#include <algorithm>

namespace prep::detail {
namespace {

using Index = std::uint32_t;

struct Component {
    bool closed = true;
    bool finite = true;
    glm::dvec3 low{0.0}, high{0.0}, reference{0.0};
    double volume = 0;
    bool started = false;
};

void grow(Component& part, const Mesh& mesh, const Topology& topology, const FaceNormals& faces,
          Index face) {
    part.finite &= faces.states[face] != FaceState::non_finite;
    for (Index c = mesh.face_offsets[face]; c < mesh.face_offsets[face + 1]; ++c) {
        const EdgeKind kind = topology.kinds[c];
        part.closed &= kind == EdgeKind::interior || kind == EdgeKind::degenerate;
        const glm::dvec3 p(mesh.positions[mesh.corner_vertices[c]]);
        if (!part.started) part.low = part.high = part.reference = p;
        part.started = true;
        part.low = glm::min(part.low, p);
        part.high = glm::max(part.high, p);
    }
    const glm::dvec3 first(mesh.positions[mesh.corner_vertices[mesh.face_offsets[face]]]);
    part.volume += glm::dot(first - part.reference, faces.area_vectors[face]) / 6;
}

// Boxes of the closed shells that face outwards, halved again and again along the axis in which
// their centres lie the farthest apart.
class OutwardShells {
  public:
    explicit OutwardShells(const std::vector<Component>& parts) {
        for (const Component& part : parts)
            if (part.closed && part.finite && part.volume > 0)
                boxes_.push_back({part.low, part.high});
        nodes_.resize(boxes_.size());
        build(0, boxes_.size());
    }

    // A closed surface turned inside out is a cavity where an outward one is around it.
    bool surround(const Component& part) const {
        return surround({part.low, part.high}, 0, boxes_.size());
    }

  private:
    struct Box {
        glm::dvec3 low, high;
    };

    static bool is_inside(const Box& inner, const Box& outer) {
        return glm::all(glm::lessThan(outer.low, inner.low)) &&
               glm::all(glm::lessThan(inner.high, outer.high));
    }

    // The box of [begin, end) is that of the one in the middle.
    void build(std::size_t begin, std::size_t end) {
        if (begin == end) return;
        Box all = boxes_[begin];
        Box centres{all.low + all.high, all.low + all.high};
        for (std::size_t i = begin; i < end; ++i) {
            const glm::dvec3 centre = boxes_[i].low + boxes_[i].high;
            all = {glm::min(all.low, boxes_[i].low), glm::max(all.high, boxes_[i].high)};
            centres = {glm::min(centres.low, centre), glm::max(centres.high, centre)};
        }
        const glm::dvec3 size = centres.high - centres.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t middle = begin + (end - begin) / 2;
        const auto at = [&](std::size_t i) { return boxes_.begin() + std::ptrdiff_t(i); };
        std::nth_element(at(begin), at(middle), at(end), [axis](const Box& a, const Box& b) {
            return a.low[axis] + a.high[axis] < b.low[axis] + b.high[axis];
        });
        nodes_[middle] = all;
        build(begin, middle);
        build(middle + 1, end);
    }

    bool surround(const Box& box, std::size_t begin, std::size_t end) const {
        if (begin == end) return false;
        const std::size_t middle = begin + (end - begin) / 2;
        if (!is_inside(box, nodes_[middle])) return false;
        return is_inside(box, boxes_[middle]) || surround(box, begin, middle) ||
               surround(box, middle + 1, end);
    }

    std::vector<Box> boxes_, nodes_;
};

}  // namespace

Shells measure_shells(const Mesh& mesh, const Topology& topology, const FaceNormals& faces,
                      DisjointSets& components) {
    std::vector<Index> roots;
    std::vector<Index> number(mesh.face_count(), no_index);
    for (Index f = 0; f < mesh.face_count(); ++f) {
        const Index root = components.find(f);
        if (root == f) {
            number[f] = Index(roots.size());
            roots.push_back(f);
        }
        number[f] = number[root];
    }
    std::vector<Component> parts(roots.size());
    for (Index f = 0; f < mesh.face_count(); ++f) grow(parts[number[f]], mesh, topology, faces, f);
    const OutwardShells outward(parts);
    Shells shells;
    shells.count = roots.size();
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!parts[i].closed || !parts[i].finite) continue;
        shells.volume += parts[i].volume;
        if (parts[i].volume < 0 && !outward.surround(parts[i]))
            shells.inside_out.push_back(roots[i]);
    }
    return shells;
}

}  // namespace prep::detail
