// The attributes of a glTF mesh while its primitives are read one after the other: each becomes as
// long as the mesh, also one that a single primitive has.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "formats/gltf/document.h"
#include "prep/mesh.h"

namespace prep::detail {

// Corners or indices that are filled in no less time than threads take to start.
constexpr std::size_t worth_threads = 1 << 16;

// What is left of decoded_limit().
class DecodeBudget {
  public:
    explicit DecodeBudget(const GltfDocument& document)
        : document_(document),
          left_(decoded_limit(document.input_bytes)),
          sparse_left_(sparse_limit(document.input_bytes)) {}
    // Errors: limit.
    Result<void> spend(std::uint64_t bytes, const std::string& pointer);
    // Nothing where the accessor is not sparse. Errors: limit.
    Result<void> spend_on_sparse(std::size_t accessor);

  private:
    const GltfDocument& document_;
    std::uint64_t left_, sparse_left_;
};

// An attribute of all vertices, which grows with the primitives that have it.
template <class T>
struct Growing {
    std::vector<T> values;
    std::vector<bool> has;

    void append(std::size_t first, const RawAccessor& raw) {
        values.resize(first, T(0.0f));
        has.resize(first, false);
        values.resize(first + raw.count, T(0.0f));
        if (raw.count > 0) write_floats(raw, int(T::length()), &values[first].x);
        has.resize(values.size(), true);
    }

    void finish(const Mesh& mesh, CornerLayer<T>& layer) {
        if (!values.empty() && mesh.corner_count() > 0) {
            values.resize(mesh.vertex_count(), T(0.0f));
            has.resize(mesh.vertex_count(), false);
            layer.indices = mesh.corner_vertices;
            if (std::find(has.begin(), has.end(), false) != has.end())
                for (std::uint32_t& i : layer.indices)
                    if (!has[i]) i = no_index;
            layer.values = std::move(values);
        }
        values.clear();
        has.clear();
    }
};

class VertexData {
  public:
    VertexData(const GltfDocument& document, DecodeBudget& budget)
        : d_(document), budget_(budget) {}

    // A primitive's attribute, at the mesh's vertices from `first` on. Errors: invalid, limit.
    Result<void> append(const std::string& semantic, const RawAccessor& raw,
                        const std::string& pointer, std::size_t first, Mesh& mesh);

    // What is known of a primitive even where there is nothing to read.
    void note_names(const Json& attributes, bool triangles, bool material, Mesh& mesh);

    // Once all primitives are read: fills the mesh's layers. Errors: limit.
    Result<void> finish(const std::string& pointer, Mesh& mesh, int threads);

  private:
    using Joints = decltype(SkinInfluences::joints);
    struct Influences {
        Joints joints;
        Growing<glm::vec4> weights;
    };

    Result<void> append_named(const std::string& name, const RawAccessor& raw,
                              const std::string& pointer, std::size_t first, Mesh& mesh);
    Result<void> widen(VertexAttribute& attribute, std::uint32_t width, const std::string& pointer);

    const GltfDocument& d_;
    DecodeBudget& budget_;
    Growing<glm::vec3> normals_;
    Growing<glm::vec4> tangents_;
    std::vector<Growing<glm::vec2>> uvs_;
    std::vector<Growing<glm::vec4>> colors_;
    std::vector<Influences> influences_;
    std::map<std::string, std::size_t> named_index_;  // into Mesh::vertex_attributes
    std::uint64_t named_width_ = 0;                   // of all of them
};

}  // namespace prep::detail
