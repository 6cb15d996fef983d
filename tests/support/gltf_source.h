// glTF documents that tests make: members by hand, data by add().
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "mesh_files.h"
#include "prep/gltf.h"

namespace test {

class GltfSource {
  public:
    using Json = nlohmann::json;
    Json json{{"asset", {{"version", "2.0"}}}};

    std::size_t add_bytes(const void* data, std::size_t size) {
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}});
        bytes_.append(static_cast<const char*>(data), size);
        return json["bufferViews"].size() - 1;
    }

    // Components one after the other; the component type is that of T.
    template <class T>
    std::size_t add(const std::string& type, const std::vector<T>& values,
                    bool normalized = false) {
        const std::size_t width = type == "SCALAR" ? 1
                                  : type == "MAT4" ? 16
                                                   : std::size_t(type.back() - '0');
        Json accessor{{"bufferView", add_bytes(values.data(), values.size() * sizeof(T))},
                      {"componentType", component_type<T>()},
                      {"count", values.size() / width},
                      {"type", type}};
        if (normalized) accessor["normalized"] = true;
        json["accessors"].push_back(accessor);
        return json["accessors"].size() - 1;
    }
    std::size_t add_floats(const std::string& type, const std::vector<float>& values) {
        return add(type, values);
    }
    // With bounds.
    template <class T>
    std::size_t add_positions(const std::vector<T>& values, bool normalized = false) {
        const std::size_t index = add("VEC3", values, normalized);
        Json low = Json::array(), high = Json::array();
        for (std::size_t k = 0; k < 3; ++k) {
            T least = values[k], most = least;
            for (std::size_t i = k; i < values.size(); i += 3) {
                least = std::min(least, values[i]);
                most = std::max(most, values[i]);
            }
            low.push_back(least);
            high.push_back(most);
        }
        json["accessors"][index]["min"] = low;
        json["accessors"][index]["max"] = high;
        return index;
    }

    // Writes the document as GLB or, by the name's ending, as .gltf with a .bin.
    void write(const std::filesystem::path& path) const {
        Json out = json;
        std::string binary = bytes_;
        binary.resize((binary.size() + 3) / 4 * 4);
        if (!binary.empty()) out["buffers"] = {{{"byteLength", binary.size()}}};
        if (path.extension() == ".gltf") {
            std::filesystem::path bin = path;
            bin.replace_extension(".bin");
            if (!binary.empty()) {
                out["buffers"][0]["uri"] = bin.filename().string();
                write_text(bin, binary);
            }
            write_text(path, out.dump());
            return;
        }
        std::string text = out.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const auto word = [](std::size_t n) {
            const std::uint32_t value = std::uint32_t(n);
            return std::string(reinterpret_cast<const char*>(&value), 4);
        };
        std::string chunk;
        if (!binary.empty()) chunk = word(binary.size()) + std::string("BIN\0", 4) + binary;
        write_text(path, "glTF" + word(2) + word(20 + text.size() + chunk.size()) +
                             word(text.size()) + "JSON" + text + chunk);
    }

  private:
    template <class T>
    static constexpr int component_type() {
        if constexpr (std::is_same_v<T, float>) return 5126;
        if constexpr (std::is_same_v<T, std::int8_t>) return 5120;
        if constexpr (std::is_same_v<T, std::uint8_t>) return 5121;
        if constexpr (std::is_same_v<T, std::int16_t>) return 5122;
        if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
        return 5125;
    }
    std::string bytes_;
};

}  // namespace test
