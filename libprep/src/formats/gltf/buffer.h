// The binary half of a glTF file while it is being written: bufferViews and accessors appended in
// order, aligned as the format asks.
#pragma once

#include <cstddef>
#include <cstring>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

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
        bytes_.resize((bytes_.size() + 3) & ~std::size_t(3));
        Json view{{"buffer", 0u}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
        if (stride) view["byteStride"] = stride;
        if (target) view["target"] = target;
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        return push("bufferViews", std::move(view));
    }

    // Floats, `width` to an element. Returns the accessor's index.
    std::size_t add_floats(const float* data, std::size_t count, int width) {
        static const char* const types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
        const std::size_t view =
            add_view({reinterpret_cast<const std::byte*>(data), count * width * sizeof(float)},
                     array_buffer);
        return push("accessors", Json{{"bufferView", view},
                                      {"componentType", 5126},
                                      {"count", count},
                                      {"type", types[width]}});
    }

    // The smallest type that holds them; the largest value of a type is primitive restart.
    std::size_t add_indices(std::span<const std::uint32_t> indices, std::size_t vertices) {
        std::size_t view = 0;
        const bool narrow = vertices <= 65535;
        if (narrow) {
            std::vector<std::uint16_t> small(indices.begin(), indices.end());
            view = add_view(std::as_bytes(std::span(small)), element_array_buffer);
        } else {
            view = add_view(std::as_bytes(indices), element_array_buffer);
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

    std::vector<std::byte>& bytes() { return bytes_; }

  private:
    Json& document_;
    std::vector<std::byte> bytes_;
};

}  // namespace prep::detail
