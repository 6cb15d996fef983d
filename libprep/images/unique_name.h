// What image reading and image writing share.
#pragma once

#include <string>

namespace prep::detail {

// "stem.PID-COUNT" + ending, not used by any other call of this process.
std::string unique_name(const std::string& stem, const std::string& ending);

}  // namespace prep::detail
