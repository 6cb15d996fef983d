#include "npm_tools.h"

#include <cstdlib>

#include "shared_data.h"

namespace test {

std::optional<std::filesystem::path> npm_package(const std::string& name) {
    static const bool node_present = std::system("node --version >/dev/null 2>&1") == 0;
    std::filesystem::path dir = source_dir() / "build/npm-tools";
    if (const char* named = std::getenv("MESHPREP_NPM_TOOLS")) dir = named;
    dir = dir / "node_modules" / name;
    std::error_code ec;
    if (!node_present || !std::filesystem::is_directory(dir, ec)) return std::nullopt;
    return dir;
}

}  // namespace test
