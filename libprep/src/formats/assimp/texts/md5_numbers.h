// MD5 meshes number their statements, and Assimp 5.2 makes lists as long as these numbers say.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace prep::detail {

struct Md5Excess {
    std::size_t line = 1;
    std::string statement;  // as far as that number: "tri 4294967295"
};

// The first statement (`vert`, `tri`, `weight`; the counts of them, of joints and of meshes) with
// an integer beyond what a file of as many bytes can hold. Assimp takes its number modulo 2^32,
// adds 1, and writes outside the list where that is 0; what others of them name it does not look up
// in range.
std::optional<Md5Excess> md5_excess(std::string_view text);

}  // namespace prep::detail
