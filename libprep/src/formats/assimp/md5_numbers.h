// MD5 meshes number their statements, and Assimp 5.2 makes lists as long as these numbers say.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace prep::detail {

struct Md5Excess {
    std::size_t line = 1;
    std::string statement;  // "tri 4294967295"
};

// The first statement (`vert`, `tri`, `weight` and the counts of them, of joints and of meshes)
// whose number is beyond what a file of as many bytes can hold: Assimp takes it modulo 2^32, adds
// 1, and writes outside the list where that is 0.
std::optional<Md5Excess> md5_excess(std::string_view text);

}  // namespace prep::detail
