// Puts together a small glTF: one buffer of its own, PNG files beside it, text that is the same
// everywhere.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "sample_files.h"

namespace samples {

struct TriangleMesh {
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec2> uvs;  // one per position, or empty
    std::vector<std::uint16_t> indices;

    std::uint16_t add(const glm::dvec3& position) {
        positions.push_back(position);
        return std::uint16_t(positions.size() - 1);
    }
    std::uint16_t add(const glm::dvec3& position, const glm::dvec2& uv) {
        uvs.push_back(uv);
        return add(position);
    }
    void quad(std::uint16_t a, std::uint16_t b, std::uint16_t c, std::uint16_t d) {
        indices.insert(indices.end(), {a, b, c, a, c, d});
    }
};

// A quaternion (x, y, z, w): first turned by `pitch` about x, then by `yaw` about y (radians). What
// looks along −z then looks up by the pitch and to the left by the yaw.
glm::dvec4 turned(double yaw, double pitch);

class GltfBuilder {
  public:
    explicit GltfBuilder(std::string folder_and_stem) : name_(std::move(folder_and_stem)) {}

    // Each returns its index. `json` is the object's content as in the glTF specification.
    int image(const std::string& file_stem, std::string png);
    int texture(int image, int sampler);
    int sampler(const std::string& json);
    int material(const std::string& json);
    int light(const std::string& json);
    int camera(const std::string& json);
    // One primitive of the mesh that the last call of mesh() began.
    int mesh(const std::string& name);
    void primitive(const TriangleMesh& triangles, int material);
    // `content` such as "\"mesh\":0"; a rotation of (0, 0, 0, 1) is left out.
    void node(const std::string& name, const std::string& content,
              const glm::dvec3& translation = {}, const glm::dvec4& rotation = {0, 0, 0, 1});

    std::vector<File> files() const;

  private:
    struct List {
        std::string text;
        int count = 0;
        int add(const std::string& item);
    };
    int accessor(const std::string& json) { return accessors_.add(json); }
    int view(std::string bytes, int target);

    std::string name_, buffer_;
    std::vector<File> images_files_;
    List images_, textures_, samplers_, materials_, lights_, cameras_, nodes_, accessors_, views_;
    struct MeshText {
        std::string name;
        List primitives;
    };
    std::vector<MeshText> meshes_;
};

}  // namespace samples
