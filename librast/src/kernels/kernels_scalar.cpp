#include <cstring>
#include <type_traits>

#include "geometry/homogeneous_triangle.h"
#include "kernels/kernels.h"

// Helpers of the kernels stay in registers; calls would spill every vector.
#define RAST_INLINE inline __attribute__((always_inline))
#include "kernels/lanes_scalar.h"

namespace rast::detail {
namespace {

using namespace rast::detail::scalar_lanes;

#include "kernels/kernels-inl.h"

}  // namespace

const Kernels& scalar_kernels() {
    return kernel_table;
}

}  // namespace rast::detail
