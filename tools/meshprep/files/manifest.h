// What a batch made of what: `prepare --manifest`. With it a later run skips what is done already.
//
// The file is JSON without times: the same inputs and settings give the same bytes.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "meshprep/files/file_list.h"
#include "meshprep/options/option_set.h"
#include "prep/result.h"

namespace meshprep {

// A file with its hash; without one where it was not there.
struct HashedFile {
    std::string path;
    std::optional<std::string> sha256;
};
HashedFile hashed(const std::filesystem::path& path);

struct ManifestEntry {
    Job job;                          // with the error of one that failed
    std::vector<HashedFile> sources;  // the input first, then what was read with it
    std::vector<std::string> absent;  // files that would be read in place of sources
    std::vector<HashedFile> outputs;
    bool complete = true;  // false: something that the input names was not found, or changed while
                           // it was read, or an error is unmet
    nlohmann::ordered_json said = nlohmann::ordered_json::object();  // findings, warnings, notes
};

class Manifest {
  public:
    explicit Manifest(Settings settings) : settings_(std::move(settings)) {}

    // Whether what is there is a manifest, of whatever version and settings.
    static bool is_one(const std::filesystem::path& path);

    // Takes over what an earlier run with these settings and this version wrote; nothing where
    // there is no such file. Errors: io, syntax (it is no manifest).
    prep::Result<void> read(const std::filesystem::path& path);

    // The job's entry, if doing it again would change nothing: every source and every output is
    // byte for byte what it was, and nothing has appeared that would be read instead.
    std::optional<ManifestEntry> finished(const Job& job) const;

    // Whether there is an entry of the job that was done.
    bool has_done(const Job& job) const;

    void set(ManifestEntry entry);

    // Complete or not at all. Errors: io, invalid (the name is that of an output in it).
    prep::Result<void> write(const std::filesystem::path& path) const;

  private:
    using Key = std::pair<std::string, std::string>;  // input, output
    Settings settings_;
    std::vector<Key> order_;
    std::map<Key, ManifestEntry> entries_;
};

}  // namespace meshprep
