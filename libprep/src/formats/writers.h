// The writers behind save_scene, one per format. Each returns notes on what the format cannot hold.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/atomic_files.h"
#include "prep/save.h"

namespace prep::detail {

using WriteResult = Result<std::vector<std::string>>;

// What an output may replace.
FileSetRules rules_for(const PreparedScene& prepared, const std::filesystem::path& path,
                       const SaveOptions& options);

// Whether the triangles of a mesh are in another order than its faces.
bool is_reordered(const PreparedScene& prepared);

// Says how many group names a format without groups loses; nothing where there are none.
void note_groups(const PreparedScene& prepared, const std::string& format,
                 std::vector<std::string>& notes);

WriteResult write_gltf(const PreparedScene& prepared, const std::filesystem::path& path,
                       const SaveOptions& options);
WriteResult write_obj(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options);
WriteResult write_ply(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options);
WriteResult write_stl(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options);
WriteResult write_off(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options);

}  // namespace prep::detail
