// The library's version, as in "0.1.0".
#pragma once

#include <string_view>

namespace prep {
std::string_view version();
}
