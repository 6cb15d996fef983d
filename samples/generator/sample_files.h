// The samples' generator: each function makes one sample as files in memory, the same bytes on
// every machine. Only + − · / and square roots of doubles are used (repeatable.h has the rest), no
// random numbers but an integer hash.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace samples {

struct File {
    std::string name;  // relative to the samples' folder, with '/'
    std::string bytes;
};

// A flanged hub with bolt holes, chamfers, a fillet and three bolts: OBJ + MTL with quads, concave
// polygons and smoothing groups. Closed and manifold.
std::vector<File> machine_part();

// An octopus as the level set of a smooth field: binary PLY, quads, no UVs, one closed surface.
std::vector<File> octopus();

// A heater shield whose left half repeats the right half's UVs, mirrored; diffuse and normal map
// from one height function: glTF + bin + PNG. No normals, no tangents: they are prepare's work.
std::vector<File> shield();

// The corner of a room with brick walls, a tiled floor, a pedestal and a vase, two lights and a
// camera: glTF + bin + PNG.
std::vector<File> room();

}  // namespace samples
