// What a rewritten document gets in addition: views and accessors behind the file's own, whose
// bytes are kept apart until everything is packed into one buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

#include "formats/gltf/document.h"

namespace prep::detail {

class AppendedData {
  public:
    explicit AppendedData(Json& json) : json_(json) {}

    std::size_t add_view(std::vector<std::byte> bytes, int target, std::size_t stride) {
        Json view{{"buffer", 0u}, {"byteLength", bytes.size()}};
        if (stride) view["byteStride"] = stride;
        if (target) view["target"] = target;
        Json& list = json_["bufferViews"];
        bytes_.emplace(list.size(), std::move(bytes));
        list.push_back(std::move(view));
        return list.size() - 1;
    }
    std::size_t add_accessor(Json accessor) {
        Json& list = json_["accessors"];
        list.push_back(std::move(accessor));
        return list.size() - 1;
    }

    // Vectors of three or four floats.
    template <class T>
    std::size_t add_floats(const std::vector<T>& values) {
        std::vector<std::byte> bytes(values.size() * sizeof(T));
        std::memcpy(bytes.data(), values.data(), bytes.size());
        return add_accessor(Json{{"bufferView", add_view(std::move(bytes), 34962, 0)},
                                 {"componentType", 5126},
                                 {"count", values.size()},
                                 {"type", sizeof(T) == 12 ? "VEC3" : "VEC4"}});
    }

    std::size_t add_indices(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
        const bool narrow = vertices <= 65535;  // the type's largest value is primitive restart
        std::vector<std::byte> bytes(indices.size() * (narrow ? 2 : 4));
        for (std::size_t i = 0; i < indices.size(); ++i) {
            const std::uint16_t small = std::uint16_t(indices[i]);
            if (narrow)
                std::memcpy(bytes.data() + 2 * i, &small, 2);
            else
                std::memcpy(bytes.data() + 4 * i, &indices[i], 4);
        }
        return add_accessor(Json{{"bufferView", add_view(std::move(bytes), 34963, 0)},
                                 {"componentType", narrow ? 5123 : 5125},
                                 {"count", indices.size()},
                                 {"type", "SCALAR"}});
    }

    // The bytes that are stored for a view that is there already.
    void replace_view(std::size_t view, std::vector<std::byte> bytes) {
        bytes_.insert_or_assign(view, std::move(bytes));
    }

    // Null: the view is the file's own.
    const std::vector<std::byte>* bytes_of(std::size_t view) const {
        const auto found = bytes_.find(view);
        return found == bytes_.end() ? nullptr : &found->second;
    }

  private:
    Json& json_;
    std::map<std::size_t, std::vector<std::byte>> bytes_;  // by bufferView
};

}  // namespace prep::detail
