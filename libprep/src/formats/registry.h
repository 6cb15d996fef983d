// The formats: one row each.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "formats/writers.h"
#include "prep/formats.h"
#include "prep/load.h"

namespace prep::detail {

// What a writer cannot keep is said in the notes of save_scene().
struct FormatHolds {
    bool compression = false;     // of vertices and triangles
    bool triangle_order = false;  // that of PreparedScene::meshes
    bool everything = false;      // the writer says itself what it leaves out
    bool corner_values = true;    // values by corner; false: by split vertex
    bool uvs = true;
    bool partial_uvs = false;  // those of some corners alone
    bool float_colors = true;  // false: none, or integers
    bool materials = false;
    bool subdivision = false;  // its tags
};

struct Format {
    FileFormat file;
    bool (*sniff)(std::string_view head);  // by the first 512 bytes; null: by ending alone
    Result<Scene> (*load)(const std::filesystem::path&, const LoadOptions&);
    WriteResult (*write)(const PreparedScene&, const std::filesystem::path&, const SaveOptions&);
    FormatHolds holds;
    // The library that reads it, which may crash or hang on a damaged file: in a process of its own
    // where that is asked for. Null: we do.
    const char* foreign_reader = nullptr;
};

// The order is that of file_formats(), and that in which first bytes are looked at.
const std::vector<Format>& formats();

// Null: none reads, or none writes, this ending (lower case, with its dot). Errors: io (the ending
// is none of the table, and what Assimp claims cannot be asked).
Result<const Format*> format_that_reads(std::string_view ending);
const Format* format_that_writes(std::string_view ending);

// By the first bytes; null: none.
const Format* format_of_bytes(std::string_view bytes);

// "GLB, glTF, OBJ and OFF": those that are read, or written.
std::string format_titles(bool written);

}  // namespace prep::detail
