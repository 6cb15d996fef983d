// The faces of a scene where its nodes place them, and what their corners carry: what two files are
// compared by, whatever they call their meshes and nodes, and in whatever order they hold them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "prep/scene.h"

namespace judge {

struct WorldFace {
    std::uint32_t instance = 0, face = 0;  // its mesh's face
    std::uint32_t first = 0, count = 0;    // corners, in WorldFaces::points and ::corners
    std::uint32_t material = prep::no_index;
    glm::dvec3 middle{0.0};  // of its box
    // Two last bits of a float of what its corners are computed from: what moved by less did not.
    double rounding = 0;
};

// A mesh under a node; without one where no node shows it.
struct Instance {
    std::uint32_t mesh = 0, node = prep::no_index;
    std::uint32_t first_face = 0;  // in WorldFaces::faces, where faces are whole
    glm::dmat4 world{1.0};
    glm::dmat3 normals{1.0};  // prep::normal_matrix of it
    bool mirrored = false;
};

enum class Pieces : std::uint8_t { faces, triangles };
enum class Unshown : std::uint8_t { left_out, as_it_is };  // meshes that no node shows

struct ShownMeshes {
    std::size_t shown = 0, unshown = 0;  // meshes that a node shows, and that none does
};
// Of the meshes of these names (none: of all).
ShownMeshes shown_meshes(const prep::Scene& scene, const std::vector<std::string>& meshes);

class WorldFaces {
  public:
    // Of the meshes of these names (none: of all). The scene must outlive it.
    WorldFaces(const prep::Scene& scene, Pieces pieces, Unshown unshown,
               const std::vector<std::string>& meshes, int threads);

    const prep::Scene* scene = nullptr;
    std::vector<Instance> instances;
    std::vector<WorldFace> faces;        // those with a corner that is not finite: no corners
    std::vector<glm::dvec3> points;      // by corner of a face
    std::vector<std::uint32_t> corners;  // the mesh's
    std::size_t unplaced = 0;            // faces with a corner that is not finite
    glm::dvec3 low{0.0}, high{0.0};      // of all points
    // The largest of the faces' roundings.
    double rounding = 0;

    // No rounding is larger than this.
    void limit_rounding(double most);

    double diagonal() const { return glm::length(high - low); }
    const prep::Mesh& mesh_of(const WorldFace& face) const {
        return scene->meshes[instances[face.instance].mesh];
    }
    std::uint32_t mesh_index(const WorldFace& face) const { return instances[face.instance].mesh; }
    // The corner's number within its face of the mesh.
    std::uint32_t corner_in_face(const WorldFace& face, std::uint32_t corner) const;

    // Attributes in the world; none where the file has none. Directions may be zero or not finite;
    // a tangent's sign is 0 where the file has none of the two.
    std::optional<glm::dvec3> normal(const WorldFace& face, std::uint32_t corner) const;
    std::optional<glm::dvec4> tangent(const WorldFace& face, std::uint32_t corner) const;
    std::optional<glm::dvec2> uv(const WorldFace& face, std::uint32_t corner,
                                 std::size_t set) const;
    std::optional<glm::dvec4> color(const WorldFace& face, std::uint32_t corner,
                                    std::size_t set) const;
};

// What a morph target adds to a vertex, in the mesh's own numbers.
glm::dvec3 delta_at(const prep::MorphTarget& target, std::uint32_t vertex);

// Degrees between two directions; 180 where exactly one is none, 0 where both are.
double degrees_apart(const glm::dvec3& a, const glm::dvec3& b);

}  // namespace judge
