#include "meshprep/files/output_directories.h"

#include <algorithm>

namespace meshprep {

namespace fs = std::filesystem;
using prep::Error;
using prep::ErrorCode;
using prep::Result;

OutputDirectories::~OutputDirectories() {
    std::error_code ignored;
    // Fails for those that hold something, which is what is wanted.
    for (auto at = made_.rbegin(); at != made_.rend(); ++at)
        if (fs::is_empty(*at, ignored) && !ignored) fs::remove(*at, ignored);
}

Result<void> OutputDirectories::make(const fs::path& directory) {
    const std::lock_guard lock(mutex_);
    std::error_code ec;
    std::vector<fs::path> absent;  // deepest first
    fs::path at = directory.has_filename() ? directory : directory.parent_path();
    while (!at.empty() && !fs::is_directory(at, ec)) {
        if (fs::exists(fs::symlink_status(at, ec)))
            return Error{ErrorCode::io, "a file of this name is in the way of the output directory",
                         at.string()};
        absent.push_back(at);
        at = at.parent_path();
    }
    std::reverse(absent.begin(), absent.end());
    for (const fs::path& path : absent) {
        if (path.filename() == "." || path.filename() == "..") continue;
        const bool fresh = fs::create_directory(path, ec);
        if (ec)
            return Error{ErrorCode::io, "cannot make the directory: " + ec.message(),
                         path.string()};
        if (fresh) made_.push_back(path);
    }
    return {};
}

Result<void> OutputDirectories::make_for(const fs::path& file) {
    return file.has_parent_path() ? make(file.parent_path()) : Result<void>();
}

}  // namespace meshprep
