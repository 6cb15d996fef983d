// The packages this build was made with, for `--version` and bug reports.
#pragma once

#include <string>
#include <vector>

namespace prep {

struct Dependency {
    std::string name, version, licence;
};

// By name. Versions are those of the headers this library was compiled with.
std::vector<Dependency> dependencies();

}  // namespace prep
