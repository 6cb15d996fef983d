#include "shared_data.h"

#include <cstdlib>

namespace test {

std::filesystem::path source_dir() {
    return MESHPREP_SOURCE_DIR;
}

std::optional<std::filesystem::path> shared_dir() {
    std::filesystem::path dir = source_dir() / ".." / "shared";
    if (const char* named = std::getenv("MESHPREP_SHARED")) dir = named;
    std::error_code ec;
    if (!std::filesystem::is_directory(dir / "corpus", ec)) return std::nullopt;
    return std::filesystem::canonical(dir, ec);
}

}  // namespace test
