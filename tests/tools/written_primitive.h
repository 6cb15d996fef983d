// What a glTF file that was written has.
#pragma once

#include <filesystem>
#include <string>

#include "command_runner.h"

namespace test {

// The attributes of the first primitive that was written, and the textures of the materials.
inline std::string written(const std::filesystem::path& file) {
    const nlohmann::json document = nlohmann::json::parse(test::file_text(file), nullptr, false);
    std::string text;
    for (const auto& item : document["meshes"][0]["primitives"][0]["attributes"].items())
        text += item.key() + " ";
    return text + std::to_string(document.value("textures", nlohmann::json::array()).size()) +
           " textures, " +
           std::to_string(document.value("images", nlohmann::json::array()).size()) + " images";
}

}  // namespace test
