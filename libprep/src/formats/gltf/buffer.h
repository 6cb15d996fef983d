// The binary half of a glTF file while it is being written: bufferViews and accessors appended in
// order, aligned as the format asks.
#pragma once

#include <cstddef>
#include <cstring>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/gltf/binary_parts.h"

namespace prep::detail {

using Json = nlohmann::ordered_json;

inline Json array3(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

class GltfBuffer {
  public:
    explicit GltfBuffer(Json& document) : document_(document) {}

    static constexpr int array_buffer = 34962, element_array_buffer = 34963;

    // Returns the bufferView's index. `target` 0: none.
    std::size_t add_view(std::span<const std::byte> bytes, int target, std::size_t stride = 0) {
        const std::size_t index = push_view(bytes.size(), target, stride);
        binary_.append(bytes);
        return index;
    }
    // The same without a copy: the bytes must outlive the binary part.
    std::size_t lend_view(std::span<const std::byte> bytes, int target) {
        const std::size_t index = push_view(bytes.size(), target, 0);
        binary_.take(SharedBytes::lent(bytes));
        return index;
    }

    // Floats, `width` to an element. Returns the accessor's index.
    std::size_t add_floats(const float* data, std::size_t count, int width) {
        return push_floats(add_view(bytes_of(data, count, width), array_buffer), count, width);
    }
    std::size_t lend_floats(const float* data, std::size_t count, int width) {
        return push_floats(lend_view(bytes_of(data, count, width), array_buffer), count, width);
    }

    // The smallest type that holds them; the largest value of a type is primitive restart. `lent`:
    // they outlive the binary part.
    std::size_t add_indices(std::span<const std::uint32_t> indices, std::size_t vertices,
                            bool lent = false) {
        std::size_t view = 0;
        const bool narrow = vertices <= 65535;
        if (narrow) {
            std::vector<std::uint16_t> small(indices.begin(), indices.end());
            view = add_view(std::as_bytes(std::span(small)), element_array_buffer);
        } else {
            view = lent ? lend_view(std::as_bytes(indices), element_array_buffer)
                        : add_view(std::as_bytes(indices), element_array_buffer);
        }
        return push("accessors", Json{{"bufferView", view},
                                      {"componentType", narrow ? 5123 : 5125},
                                      {"count", indices.size()},
                                      {"type", "SCALAR"}});
    }

    std::size_t push(const char* list, Json value) {
        Json& array = document_[list];
        array.push_back(std::move(value));
        return array.size() - 1;
    }

    BinaryParts& binary() { return binary_; }

  private:
    static std::span<const std::byte> bytes_of(const float* data, std::size_t count, int width) {
        return {reinterpret_cast<const std::byte*>(data), count * width * sizeof(float)};
    }
    std::size_t push_view(std::size_t bytes, int target, std::size_t stride) {
        binary_.pad();
        Json view{{"buffer", 0u}, {"byteOffset", binary_.size()}, {"byteLength", bytes}};
        if (stride) view["byteStride"] = stride;
        if (target) view["target"] = target;
        return push("bufferViews", std::move(view));
    }
    std::size_t push_floats(std::size_t view, std::size_t count, int width) {
        static const char* const types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
        return push("accessors", Json{{"bufferView", view},
                                      {"componentType", 5126},
                                      {"count", count},
                                      {"type", types[width]}});
    }

    Json& document_;
    BinaryParts binary_;
};

}  // namespace prep::detail
