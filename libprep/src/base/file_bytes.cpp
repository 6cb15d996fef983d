#include "base/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "base/read_open_file.h"
#include "prep/files.h"

namespace prep::detail {
namespace {

// Enough that handing it out costs nothing beside copying it.
constexpr std::size_t file_block = std::size_t(4) << 20;
constexpr std::uint64_t largest_file = std::uint64_t(1) << 40;  // read_open_file() says why not

// False where the file ends before `end`, or cannot be read.
bool read_block(int fd, std::span<std::byte> bytes, std::size_t begin, std::size_t end) {
    while (begin < end) {
        const ssize_t n = ::pread(fd, bytes.data() + begin, end - begin, off_t(begin));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        begin += std::size_t(n);
    }
    return true;
}

// Of a regular file that stays as long as it is; else nothing.
FileBytes read_regular(int fd, int threads) {
    struct stat info {};
    if (::fstat(fd, &info) != 0 || !S_ISREG(info.st_mode) ||
        std::uint64_t(info.st_size) > largest_file)
        return {};
    FileBytes bytes(std::size_t(info.st_size));
    std::atomic<bool> whole = true;
    parallel_blocks(bytes.size(), file_block, threads, [&](std::size_t begin, std::size_t end) {
        if (!read_block(fd, bytes, begin, end)) whole = false;
    });
    std::byte more;
    if (!whole || ::pread(fd, &more, 1, info.st_size) != 0) return {};
    return bytes;
}

}  // namespace

Result<FileBytes> read_file_bytes(const std::filesystem::path& path, int threads) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    // Says why.
    if (fd < 0) {
        auto bytes = read_file(path);
        if (!bytes) return std::move(bytes).error();
        return FileBytes(bytes->begin(), bytes->end());
    }
    FileBytes bytes = read_regular(fd, threads);
    if (!bytes.empty()) {
        ::close(fd);
        return bytes;
    }
    // Pipes, devices, what has no size or another by now; or what is wrong.
    auto rest = read_open_file(fd, path);
    ::close(fd);
    if (!rest) return std::move(rest).error();
    return FileBytes(rest->begin(), rest->end());
}

}  // namespace prep::detail
