#include "file_set.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace prep::detail {
namespace {

Error io_error(const char* what, int number, const std::filesystem::path& path) {
    return {ErrorCode::io, std::string(what) + ": " + std::strerror(number), path.string()};
}

// A name beside `path` that nothing has. Process and counter make it differ between writers.
std::string unused_name(const std::filesystem::path& path, const char* kind) {
    static std::atomic<unsigned> counter{0};
    return path.string() + "." + kind + std::to_string(::getpid()) + "-" +
           std::to_string(counter.fetch_add(1));
}

bool write_all(int fd, std::span<const std::byte> bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        done += std::size_t(n);
    }
    return true;
}

}  // namespace

FileSet::~FileSet() {
    for (const File& file : files_)
        if (!file.staged.empty()) ::unlink(file.staged.c_str());
}

Result<void> FileSet::add(const std::filesystem::path& path,
                          std::span<const std::span<const std::byte>> parts) {
    File file;
    file.path = path;
    struct stat old {};
    const bool exists = ::stat(path.c_str(), &old) == 0;
    if (exists && S_ISDIR(old.st_mode))
        return Error{ErrorCode::io, "cannot write the file: this is a directory", path.string()};
    if (exists && !S_ISREG(old.st_mode)) {  // renaming over a device would replace the device
        file.in_place = true;
        for (const auto& part : parts)
            file.direct.insert(file.direct.end(), part.begin(), part.end());
        files_.push_back(std::move(file));
        return {};
    }
    int fd = -1;
    do {
        file.staged = unused_name(path, "tmp");
        fd = ::open(file.staged.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (fd < 0 && errno == EEXIST);
    if (fd < 0) return io_error("cannot create a file here", errno, path);
    bool good = true;
    for (const auto& part : parts) good = good && write_all(fd, part);
    // A file that is replaced keeps its rights.
    if (good && exists) good = ::fchmod(fd, old.st_mode & 07777) == 0;
    int why = good ? 0 : errno;
    if (::close(fd) != 0 && good) {
        good = false;
        why = errno;
    }
    if (!good) {
        ::unlink(file.staged.c_str());
        return io_error("cannot write the file", why, path);
    }
    files_.push_back(std::move(file));
    return {};
}

void FileSet::undo(std::size_t renamed) {
    while (renamed-- > 0) {
        File& file = files_[renamed];
        if (file.in_place) continue;
        if (file.backup.empty())
            ::unlink(file.path.c_str());
        else
            std::rename(file.backup.c_str(), file.path.c_str());
    }
}

Result<void> FileSet::commit() {
    for (std::size_t i = 0; i < files_.size(); ++i) {
        File& file = files_[i];
        if (file.in_place) continue;
        // The last rename needs no way back: it is the last that can fail.
        bool more = false;
        for (std::size_t j = i + 1; j < files_.size(); ++j) more |= !files_[j].in_place;
        if (more) {
            file.backup = unused_name(file.path, "old");
            if (::link(file.path.c_str(), file.backup.c_str()) != 0) file.backup.clear();
        }
        if (std::rename(file.staged.c_str(), file.path.c_str()) != 0) {
            const int why = errno;
            if (!file.backup.empty()) ::unlink(file.backup.c_str());
            undo(i);
            return io_error("cannot write the file", why, file.path);
        }
        file.staged.clear();
    }
    for (const File& file : files_)
        if (!file.backup.empty()) ::unlink(file.backup.c_str());
    for (const File& file : files_) {
        if (!file.in_place) continue;
        const int fd = ::open(file.path.c_str(), O_WRONLY | O_CLOEXEC);
        if (fd < 0) return io_error("cannot open the file", errno, file.path);
        const bool good = write_all(fd, file.direct);
        const int why = errno;
        ::close(fd);
        if (!good) return io_error("cannot write the file", why, file.path);
    }
    return {};
}

}  // namespace prep::detail
