// glTF documents that tests write to files: members by hand, data by add().
#pragma once

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "gltf_maker.h"
#include "mesh_files.h"

namespace test {

class GltfSource : public GltfMaker {
  public:
    // As text, so that initializer lists stay short: components one after the other.
    template <class T>
    std::size_t add(const std::string& type, const std::vector<T>& values,
                    bool normalized = false) {
        return accessor(values, type.c_str(), normalized);
    }
    std::size_t add_floats(const std::string& type, const std::vector<float>& values) {
        return add(type, values);
    }
    // With bounds.
    std::size_t add_positions(const std::vector<float>& values) {
        const std::size_t index = add("VEC3", values);
        for (const bool least : {true, false}) {
            Json bounds = Json::array();
            for (std::size_t k = 0; k < 3; ++k) {
                float bound = values[k];
                for (std::size_t i = k; i < values.size(); i += 3)
                    bound = least ? std::min(bound, values[i]) : std::max(bound, values[i]);
                bounds.push_back(bound);
            }
            json["accessors"][index][least ? "min" : "max"] = std::move(bounds);
        }
        return index;
    }
    std::size_t add_bytes(const void* data, std::size_t size) {
        return view(std::span(static_cast<const std::byte*>(data), size));
    }

    // As GLB or, by the name's ending, as JSON.
    void write(const std::filesystem::path& path) const {
        write_text(path, path.extension() == ".gltf" ? gltf() : glb());
    }
};

}  // namespace test
