#include "prep/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/atomic_files.h"
#include "base/parallel.h"
#include "base/read_file.h"

namespace prep {
namespace {

std::string reason() {
    return std::strerror(errno);
}

// Of a regular file, from its beginning; how many are there, which may be fewer than asked for.
std::size_t read_at_once(int fd, std::span<std::byte> bytes, int threads) {
    constexpr std::size_t block = std::size_t(4) << 20;
    std::vector<std::size_t> have((bytes.size() + block - 1) / block, 0);
    detail::parallel_blocks(bytes.size(), block, threads, [&](std::size_t begin, std::size_t end) {
        std::size_t& read = have[begin / block];
        while (begin + read < end) {
            const ssize_t n =
                ::pread(fd, bytes.data() + begin + read, end - begin - read, off_t(begin + read));
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) return;
            read += std::size_t(n);
        }
    });
    std::size_t all = 0;
    for (std::size_t b = 0; b < have.size() && all == b * block; ++b) all += have[b];
    return all;
}

template <class Bytes>
Result<Bytes> read_all(int fd, const std::filesystem::path& path, int threads = 1) {
    struct stat info {};
    if (::fstat(fd, &info) != 0)
        return Error{ErrorCode::io, "cannot read the file: " + reason(), path.string()};
    if (S_ISDIR(info.st_mode))
        return Error{ErrorCode::io, "this is a directory; name a file", path.string()};
    constexpr off_t limit = off_t(1) << 40;
    if (info.st_size > limit)
        return Error{ErrorCode::limit, "the file is larger than 1 TiB", path.string()};
    Bytes bytes(std::size_t(info.st_size));
    std::size_t have = 0;
    if (threads != 1 && S_ISREG(info.st_mode)) {
        have = read_at_once(fd, bytes, threads);
        // Why it ended early, or what came since, is found below.
        if (::lseek(fd, off_t(have), SEEK_SET) < 0)
            return Error{ErrorCode::io, "cannot read the file: " + reason(), path.string()};
    }
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

template <class Bytes>
Result<Bytes> read_named(const std::filesystem::path& path, int threads = 1) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return Error{ErrorCode::io, "cannot open the file: " + reason(), path.string()};
    auto bytes = read_all<Bytes>(fd, path, threads);
    ::close(fd);
    return bytes;
}

}  // namespace

Result<std::vector<std::byte>> detail::read_open_file(int fd, const std::filesystem::path& path) {
    return read_all<std::vector<std::byte>>(fd, path);
}

Result<std::vector<std::byte>> detail::read_regular_file(const std::filesystem::path& path) {
    std::error_code ec;
    const auto status = std::filesystem::status(path, ec);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        return Error{ErrorCode::io, "this is no regular file", path.string()};
    return read_file(path);
}

Result<std::vector<std::byte>> read_file(const std::filesystem::path& path) {
    return read_named<std::vector<std::byte>>(path);
}

Result<detail::FileBytes> detail::read_file_bytes(const std::filesystem::path& path, int threads) {
    return read_named<FileBytes>(path, threads);
}

Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    detail::FileSet files;
    if (auto done = files.add(path, bytes); !done) return done;
    return files.commit();
}

}  // namespace prep
