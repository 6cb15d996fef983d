// An input as a file that can be loaded: unpacked where it is packed, taken from standard input for
// "-" and from named pipes, under a name whose ending says the format it was said to have.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "meshprep/files/private_directory.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace meshprep {

// Directories of links to what lies beside and above inputs that have to be read from elsewhere:
// one for all inputs of a folder, since each has as many links as the folder has files. It holds
// what lay there when the first of them was opened. Threads may share it; InputFiles may outlive
// it.
class SiblingLinks {
  public:
    SiblingLinks();
    ~SiblingLinks();
    SiblingLinks(const SiblingLinks&) = delete;
    SiblingLinks& operator=(const SiblingLinks&) = delete;

    struct Folder;
    // Error: io (the directory cannot be made).
    prep::Result<std::shared_ptr<const Folder>> of(const std::filesystem::path& folder);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// Of what is read from pipes and standard input, and kept in the directory for temporary files.
struct StreamLimits {
    std::uint64_t most = std::uint64_t(16) << 30;  // bytes
};

class InputFile {
  public:
    // `format` is the ending that the input is read by, whatever its own; empty: its own, else the
    // first bytes tell. Of a .zip file the one mesh is meant, with what lies beside it.
    // Errors: io, those of archive.h, invalid (no mesh or several in a zip file), unsupported
    // (standard input's first bytes tell no format), limit (a stream without an end).
    // With `links` many inputs of one folder share what is made for it.
    static prep::Result<InputFile> open(const std::filesystem::path& named,
                                        const std::string& format, SiblingLinks* links = nullptr,
                                        const StreamLimits& limits = {});

    const std::filesystem::path& path() const { return path_; }  // to be loaded
    const std::filesystem::path& named() const { return named_; }
    // Files that were read for it and will still be there: itself, unless it is a pipe.
    std::optional<std::filesystem::path> source() const;
    // Whether `file` goes with this input.
    bool passing(const std::filesystem::path& file) const;

    // Texts that name the file that was loaded name what the user gave.
    std::string relabelled(std::string text) const;
    prep::Error relabelled(prep::Error error) const;
    // The scene outlives the unpacked files: pictures among them are taken into memory, texts and
    // paths, of what is missing too, name what the user gave and what lies beside it.
    void settle(prep::Scene& scene) const;

  private:
    bool share_links(const std::filesystem::path& file, SiblingLinks& links);
    prep::Result<void> link_with_siblings(const std::filesystem::path& file,
                                          const std::string& name);
    prep::Result<void> read_stream(const std::string& format, const StreamLimits& limits);
    // `data`: what was named, or all that came through it.
    prep::Result<void> unpack(const std::filesystem::path& data, const std::string& format,
                              SiblingLinks* links);
    prep::Result<void> unpack_gzip_file(const std::filesystem::path& data,
                                        const std::string& format, SiblingLinks* links);
    std::string place() const;
    void label_directories();
    // The path that a file has beside what the user named; its own where that is another file.
    std::filesystem::path settled(const std::filesystem::path& file) const;
    prep::Result<void> choose_mesh(const std::vector<std::string>& names);
    prep::Result<std::filesystem::path> directory();

    std::filesystem::path named_, path_;
    std::shared_ptr<PrivateDirectory> directory_;
    std::shared_ptr<const std::filesystem::path> shared_;  // its place among shared links
    std::filesystem::path place_;  // in it, where the unpacked or linked file lies
    std::vector<std::pair<std::string, std::string>> labels_;  // text of a path, what it stands for
    std::vector<std::string> warnings_;                        // settle() hands them on
};

}  // namespace meshprep
