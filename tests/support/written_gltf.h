// A glTF file as the specification reads it, written without a look at libprep: what was saved is
// judged by these values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace test {

// An accessor's elements: normalised integers divided, sparse values put in, matrices column by
// column without their padding.
struct GltfValues {
    std::string type;
    int component_type = 0;
    std::size_t width = 0;
    std::vector<double> values;
    std::size_t count() const { return width == 0 ? 0 : values.size() / width; }
    std::vector<double> at(std::size_t i) const;
    bool operator==(const GltfValues& other) const = default;
};

class GltfFile {
  public:
    using Json = nlohmann::json;

    // GLB or JSON by the first bytes; buffers beside it, in it, or as data URIs. Throws
    // std::runtime_error where the container breaks the format.
    explicit GltfFile(const std::filesystem::path& path);

    Json json;
    std::vector<std::string> buffers;

    std::string view_bytes(std::size_t view) const;
    GltfValues accessor(std::size_t index) const;
    const Json& primitive(std::size_t mesh, std::size_t primitive) const;
    // An attribute, by its vertices; fails where the primitive has none of this name.
    GltfValues attribute(std::size_t mesh, std::size_t primitive, const std::string& name) const;
    GltfValues target(std::size_t mesh, std::size_t primitive, std::size_t target,
                      const std::string& name) const;
    // Indices as they are, or 0, 1, 2 … where the primitive has none.
    std::vector<std::size_t> indices(std::size_t mesh, std::size_t primitive) const;
    // Three for each triangle, of strips and fans as the specification orders them; empty for
    // other modes.
    std::vector<std::size_t> triangles(std::size_t mesh, std::size_t primitive) const;

    // The first rule of the format that the file's structure breaks: views within their buffer and
    // aligned, accessors within their view, bounds the true ones, one count for all attributes,
    // indices of vertices that are there and never the restart value, references in range. Empty
    // where it keeps all.
    std::string fault() const;

  private:
    GltfValues decoded(std::size_t index, bool normalized) const;
    std::string primitive_fault(const Json& primitive) const;
    std::string accessor_fault(std::size_t index) const;
};

// What two files differ in, where `after` is `before` prepared: the values at the corners of every
// triangle, in their order, all attributes and morph targets but normals and tangents (`ignored`,
// where they were computed); all else value by value: lines and points, animations, inverse bind
// matrices, instances, images' bytes, and every member of the JSON that holds no reference to data.
// Empty where nothing differs.
std::string gltf_difference(const GltfFile& before, const GltfFile& after,
                            const std::vector<std::string>& ignored = {"NORMAL", "TANGENT"});

}  // namespace test
