#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "formats/obj/obj.h"
#include "invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    prep::ObjOptions options;
    options.read_materials = false;  // no files
    options.threads = 1;
    const auto scene = prep::parse_obj(std::as_bytes(std::span(data, size)), options);
    if (scene && !test::broken_promise(*scene).empty()) std::abort();
    return 0;
}
