#include <cstddef>
#include <cstdint>
#include <span>

#include "prep/mesh_files.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)prep::parse_stl(std::as_bytes(std::span(data, size)), "fuzz.stl");
    return 0;
}
