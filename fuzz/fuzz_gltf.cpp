#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "invariants.h"
#include "prep/gltf.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    prep::GltfOptions options;
    options.directory = "nowhere";
    const auto scene = prep::parse_gltf(std::as_bytes(std::span(data, size)), options);
    if (scene && !test::broken_promise(*scene).empty()) std::abort();
    return 0;
}
