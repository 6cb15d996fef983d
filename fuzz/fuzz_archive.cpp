#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <span>

#include "meshprep/files/archive.h"
#include "prep/files.h"

namespace {

namespace fs = std::filesystem;

// Everything that was unpacked stands below `directory`, and is no more than the limits let by.
bool contained(const fs::path& directory, std::uint64_t most) {
    std::uint64_t total = 0;
    std::error_code ec;
    for (fs::recursive_directory_iterator it(directory, ec), end; !ec && it != end;
         it.increment(ec)) {
        if (it->is_symlink(ec)) return false;
        if (it->is_regular_file(ec)) total += it->file_size(ec);
    }
    return total <= most;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string name = (fs::temp_directory_path() / "meshprep-fuzz-XXXXXX").string();
    if (!::mkdtemp(name.data())) return 0;
    const fs::path outer = name, inner = outer / "a" / "b", archive = outer / "archive";
    fs::create_directories(inner);
    meshprep::ArchiveLimits limits;
    limits.always = std::uint64_t(1) << 20;
    limits.ratio = 20;
    const std::uint64_t most = limits.of(size);
    if (!prep::write_file(archive, std::as_bytes(std::span(data, size)))) std::abort();
    (void)meshprep::unpack_zip(archive, inner, limits);
    (void)meshprep::unpack_gzip(archive, inner / "unpacked.gzip.member", limits);
    // Beside the archive and the two folders nothing has appeared outside.
    const auto count = [](const fs::path& folder) {
        return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
    };
    const bool good = contained(inner, 2 * most) && count(outer) == 2 && count(outer / "a") == 1;
    std::error_code ignored;
    fs::remove_all(outer, ignored);
    if (!good) std::abort();
    return 0;
}
