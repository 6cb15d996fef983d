#include <cstddef>
#include <cstdint>
#include <string_view>

#include "formats/obj/obj.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)prep::parse_mtl({reinterpret_cast<const char*>(data), size}, "fuzz.mtl", "nowhere");
    return 0;
}
