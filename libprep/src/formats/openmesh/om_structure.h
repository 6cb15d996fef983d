// OM files before OpenMesh sees them: its reader takes counts, sizes and half-edges as they come.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "prep/result.h"
#include "text/name_list.h"

namespace prep::detail {

struct CheckedOm {
    // The file with only the chunks that become part of a mesh (vertices' positions, normals,
    // texture coordinates and colours of three bytes, connectivity): OpenMesh, as Debian builds it,
    // ends the process on others that are not as it expects.
    std::string bytes;
    NameList left_out;  // the other chunks
};

// Walks the chunks of an OM file (version 2, what OpenMesh 6 and later write; little-endian) and
// holds every size against the bytes that are there and every half-edge, vertex and face index
// against the counts in the header. Errors: syntax, unsupported; place = "name, byte N". Chunks of
// unknown kind are refused. O(bytes).
Result<CheckedOm> checked_om(std::span<const std::byte> bytes, const std::string& name);

}  // namespace prep::detail
