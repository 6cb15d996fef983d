#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "formats/reader_backend.h"
#include "invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto scene = prep::detail::read_om(std::as_bytes(std::span(data, size)), "fuzz.om");
    if (scene && !test::broken_promise(*scene).empty()) std::abort();
    return 0;
}
