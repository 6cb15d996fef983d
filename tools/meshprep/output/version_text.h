// What `meshprep --version` prints: our version, every package's version and licence.
#pragma once

#include <string>

namespace meshprep {
std::string version_text();
}
