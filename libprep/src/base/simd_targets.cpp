#include "base/simd_targets.h"

#include <hwy/targets.h>

namespace prep::detail {

std::int64_t machine_targets() {
    static const std::int64_t targets = hwy::SupportedTargets();
    return targets;
}

}  // namespace prep::detail
