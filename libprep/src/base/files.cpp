#include "prep/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/atomic_files.h"
#include "base/read_open_file.h"

namespace prep {
namespace {

std::string reason() {
    return std::strerror(errno);
}

}  // namespace

Result<std::vector<std::byte>> detail::read_open_file(int fd, const std::filesystem::path& path) {
    struct stat info {};
    if (::fstat(fd, &info) != 0)
        return Error{ErrorCode::io, "cannot read the file: " + reason(), path.string()};
    if (S_ISDIR(info.st_mode))
        return Error{ErrorCode::io, "this is a directory; name a file", path.string()};
    constexpr off_t limit = off_t(1) << 40;
    if (info.st_size > limit)
        return Error{ErrorCode::limit, "the file is larger than 1 TiB", path.string()};
    std::vector<std::byte> bytes(std::size_t(info.st_size));
    std::size_t have = 0;
    // Pipes and devices say size 0: read until the end either way.
    for (;;) {
        if (have == bytes.size()) {
            std::byte probe;
            const ssize_t n = ::read(fd, &probe, 1);
            if (n == 0) break;
            if (n < 0) {
                if (errno == EINTR) continue;
                return Error{ErrorCode::io, "cannot read the file: " + reason(), path.string()};
            }
            if (bytes.size() >= std::size_t(limit))
                return Error{ErrorCode::limit, "the file is larger than 1 TiB", path.string()};
            bytes.resize(std::max<std::size_t>(65536, bytes.size() * 2));
            bytes[have++] = probe;
            continue;
        }
        const ssize_t n = ::read(fd, bytes.data() + have, bytes.size() - have);
        if (n == 0) break;
        if (n < 0) {
            if (errno == EINTR) continue;
            return Error{ErrorCode::io, "cannot read the file: " + reason(), path.string()};
        }
        have += std::size_t(n);
    }
    bytes.resize(have);
    return bytes;
}

Result<std::vector<std::byte>> detail::read_regular_file(const std::filesystem::path& path) {
    std::error_code ec;
    const auto status = std::filesystem::status(path, ec);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        return Error{ErrorCode::io, "this is no regular file", path.string()};
    return read_file(path);
}

Result<std::vector<std::byte>> read_file(const std::filesystem::path& path) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return Error{ErrorCode::io, "cannot open the file: " + reason(), path.string()};
    auto bytes = detail::read_open_file(fd, path);
    ::close(fd);
    return bytes;
}

Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    detail::FileSet files;
    if (auto done = files.add(path, bytes); !done) return done;
    return files.commit();
}

}  // namespace prep
