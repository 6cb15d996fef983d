#include "base/atomic_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <set>

#include "prep/files.h"

namespace prep::detail {
namespace {

Error io_error(const char* what, int number, const std::filesystem::path& path) {
    return {ErrorCode::io, std::string(what) + ": " + std::strerror(number), path.string()};
}

// A name beside `path` that nothing has. Process and counter make it differ between writers; it is
// short whatever the length of the file's own name.
std::string unused_name(const std::filesystem::path& path, const char* kind) {
    static std::atomic<unsigned> counter{0};
    return (path.parent_path() / (std::string(".meshprep-") + kind + std::to_string(::getpid()) +
                                  "-" + std::to_string(counter.fetch_add(1))))
        .string();
}

// Temporary files that exist now, of all sets of the process: what discard_unfinished_files
// removes.
class Staged {
  public:
    static Staged& instance() {
        static Staged* const staged = new Staged;  // never destroyed: signal threads outlive main
        return *staged;
    }
    // A new file, open for writing; −1 and errno where there is none.
    int create(const std::string& name) {
        const std::lock_guard lock(mutex_);  // never a file that is there and not in the list
        if (ended_) {
            errno = ECANCELED;
            return -1;
        }
        const int fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0) names_.insert(name);
        return fd;
    }
    void remove(const std::string& name) {
        const std::lock_guard lock(mutex_);
        names_.erase(name);
    }
    // While files get their names: between two renames is no moment to end in.
    std::unique_lock<std::mutex> renaming() { return std::unique_lock(renaming_); }
    bool ended() {
        const std::lock_guard lock(mutex_);
        return ended_;
    }
    std::size_t unlink_all() {
        const std::lock_guard after_renames(renaming_);
        const std::lock_guard lock(mutex_);
        ended_ = true;
        std::size_t removed = 0;
        for (const std::string& name : names_) removed += ::unlink(name.c_str()) == 0;
        names_.clear();
        return removed;
    }

  private:
    std::mutex mutex_, renaming_;
    std::set<std::string> names_;
    bool ended_ = false;
};

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code ignored;
    return std::filesystem::equivalent(a, b, ignored);
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
    while (!files_.empty()) drop_last();
}

void FileSet::drop_last() {
    names_.erase(files_.back().name);
    const std::string& staged = files_.back().staged;
    if (!staged.empty()) {
        ::unlink(staged.c_str());
        Staged::instance().remove(staged);
    }
    files_.pop_back();
}

std::optional<Error> FileSet::refusal(const std::filesystem::path& path, bool exists) const {
    if (!exists) return std::nullopt;
    if (!rules_.replace)
        return Error{ErrorCode::io, "the file exists and is not to be replaced", path.string()};
    if (rules_.spared && rules_.spared(path))
        return Error{ErrorCode::io,
                     "this file is read for another result and would be written over; give the "
                     "output another name or directory",
                     path.string()};
    bool spared = path != rules_.target && !rules_.source.empty() && same_file(path, rules_.source);
    for (const std::filesystem::path& file : rules_.spare) spared |= same_file(path, file);
    if (!spared) return std::nullopt;
    return Error{
        ErrorCode::io,
        "this file was read for the result and would be written over by it; give the output "
        "another name",
        path.string()};
}

namespace {

// Where a link leads, also to a file that is not there yet; other paths as they are.
std::filesystem::path behind_links(const std::filesystem::path& path) {
    std::error_code failed;
    if (!std::filesystem::is_symlink(path, failed)) return path;
    if (std::filesystem::exists(path, failed)) {
        std::filesystem::path behind = std::filesystem::canonical(path, failed);
        return failed ? path : behind;  // links of /proc lead to what has no path
    }
    std::filesystem::path at = path;
    constexpr int most = 40;  // as the kernel follows
    std::error_code no_link;
    for (int k = 0; k < most && std::filesystem::is_symlink(at, no_link); ++k) {
        at = at.parent_path() / std::filesystem::read_symlink(at, failed);
        if (failed) return path;
    }
    return at;
}

}  // namespace

std::filesystem::path identity_of(const std::filesystem::path& path) {
    std::error_code failed;
    const std::filesystem::path file = behind_links(path);
    std::filesystem::path whole = std::filesystem::absolute(file, failed);
    if (failed) whole = file;
    // Of a relative path of which nothing is there, it would be one as well.
    std::filesystem::path canonical = std::filesystem::weakly_canonical(whole, failed);
    return failed ? whole.lexically_normal() : canonical;
}

// Where a path leads.
struct FileSet::Target {
    File file;
    std::optional<unsigned> old_mode;  // of a regular file that is there
};

Result<FileSet::Target> FileSet::target_of(const std::filesystem::path& path) const {
    Target target;
    target.file.path = behind_links(path);
    target.file.name = identity_of(target.file.path).string();
    if (names_.contains(target.file.name))
        return Error{ErrorCode::invalid,
                     "two outputs would have this name; give one of them another", path.string()};
    struct stat old {};
    const bool exists = ::stat(path.c_str(), &old) == 0;
    if (std::optional<Error> refused = refusal(path, exists)) return std::move(*refused);
    if (exists && S_ISDIR(old.st_mode))
        return Error{ErrorCode::io, "cannot write the file: this is a directory", path.string()};
    // Renaming over a device would replace the device.
    target.file.in_place = exists && !S_ISREG(old.st_mode);
    if (exists && !target.file.in_place) target.old_mode = old.st_mode & 07777;
    return target;
}

// A file of a name beside `near` that nothing had, open for writing.
Result<int> FileSet::create(File& file, const std::filesystem::path& near) const {
    int fd = -1;
    do {
        file.staged = unused_name(near, "new");
        fd = Staged::instance().create(file.staged);
    } while (fd < 0 && errno == EEXIST);
    if (fd < 0) return io_error("cannot create a file here", errno, near);
    return fd;
}

Result<void> FileSet::add(const std::filesystem::path& path,
                          std::span<const std::span<const std::byte>> parts) {
    Result<Target> target = target_of(path);
    if (!target) return target.error();
    File file = std::move(target->file);
    if (file.in_place) {
        for (const auto& part : parts)
            file.direct.insert(file.direct.end(), part.begin(), part.end());
        keep(std::move(file));
        return {};
    }
    const Result<int> created = create(file, file.path);
    if (!created) return created.error();
    const int fd = *created;
    bool good = true;
    for (const auto& part : parts) good = good && write_all(fd, part);
    // A file that is replaced keeps its rights.
    if (good && target->old_mode) good = ::fchmod(fd, *target->old_mode) == 0;
    int why = good ? 0 : errno;
    if (::close(fd) != 0 && good) {
        good = false;
        why = errno;
    }
    if (!good) {
        ::unlink(file.staged.c_str());
        Staged::instance().remove(file.staged);
        return io_error("cannot write the file", why, path);
    }
    keep(std::move(file));
    return {};
}

void FileSet::keep(File file) {
    names_.insert(file.name);
    files_.push_back(std::move(file));
}

Result<std::filesystem::path> FileSet::stage(const std::filesystem::path& path) {
    Result<Target> target = target_of(path);
    if (!target) return target.error();
    File file = std::move(target->file);
    file.mode = target->old_mode;
    std::error_code ignored;
    const Result<int> created = create(
        file, file.in_place ? std::filesystem::temp_directory_path(ignored) / "staged" : file.path);
    if (!created) return created.error();
    ::close(*created);
    keep(std::move(file));
    return std::filesystem::path(files_.back().staged);
}

// The old file under its name again. What is to be said where that fails: it stays where it is.
std::string FileSet::put_back(File& file) {
    if (file.backup.empty()) return {};
    if (std::rename(file.backup.c_str(), file.path.c_str()) != 0)
        return "; the file that was there cannot be put back: it is now '" + file.backup + "'";
    ::unlink(file.backup.c_str());  // rename() does nothing where both are links to one file
    file.backup.clear();
    return {};
}

std::string FileSet::undo(std::size_t renamed) {
    std::string told;
    while (renamed-- > 0) {
        File& file = files_[renamed];
        if (file.in_place) continue;
        if (file.backup.empty())
            ::unlink(file.path.c_str());
        else
            told += put_back(file);
    }
    return told;
}

Result<void> FileSet::commit() {
    for (File& file : files_) {
        if (file.mode && ::chmod(file.staged.c_str(), *file.mode) != 0)
            return io_error("cannot write the file", errno, file.path);
        if (!file.in_place || file.staged.empty()) continue;
        Result<std::vector<std::byte>> bytes = read_file(file.staged);
        if (!bytes) return bytes.error();
        file.direct = std::move(*bytes);
    }
    auto renaming = Staged::instance().renaming();
    if (Staged::instance().ended()) {
        const std::string first = files_.empty() ? std::string() : files_[0].path.string();
        return Error{ErrorCode::io, "cannot write the file: the process was told to end", first};
    }
    const auto fail = [&](std::size_t i, const char* what, int why, const std::string& told) {
        Error error = io_error(what, why, files_[i].path);
        error.text += told + undo(i);
        return error;
    };
    std::size_t last = files_.size();
    while (last > 0 && files_[last - 1].in_place) --last;
    for (std::size_t i = 0; i < last; ++i) {
        File& file = files_[i];
        if (file.in_place) continue;
        // The last rename needs no way back: it is the last that can fail.
        if (i + 1 < last) {
            file.backup = unused_name(file.path, "old");
            if (::link(file.path.c_str(), file.backup.c_str()) != 0) {
                // File systems without hard links: the old file steps aside. ENOENT: there is none.
                if (errno == ENOENT) {
                    file.backup.clear();
                } else if (std::rename(file.path.c_str(), file.backup.c_str()) != 0) {
                    const int why = errno;
                    file.backup.clear();
                    return fail(i, "cannot set the old file aside", why, {});
                }
            }
        }
        if (std::rename(file.staged.c_str(), file.path.c_str()) != 0) {
            const int why = errno;
            return fail(i, "cannot write the file", why, put_back(file));
        }
        Staged::instance().remove(file.staged);
        file.staged.clear();
    }
    for (const File& file : files_) {
        if (!file.backup.empty()) ::unlink(file.backup.c_str());
        if (rules_.written && !file.in_place) rules_.written->push_back(file.path);
    }
    renaming.unlock();  // a pipe may keep us waiting
    for (const File& file : files_) {
        if (!file.in_place) continue;
        const int fd = ::open(file.path.c_str(), O_WRONLY | O_CLOEXEC);
        if (fd < 0) return io_error("cannot open the file", errno, file.path);
        const bool good = write_all(fd, file.direct);
        const int why = errno;
        ::close(fd);
        if (!good) return io_error("cannot write the file", why, file.path);
        if (rules_.written) rules_.written->push_back(file.path);
    }
    return {};
}

}  // namespace prep::detail

namespace prep {

std::size_t discard_unfinished_files() {
    return detail::Staged::instance().unlink_all();
}

}  // namespace prep
