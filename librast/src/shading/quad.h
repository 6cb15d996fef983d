// The four channels of a texel at once: vectors of the compiler's own (GCC, clang), whose elements
// come out as if they were computed one by one.
#pragma once

#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>

namespace rast {

using Quad = float __attribute__((vector_size(16)));
using Codes = std::int32_t __attribute__((vector_size(16)));

inline Quad load_quad(const float* from) {
    Quad q;
    std::memcpy(&q, from, sizeof q);
    return q;
}
inline Codes load_codes(const std::int16_t* from) {
    std::int16_t __attribute__((vector_size(8))) narrow;
    std::memcpy(&narrow, from, sizeof narrow);
    return __builtin_convertvector(narrow, Codes);
}
inline Quad to_quad(Codes codes) {
    return __builtin_convertvector(codes, Quad);
}
inline glm::vec4 to_vec4(Quad q) {
    return {q[0], q[1], q[2], q[3]};
}

}  // namespace rast
