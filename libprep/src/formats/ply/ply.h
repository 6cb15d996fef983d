// PLY in.
//
// PLY, STL and OFF are read by parsers of our own. OpenMesh 9's are not used for them. Measured:
// they give faces that make an edge non-manifold copies of their vertices and keep no map back,
// drop faces with a repeated or missing vertex, round coordinates to float even for a mesh of
// doubles, reserve what a header announces (262 MB for 23 bytes of OFF), and call a file that ends
// too early a success. Ours say what the file says and hold every count against the bytes that are
// there before anything is reserved.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "prep/result.h"
#include "prep/scene.h"

namespace prep {

namespace detail {
class PictureSearch;
}

// ASCII and both binary orders. Vertex properties x y z, nx ny nz, red green blue alpha (integers
// are sRGB-encoded 0 … max, floats linear 0 … 1), s t / u v / texture_u texture_v; face lists
// vertex_indices / vertex_index, per-corner "texcoord" lists, "texnumber", red green blue alpha of
// faces where vertices have no colours; tristrips; edges; other elements and properties are
// skipped. A file without faces is a point cloud. Each "comment TextureFile NAME", as MeshLab and
// others write it, is a material with that picture for its colour; texnumber says which of them a
// face has, the first where it is missing, none where it is negative or (told) beyond the last.
//
// One mesh and one node. `name` is for messages. Errors: syntax, invalid (an index out of range),
// unsupported, limit; place = "name:line" in text and "name, byte N" in binary files.
Result<Scene> parse_ply(std::span<const std::byte> bytes, const std::string& name);
// With the files of textures, which `pictures` finds; in memory they are named alone. On at most
// `threads` threads (0: all cores), which does not change the result.
Result<Scene> parse_ply(std::span<const std::byte> bytes, const std::string& name,
                        detail::PictureSearch* pictures, int threads);

}  // namespace prep
