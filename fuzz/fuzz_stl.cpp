#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "formats/stl/stl.h"
#include "invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto scene = prep::parse_stl(std::as_bytes(std::span(data, size)), "fuzz.stl");
    if (scene && !test::broken_promise(*scene).empty()) std::abort();
    return 0;
}
