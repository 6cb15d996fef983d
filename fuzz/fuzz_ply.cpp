#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "formats/ply/ply.h"
#include "invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto scene = prep::parse_ply(std::as_bytes(std::span(data, size)), "fuzz.ply");
    if (scene && !test::broken_promise(*scene).empty()) std::abort();
    return 0;
}
