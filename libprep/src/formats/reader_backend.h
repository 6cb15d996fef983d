// What the library of readers of this project (reader_backend.cpp, with the folders assimp and
// openmesh; loaded when a file first needs it) offers to libprep. Both sides come from one build.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "prep/load.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace prep::detail {

// Those of foreign_files.h, on the side of the library.
Result<Scene> read_om(std::span<const std::byte> bytes, const std::filesystem::path& path);
Result<Scene> read_with_assimp(const std::filesystem::path& path, const LoadOptions& options);
bool assimp_knows(const std::string& extension);

struct ReaderBackend {
    Result<Scene> (*om)(std::span<const std::byte>, const std::filesystem::path&);
    Result<Scene> (*with_assimp)(const std::filesystem::path&, const LoadOptions&);
    bool (*assimp_knows)(const std::string& extension);
};

}  // namespace prep::detail
