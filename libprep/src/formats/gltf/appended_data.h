// What a rewritten document gets in addition: views and accessors behind the file's own, whose
// bytes are kept apart until everything is packed into one buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "base/shared_bytes.h"
#include "formats/gltf/document.h"

namespace prep::detail {

class AppendedData {
  public:
    explicit AppendedData(Json& json) : json_(json) {}

    std::size_t add_view(SharedBytes bytes, int target, std::size_t stride) {
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

    // Vectors of `width` floats: 3 or 4.
    std::size_t add_floats(SharedBytes vectors, int width) {
        const std::size_t count = vectors.size() / (std::size_t(width) * sizeof(float));
        return add_accessor(Json{{"bufferView", add_view(std::move(vectors), 34962, 0)},
                                 {"componentType", 5126},
                                 {"count", count},
                                 {"type", width == 3 ? "VEC3" : "VEC4"}});
    }
    template <class T>
    std::size_t add_floats(std::vector<T> values) {
        return add_floats(SharedBytes::of(std::move(values)), int(T::length()));
    }

    // `kept`: the indices' own bytes, where they are kept anyway.
    std::size_t add_indices(std::span<const std::uint32_t> indices, std::size_t vertices,
                            SharedBytes kept = {}) {
        const bool narrow = vertices <= 65535;  // the type's largest value is primitive restart
        if (narrow)
            kept = SharedBytes::of(std::vector<std::uint16_t>(indices.begin(), indices.end()));
        else if (kept.empty())
            kept = SharedBytes::of(std::vector<std::uint32_t>(indices.begin(), indices.end()));
        return add_accessor(Json{{"bufferView", add_view(std::move(kept), 34963, 0)},
                                 {"componentType", narrow ? 5123 : 5125},
                                 {"count", indices.size()},
                                 {"type", "SCALAR"}});
    }

    // The bytes that are stored for a view that is there already.
    void replace_view(std::size_t view, SharedBytes bytes) {
        bytes_.insert_or_assign(view, std::move(bytes));
    }

    // Null: the view is the file's own.
    const SharedBytes* bytes_of(std::size_t view) const {
        const auto found = bytes_.find(view);
        return found == bytes_.end() ? nullptr : &found->second;
    }

  private:
    Json& json_;
    std::map<std::size_t, SharedBytes> bytes_;  // by bufferView
};

}  // namespace prep::detail
