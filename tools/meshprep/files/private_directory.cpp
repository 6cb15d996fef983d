#include "meshprep/files/private_directory.h"

#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <string>

namespace meshprep {
namespace {

namespace fs = std::filesystem;

struct Registry {
    std::mutex mutex;
    std::set<fs::path> paths;
    bool ended = false;
};

Registry& registry() {
    static Registry* const all = new Registry;  // never destroyed: signal threads outlive main
    return *all;
}

}  // namespace

prep::Result<PrivateDirectory> PrivateDirectory::make() {
    std::error_code ec;
    const fs::path parent = fs::temp_directory_path(ec);
    if (ec)
        return prep::Error{
            prep::ErrorCode::io,
            "there is no directory for temporary files: " + ec.message() + "; set TMPDIR to one",
            ""};
    std::string name = (parent / "meshprep-XXXXXX").string();
    Registry& all = registry();
    const std::lock_guard lock(all.mutex);  // never a directory that is there and not in the list
    if (all.ended || !::mkdtemp(name.data()))
        return prep::Error{prep::ErrorCode::io,
                           std::string("cannot make a directory for temporary files: ") +
                               std::strerror(all.ended ? ECANCELED : errno) +
                               "; set TMPDIR to where one can be made",
                           parent.string()};
    all.paths.insert(name);
    return PrivateDirectory(name);
}

PrivateDirectory::PrivateDirectory(PrivateDirectory&& other) noexcept
    : path_(std::move(other.path_)) {
    other.path_.clear();
}

PrivateDirectory::~PrivateDirectory() {
    if (path_.empty()) return;
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    const std::lock_guard lock(registry().mutex);
    registry().paths.erase(path_);
}

void remove_private_directories() {
    Registry& all = registry();
    const std::lock_guard lock(all.mutex);
    all.ended = true;
    std::error_code ignored;
    for (const fs::path& path : all.paths) {
        // Other threads may still be writing there: a second pass finds what came meanwhile.
        for (int pass = 0; pass < 8 && fs::exists(path, ignored); ++pass)
            fs::remove_all(path, ignored);
    }
}

}  // namespace meshprep
