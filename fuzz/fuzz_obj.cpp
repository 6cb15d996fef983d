#include <cstddef>
#include <cstdint>
#include <span>

#include "prep/obj.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    prep::ObjOptions options;
    options.read_materials = false;  // no files
    options.threads = 1;
    (void)prep::parse_obj(std::as_bytes(std::span(data, size)), options);
    return 0;
}
