// Stands at the head of what every benchmark prints.
#include <benchmark/benchmark.h>

namespace {

// Debian builds the benchmark library without NDEBUG, and the library warns of that.
[[maybe_unused]] const bool said = [] {
    benchmark::AddCustomContext(
        "\"built as DEBUG\"",
        "concerns Debian's benchmark library and its own loop alone; what is "
        "measured is built as CMAKE_BUILD_TYPE says");
    return true;
}();

}  // namespace
