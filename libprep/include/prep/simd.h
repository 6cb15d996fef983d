// Which vector instructions a call may use. Results never depend on it: kernels give the scalar
// code's bits. It is there for tests and measurements.
#pragma once

#include <cstdint>
#include <string_view>

namespace prep {

enum class SimdLevel : std::uint8_t {
    automatic,  // the best that this machine has
    scalar,     // plain C++, the reference
    sse4,
    avx2,
    avx512,
};

// Can this machine (and this build) run kernels of that level?
bool simd_available(SimdLevel level);

std::string_view to_string(SimdLevel level);

}  // namespace prep
