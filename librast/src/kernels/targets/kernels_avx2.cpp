// The kernels for AVX2.
#include <cstring>
#include <type_traits>

#include "geometry/homogeneous_triangle.h"
#include "kernels/kernels.h"

// Helpers of the kernels stay in registers; calls would spill every vector.
#define RAST_INLINE inline __attribute__((always_inline))

#define RAST_KERNEL_TARGET HWY_AVX2
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/targets/kernels_of_target-inl.h"
#include <hwy/foreach_target.h>
// Once more, for the lowest set.
#include "kernels/targets/kernels_of_target-inl.h"
