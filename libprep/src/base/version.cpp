#include "prep/version.h"

namespace prep {
std::string_view version() {
    return MESHPREP_VERSION;
}
}  // namespace prep
