// Which files are read and written.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace prep {

struct FileFormat {
    std::string_view name;   // "glTF"
    std::string_view title;  // as messages list it: "GLB, glTF"
    // Lower case, with their dot. A file of another ending is known by its first bytes.
    std::vector<std::string_view> endings;
    std::vector<std::string_view> written;  // those of them that save_scene() writes
    bool meshes = true;                     // false: a scene that names files of meshes
};

// In the order of the lists that people see; Assimp, which reads what no other does, is the last.
const std::vector<FileFormat>& file_formats();

// By a path's ending, in capitals or not; null: no format has it.
const FileFormat* file_format(const std::filesystem::path& path);

// By a file's first bytes (512 are looked at); null: they are no format's.
const FileFormat* file_format_of_bytes(std::string_view bytes);

// A path's ending in lower case, with its dot.
std::string lower_ending(const std::filesystem::path& path);

}  // namespace prep
