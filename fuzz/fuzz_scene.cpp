// The JSON scene; files that it refers to are not there.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "invariants.h"
#include "prep/scene_json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    prep::LoadOptions options;
    options.threads = 1;
    const auto scene = prep::parse_scene_json({reinterpret_cast<const char*>(data), size},
                                              "nowhere/scene.json", options);
    if (scene && !test::broken_promise(scene->scene).empty()) std::abort();
    return 0;
}
