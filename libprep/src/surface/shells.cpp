#include "surface/shells.h"

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

// A closed surface turned inside out is a cavity where an outward one is around it.
bool inside_another(const std::vector<Component>& parts, std::size_t i) {
    for (const Component& o : parts) {
        if (!o.closed || !o.finite || o.volume <= 0) continue;
        if (glm::all(glm::lessThan(o.low, parts[i].low)) &&
            glm::all(glm::lessThan(parts[i].high, o.high)))
            return true;
    }
    return false;
}

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
    Shells shells;
    shells.count = roots.size();
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!parts[i].closed || !parts[i].finite) continue;
        shells.volume += parts[i].volume;
        if (parts[i].volume < 0 && !inside_another(parts, i)) shells.inside_out.push_back(roots[i]);
    }
    return shells;
}

}  // namespace prep::detail
