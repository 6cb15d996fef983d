// What the inputs of one command line are read from: what is written beside an output (.mtl, .bin,
// a picture, a sheet, a manifest) must not replace a file that an input has yet to be read from, or
// was.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/options/common_options.h"
#include "meshprep/output/console.h"
#include "prep/scene.h"

namespace meshprep {

// Threads may share it. The list of jobs outlives it.
class BatchSources {
  public:
    BatchSources(const std::vector<Job>& jobs, const CommonOptions& common, Console& console);

    // A file that the command line names for all of them.
    void add(const std::filesystem::path& file);
    // The scene as it was loaded for a job of the list, before InputFile::settle().
    void add(const Job& job, const InputFile& input, const prep::Scene& scene);
    // A job that is not done again, and what it was read from the last time.
    void add(const Job& job, const std::vector<std::filesystem::path>& files);

    // Whether an input of another job is read from this file. Inputs that nobody has loaded yet may
    // be loaded for the answer, each once: ask only of files that exist. For a job's own output
    // those are scene files alone: other formats are not read from files that we write.
    // O(log jobs), beside what is loaded.
    bool of_another(const Job& job, const std::filesystem::path& file);
    // Whether any input is read from it.
    bool of_any(const std::filesystem::path& file);

  private:
    void make_known(const std::set<std::size_t>& of, std::size_t but);
    void load(std::size_t number);
    void keep(std::size_t number, const std::vector<std::filesystem::path>& files);
    bool has_another(const std::string& name, std::size_t number) const;

    const std::vector<Job>& jobs_;
    const CommonOptions& common_;
    Console& console_;
    std::mutex loading_;  // taken before the other
    mutable std::mutex mutex_;
    std::vector<bool> known_;  // by job: its files are noted
    // Jobs of which files may be unknown that loading it for the answer would tell, which takes a
    // file that can be read twice; and those among them that are scene files.
    std::set<std::size_t> to_load_, scenes_to_load_;
    std::map<std::string, std::vector<std::size_t>> jobs_of_;  // by canonical name
    SiblingLinks links_;
};

}  // namespace meshprep
