// Small glTF documents, put together in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "formats/gltf/gltf.h"

namespace test {

template <class T>
constexpr int gltf_component_type() {
    if constexpr (std::is_same_v<T, std::int8_t>) return 5120;
    if constexpr (std::is_same_v<T, std::uint8_t>) return 5121;
    if constexpr (std::is_same_v<T, std::int16_t>) return 5122;
    if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
    if constexpr (std::is_same_v<T, std::uint32_t>) return 5125;
    if constexpr (std::is_same_v<T, float>) return 5126;
    return 0;
}

// The functions that add something return its index.
class GltfMaker {
  public:
    using Json = nlohmann::ordered_json;

    Json json{{"asset", {{"version", "2.0"}}}};

    // Starts at a multiple of four bytes.
    std::size_t view(std::span<const std::byte> bytes, std::size_t stride = 0);
    template <class T>
    std::size_t view(const std::vector<T>& values, std::size_t stride = 0) {
        return view(std::as_bytes(std::span(values)), stride);
    }
    // `bytes` as they are before compression: count · stride of them. Mode and filter are those of
    // EXT_meshopt_compression; `bytes` are what the filter is still to be undone on.
    std::size_t meshopt_view(const std::string& mode, const std::string& filter, std::size_t count,
                             std::size_t stride, std::span<const std::byte> bytes);

    std::size_t accessor(Json accessor) { return push("accessors", std::move(accessor)); }
    // An accessor of its own view. Elements other than scalars and matrices start at multiples of
    // four bytes, as vertex attributes must.
    template <class T>
    std::size_t accessor(const std::vector<T>& values, const char* type, bool normalized = false) {
        return typed_accessor(std::as_bytes(std::span(values)), sizeof(T), gltf_component_type<T>(),
                              type, normalized);
    }

    // A primitive of triangles in KHR_draco_mesh_compression. Values are by corner, three corners
    // to a triangle; equal corners become one vertex, and vertices share equal values. Lossless.
    struct DracoAttribute {
        std::string semantic;
        int component_type = 5126, width = 3;
        bool normalized = false;
        std::vector<double> corners;
    };
    Json draco_primitive(const std::vector<DracoAttribute>& attributes);

    // A mesh of these primitives, and a node of the scene that has it.
    std::size_t mesh(Json primitives);
    // A node that is a root of the scene.
    std::size_t root(Json node);
    std::size_t push(const std::string& list, Json value);

    std::string glb() const;
    std::string gltf() const;  // the buffer as a data URI
    prep::Result<prep::Scene> read() const;

    static std::string base64(std::span<const std::byte> bytes);

  private:
    std::size_t typed_accessor(std::span<const std::byte> bytes, std::size_t component, int code,
                               const std::string& type, bool normalized);
    Json with_buffers() const;

    std::vector<std::byte> bytes_;
    std::size_t decompressed_ = 0;  // bytes of the buffer that meshopt_view()'s views stand for
};

}  // namespace test
