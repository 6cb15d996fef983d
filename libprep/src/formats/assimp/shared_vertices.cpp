// Vertices that the file shares. Assimp gives each corner of FBX and Collada meshes a vertex of its
// own; where skins or morph targets go by vertex, preparation shares none of them (share_vertices.h
// does so for other meshes). Those of one position, with the same influences and the same way to
// every target, are one.
#include <cstring>
#include <map>

#include "formats/assimp/import.h"
#include "surface/soup.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

template <class T>
void append_bits(const T& value, std::string& to) {
    const std::size_t at = to.size();
    to.resize(at + sizeof value);
    std::memcpy(to.data() + at, &value, sizeof value);
}

// All that must be the same, as bytes.
class VertexKeys {
  public:
    explicit VertexKeys(const Mesh& mesh) : mesh_(mesh) {
        for (const MorphTarget& target : mesh.morph_targets)
            for (const std::vector<VertexDeltas>* runs : {&target.positions, &target.normals})
                for (const VertexDeltas& run : *runs) runs_.push_back(&run);
    }
    std::string of(Index v) const {
        std::string key;
        append_bits(mesh_.positions[v], key);
        for (const SkinInfluences& set : mesh_.skin_influences) {
            append_bits(set.joints[v], key);
            append_bits(set.weights[v], key);
        }
        for (const VertexDeltas* run : runs_) append_bits((*run->values)[v], key);
        return key;
    }

  private:
    const Mesh& mesh_;
    std::vector<const VertexDeltas*> runs_;  // each of all vertices
};

template <class T>
std::vector<T> picked(const std::vector<T>& from, const std::vector<Index>& kept) {
    std::vector<T> out;
    out.reserve(kept.size());
    for (const Index v : kept) out.push_back(from[v]);
    return out;
}

void share(Mesh& mesh) {
    const VertexKeys keys(mesh);
    std::map<std::string, Index> known;
    std::vector<Index> kept, place(mesh.vertex_count());
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
        const auto [at, fresh] = known.emplace(keys.of(v), Index(kept.size()));
        if (fresh) kept.push_back(v);
        place[v] = at->second;
    }
    if (kept.size() == mesh.vertex_count()) return;
    mesh.positions = picked(mesh.positions, kept);
    // Layers go on naming their values by the vertices that there were.
    for (std::vector<Index>* list : {&mesh.corner_vertices, &mesh.line_vertices, &mesh.points})
        for (Index& v : *list) v = place[v];
    for (SkinInfluences& set : mesh.skin_influences) {
        set.joints = picked(set.joints, kept);
        set.weights = picked(set.weights, kept);
    }
    for (MorphTarget& target : mesh.morph_targets)
        for (std::vector<VertexDeltas>* runs : {&target.positions, &target.normals})
            for (VertexDeltas& run : *runs)
                run.values =
                    std::make_shared<const std::vector<glm::vec3>>(picked(*run.values, kept));
}

}  // namespace

void share_vertices_of_corners(AssimpImport& import) {
    for (Mesh& mesh : import.scene.meshes)
        if ((!mesh.skin_influences.empty() || !mesh.morph_targets.empty()) && is_soup(mesh))
            share(mesh);
}

}  // namespace prep::detail
