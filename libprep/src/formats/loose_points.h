// Points of formats whose vertices have normals and UVs: a mesh has those of faces alone.
#pragma once

#include <string>

namespace prep::detail {

// The warning of what points had, behind the file's name.
inline std::string values_of_points_left_out(bool normals, bool uvs) {
    return std::string(normals && uvs ? ": normals and UVs"
                       : normals      ? ": normals"
                                      : ": UVs") +
           " of points were not taken: only faces have them here";
}

}  // namespace prep::detail
