// glTF 2.0 and GLB.
//
// The document is kept as JSON (nlohmann) with its buffers, decoded by accessor code of our own.
// tinygltf is not used: its errors carry no place, and it writes back only what it has a type for.
// Here every error names a JSON pointer, and what is not understood goes back as it came.
//
// Read: all primitive modes, sparse accessors, KHR_mesh_quantization, KHR_texture_transform,
// KHR_lights_punctual, KHR_materials_unlit, KHR_materials_specular,
// KHR_materials_ior, KHR_materials_emissive_strength, EXT_meshopt_compression,
// KHR_draco_mesh_compression, EXT_texture_webp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "prep/load.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace prep {

struct GltfOptions {
    std::string name = "memory.gltf";  // for messages
    std::filesystem::path directory;   // where external buffers and images are looked up
    std::vector<std::string> allowed_extensions = {};             // as LoadOptions'
    std::vector<std::filesystem::path> texture_directories = {};  // and images that are not there
    int threads = 0;  // 0: all cores; the result does not depend on it
};

// GLB or JSON, told apart by the first bytes. One Mesh per glTF mesh: its primitives are parts, so
// that normals can be smooth across them. Errors: io (a buffer file), syntax, invalid, unsupported
// (a required extension), limit; place = "name#/json/pointer".
Result<Scene> parse_gltf(std::span<const std::byte> bytes, const GltfOptions& options = {});
Result<Scene> load_gltf(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace prep
