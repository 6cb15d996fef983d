// How large files are.
#pragma once

#include <cstdint>
#include <filesystem>

#include "prep/scene.h"

namespace meshprep {

// 0 where there is no such file.
std::uint64_t bytes_of(const std::filesystem::path& file);
// A scene's file and all that were read with it.
std::uint64_t bytes_of(const std::filesystem::path& file, const prep::Scene& scene);

}  // namespace meshprep
