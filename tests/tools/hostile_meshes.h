// Meshes that a request for an error has to survive.
#pragma once

#include <filesystem>

#include "command_runner.h"

namespace test {

// nan.obj: a position that is no number. flat.obj: a face without area. far.obj: a huge place.
// twice.obj: faces upon each other.
inline void write_hostile_meshes(const std::filesystem::path& folder) {
    write_text(folder / "nan.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\n");
    write_text(folder / "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
    write_text(folder / "far.obj",
               "v 1e7 1e7 0\nv 10000001 1e7 0\nv 1e7 10000001 0\nv 10000001 10000001 0\n"
               "f 1 2 3\nf 2 4 3\n");
    write_text(folder / "twice.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\nf 3 2 1\nf 1 2 3\n");
}

}  // namespace test
