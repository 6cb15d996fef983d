#include <cstddef>
#include <cstdint>
#include <span>

#include "prep/gltf.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    prep::GltfOptions options;
    options.directory = "nowhere";
    (void)prep::parse_gltf(std::as_bytes(std::span(data, size)), options);
    return 0;
}
