// The kernels for RAST_KERNEL_TARGET, from a source that foreach_target.h includes once per
// instruction set: each set is compiled by a file of its own, since one for all takes the longest
// of the whole build.
#include <hwy/cache_control.h>
#include <hwy/highway.h>  // by every set: it counts them

#if HWY_TARGET == RAST_KERNEL_TARGET
HWY_BEFORE_NAMESPACE();
namespace rast::detail::HWY_NAMESPACE {
namespace {

// clang-format off
#include "kernels/lanes_highway-inl.h"
#include "kernels/kernels-inl.h"
// clang-format on

}  // namespace

const Kernels* kernels() {
    return &kernel_table;
}

}  // namespace rast::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
