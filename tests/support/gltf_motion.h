// A glTF file in motion, as the specification reads it: what stands where at a time.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "written_gltf.h"

namespace test {

struct MovedVertex {
    std::array<float, 3> base{};  // as the file has it, before targets, skin and nodes
    glm::dvec3 world{0.0};
};

class GltfMotion {
  public:
    explicit GltfMotion(const GltfFile& file);

    // All vertices of all nodes with meshes, at `seconds` of an animation; negative: at rest.
    std::vector<MovedVertex> vertices(int animation, double seconds) const;
    // By node, at `seconds` of an animation; negative: at rest.
    std::vector<glm::dmat4> world(int animation, double seconds) const;
    double duration(int animation) const;

  private:
    struct Pose {
        std::vector<glm::dmat4> world;
        std::vector<std::vector<double>> weights;  // by node
    };
    Pose pose(int animation, double seconds) const;
    const GltfFile& file_;
    std::vector<GltfValues> accessors_;
    std::vector<std::size_t> parents_;
};

}  // namespace test
