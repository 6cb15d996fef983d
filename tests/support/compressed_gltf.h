// glTF files that are written compressed, and what tests ask of them.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "written_gltf.h"

namespace test {

inline void save(const std::filesystem::path& from, const std::filesystem::path& to,
                 prep::Compression compression, const prep::PrepareOptions& options = {}) {
    auto scene = prep::load_scene(from);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    auto prepared = prep::prepare(*std::move(scene), options);
    ASSERT_TRUE(prepared.has_value()) << prep::to_string(prepared.error());
    prep::SaveOptions saving;
    saving.compression = compression;
    const auto notes = prep::save_scene(*prepared, to, saving);
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
}

// Bytes of a GLB but for its pictures, which no codec of vertices concerns.
inline std::uint64_t bytes_without_pictures(const std::filesystem::path& file) {
    const GltfFile glb(file);
    std::uint64_t bytes = std::filesystem::file_size(file);
    if (glb.json.contains("images"))
        for (const nlohmann::json& image : glb.json["images"])
            if (image.contains("bufferView"))
                bytes -= glb.json["bufferViews"][image["bufferView"].get<std::size_t>()]
                             .at("byteLength")
                             .get<std::uint64_t>();
    return bytes;
}

// Bytes of the attributes and those of targets that `after` has and `before` has not, as floats.
// Both have the same meshes and primitives.
inline std::uint64_t added_bytes(const std::filesystem::path& before,
                                 const std::filesystem::path& after) {
    const GltfFile a(before), b(after);
    std::uint64_t bytes = 0;
    const auto add = [&](const nlohmann::json& was, const nlohmann::json& is) {
        for (const auto& item : is.items()) {
            if (was.contains(item.key())) continue;
            const nlohmann::json& accessor = b.json["accessors"][item.value().get<std::size_t>()];
            bytes +=
                accessor["count"].get<std::uint64_t>() * (accessor["type"] == "VEC3" ? 12u : 16u);
        }
    };
    for (std::size_t m = 0; m < b.json["meshes"].size(); ++m)
        for (std::size_t p = 0; p < b.json["meshes"][m]["primitives"].size(); ++p) {
            const nlohmann::json &was = a.json["meshes"][m]["primitives"][p],
                                 &is = b.json["meshes"][m]["primitives"][p];
            add(was["attributes"], is["attributes"]);
            if (!is.contains("targets")) continue;
            for (std::size_t t = 0; t < is["targets"].size(); ++t)
                add(was["targets"][t], is["targets"][t]);
        }
    return bytes;
}

// How the first primitive's data were made, by the head of the data themselves.
inline bool by_edgebreaker(const std::filesystem::path& file) {
    const GltfFile glb(file);
    const std::string data = glb.view_bytes(
        glb.primitive(0, 0)
            .at(nlohmann::json::json_pointer("/extensions/KHR_draco_mesh_compression/bufferView"))
            .get<std::size_t>());
    return data.at(8) == 1;
}

}  // namespace test
