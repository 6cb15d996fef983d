// A directory in the system's one for temporary files that is this process' alone: nobody else can
// have put a file or a link where it writes.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "prep/result.h"

namespace prep::detail {

// Goes again with what is in it. path() is empty where none can be made.
class OwnDirectory {
  public:
    OwnDirectory() {
        std::error_code failed;
        const std::filesystem::path temporary = std::filesystem::temp_directory_path(failed);
        std::string name = (temporary / "meshprep-XXXXXX").string();
        if (!failed && ::mkdtemp(name.data())) path_ = name;
    }
    ~OwnDirectory() {
        std::error_code ignored;
        if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
    }
    OwnDirectory(const OwnDirectory&) = delete;
    OwnDirectory& operator=(const OwnDirectory&) = delete;

    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

inline Error no_own_directory(const std::string& place) {
    return {ErrorCode::io, "there is no directory for temporary files; set TMPDIR", place};
}

}  // namespace prep::detail
