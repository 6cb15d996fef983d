// Formats that other libraries read for us: with a library of our own (reader_backend.h), which
// each of these loads where nothing has before. Errors of all: io (that library is not there, or is
// another build's).
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "prep/load.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace prep::detail {

// OpenMesh's own OM format, through OpenMesh::IO, after the file's counts were held against its
// size.
Result<Scene> load_om(std::span<const std::byte> bytes, const std::filesystem::path& path);

// Whatever Assimp knows (FBX, DAE, 3DS, BLEND, …): meshes, materials, textures, nodes, cameras and
// lights. Normals stay as authored; nothing is joined, split or triangulated.
Result<Scene> load_with_assimp(const std::filesystem::path& path, const LoadOptions& options = {});
// Whether Assimp claims this ending (with its dot, lower case).
Result<bool> assimp_reads(const std::string& extension);

// Loads the library now, where the first file should not have to wait for it, or has limits.
Result<void> open_foreign_readers();

}  // namespace prep::detail
