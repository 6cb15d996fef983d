#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "formats/off/off.h"
#include "invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto scene = prep::parse_off(std::as_bytes(std::span(data, size)), "fuzz.off");
    if (scene && !test::broken_promise(*scene).empty()) std::abort();
    return 0;
}
