#include "rast/version.h"

namespace rast {
std::string_view version() {
    return MESHPREP_VERSION;
}
}  // namespace rast
