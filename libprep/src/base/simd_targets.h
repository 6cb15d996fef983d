// The instruction sets of this machine.
#pragma once

#include <cstdint>

namespace prep::detail {

// As hwy::SupportedTargets, but asked once: in a virtual machine each question costs microseconds.
std::int64_t machine_targets();

}  // namespace prep::detail
