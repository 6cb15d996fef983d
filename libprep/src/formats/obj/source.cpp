#include "formats/obj/source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/read_open_file.h"
#include "prep/files.h"

namespace prep::detail {

bool ObjMemory::read(std::size_t begin, std::size_t end, char* to) const {
    text_.copy(to, end - begin, begin);
    return true;
}

ObjFile::~ObjFile() {
    if (file_ >= 0) ::close(file_);
}

Result<void> ObjFile::open(const std::filesystem::path& path) {
    struct stat info {};
    file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file_ >= 0 && ::fstat(file_, &info) == 0 && S_ISREG(info.st_mode)) {
        size_ = std::size_t(info.st_size);
        return {};
    }
    // Says what is wrong, or reads what has no size; a pipe that is closed is lost to its writer.
    auto bytes = file_ < 0 ? read_file(path) : read_open_file(file_, path);
    if (file_ >= 0) ::close(std::exchange(file_, -1));
    if (!bytes) return std::move(bytes).error();
    whole_ = *std::move(bytes);
    size_ = whole_.size();
    return {};
}

bool ObjFile::read(std::size_t begin, std::size_t end, char* to) const {
    if (file_ < 0) {
        if (end > begin) std::memcpy(to, whole_.data() + begin, end - begin);
        return true;
    }
    std::size_t have = 0;
    while (have < end - begin) {
        const ssize_t n = ::pread(file_, to + have, end - begin - have, off_t(begin + have));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        have += std::size_t(n);
    }
    return true;
}

}  // namespace prep::detail
