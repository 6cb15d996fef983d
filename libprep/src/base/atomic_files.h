// Several output files that appear together or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "prep/result.h"

namespace prep::detail {

// The same path for the same file, whatever way it is named; it need not be there. Where there is
// no telling, as without a working directory: what the path says.
std::filesystem::path identity_of(const std::filesystem::path& path);

struct FileSetRules {
    bool replace = true;                            // files that exist may be replaced
    std::vector<std::filesystem::path> spare = {};  // but not these
    std::filesystem::path source = {};              // nor this, other than by `target`
    std::filesystem::path target = {};
    // Asked of files that exist; those it is true for are no one's to replace, `target` as well.
    std::function<bool(const std::filesystem::path&)> spared = {};
    // commit() fills it with what is written, in their order, pipes and devices last.
    std::vector<std::filesystem::path>* written = nullptr;
};

// Files are staged under temporary names beside their targets, then renamed by commit(). What was
// not committed is removed again by the destructor; a commit that fails half way puts the old files
// back. Links are followed: what they point to is replaced. Targets that are no regular files
// (devices, pipes) are written in place, by commit(), last: there is no way back from them.
class FileSet {
  public:
    FileSet() = default;
    explicit FileSet(FileSetRules rules) : rules_(std::move(rules)) {}
    ~FileSet();
    FileSet(const FileSet&) = delete;
    FileSet& operator=(const FileSet&) = delete;

    // Writes `parts`, one after the other, under a temporary name. Errors: io.
    Result<void> add(const std::filesystem::path& path,
                     std::span<const std::span<const std::byte>> parts);
    Result<void> add(const std::filesystem::path& path, std::span<const std::byte> bytes) {
        return add(path, std::span<const std::span<const std::byte>>(&bytes, 1));
    }
    // An empty file under a temporary name, for a writer that needs a name; what it holds by the
    // time of commit() becomes `path`. Errors: io.
    Result<std::filesystem::path> stage(const std::filesystem::path& path);
    void drop_last();  // as if it had never been added
    // Errors: io; then no target has changed, unless it was a device or a pipe that failed: regular
    // files have been written then. An old file that cannot be put back stays under a name that the
    // error tells.
    Result<void> commit();

  private:
    struct File {
        std::filesystem::path path;
        std::string name;            // of the file itself, however the path is written
        std::string staged, backup;  // empty where there is none
        std::vector<std::byte> direct;
        bool in_place = false;
        std::optional<unsigned> mode;  // rights to be set
    };
    struct Target;
    Result<Target> target_of(const std::filesystem::path& path) const;
    Result<int> create(File& file, const std::filesystem::path& near) const;
    std::optional<Error> refusal(const std::filesystem::path& path, bool exists) const;
    void keep(File file);
    static std::string put_back(File& file);
    std::string undo(std::size_t renamed);

    FileSetRules rules_;
    std::vector<File> files_;
    std::unordered_set<std::string> names_;
};

}  // namespace prep::detail
