// The choice among the kernels at run time.
#include <hwy/highway.h>

#include "kernels/kernels.h"

namespace rast::detail {

namespace N_SSE4 {
const Kernels* kernels();
}
namespace N_AVX2 {
const Kernels* kernels();
}
namespace N_AVX3 {
const Kernels* kernels();
}

const Kernels& kernels_for(prep::SimdLevel level) {
    using prep::SimdLevel;
    const auto allowed = [&](SimdLevel candidate) {
        return (level == SimdLevel::automatic || level >= candidate) &&
               prep::simd_available(candidate);
    };
#if HWY_TARGETS & HWY_AVX3
    if (allowed(SimdLevel::avx512)) return *N_AVX3::kernels();
#endif
#if HWY_TARGETS & HWY_AVX2
    if (allowed(SimdLevel::avx2)) return *N_AVX2::kernels();
#endif
#if HWY_TARGETS & HWY_SSE4
    if (allowed(SimdLevel::sse4)) return *N_SSE4::kernels();
#endif
    return scalar_kernels();
}

}  // namespace rast::detail
