// Loading any supported mesh file, and what all loaders and writers share.
//
// Formats in: OBJ+MTL, PLY, STL, OFF, OM, glTF 2.0/GLB, and what Assimp reads for other endings.
// Formats out: GLB, glTF, OBJ+MTL, PLY, STL, OFF (save.h, after prepare()).
// A loader says what the file says: no welding, no repair, no triangulation. Coordinates are parsed
// in double; rebase() decides about `origin`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "prep/result.h"
#include "prep/scene.h"

namespace prep {

struct LoadOptions {
    int threads = 0;  // 0: all cores; the result does not depend on it
};

// By ending, with a look at the first bytes where the ending is unknown.
// Errors: io, syntax (place = file:line or file#/json/path), unsupported, limit.
Result<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options = {});

// The whole file. Errors: io, limit (over 2^40 bytes).
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path);

// Writes to a temporary name beside `path`, then renames: complete or not at all.
Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

// For a process that is told to end: waits for files that are just getting their names, then
// removes the temporary files of writes that are under way in any thread. Their results are errors
// from now on, and so is every later write. Returns how many files there were.
std::size_t discard_unfinished_files();

// Positions parsed in double → mesh.positions (float, about mesh.origin). The origin is the centre
// of the bounding box, rounded to a power of two of 1/32 to 1/16 of the box's diagonal (so that
// writing and reading again keeps every bit), when its distance from zero is more than 8× the box's
// diagonal and at least one coordinate is not exactly a float that survives unharmed; otherwise
// zero, so that float input keeps its exact bits. Non-finite coordinates do not take part in the
// box and are kept.
void set_positions(Mesh& mesh, std::span<const glm::dvec3> positions);

}  // namespace prep
