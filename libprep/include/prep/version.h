// The library's version, and the packages that this build was made with.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace prep {

std::string_view version();  // as in "0.1.0"

struct Dependency {
    std::string name, version, licence;
};

// By name, for `--version` and bug reports. Versions are those of the headers, or the package,
// that this library was compiled with.
std::vector<Dependency> dependencies();

}  // namespace prep
