// Which files a subcommand reads and writes, settled before anything is written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "prep/result.h"

namespace meshprep {

// Endings without their dot.
const std::vector<std::string>& output_endings();
std::string output_endings_text();  // "glb, gltf, obj, …"
std::string input_endings_text();
std::string lower_ending(const std::filesystem::path& path);

// What `meshprep prepare` is told of files.
struct JobRequest {
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output;
    bool in_place = false;
    bool recursive = false;
    bool overwrite = true;
    std::string format;  // of files in an output directory; empty: glb
    bool ascii = false;  // PLY and STL
};

struct Job {
    std::filesystem::path input, output;
};

struct JobList {
    std::vector<Job> jobs;
    std::vector<std::filesystem::path> directories;  // to be made before writing, parents first
};

// Errors (all of them are mistakes in the command line, none leaves a trace): an input is not
// there, a directory without mesh files, an output without or with an unknown ending, its directory
// missing, two inputs with one output, an output that is also an input without --in-place, an
// existing output with --no-overwrite, a --format or --ascii that no output follows.
prep::Result<JobList> plan_jobs(const JobRequest& request);

// `path` must be there and be a file that can be read. For messages before the libraries' own.
prep::Result<void> require_file(const std::filesystem::path& path);
// The directory in which `file` will be written must be there.
prep::Result<void> require_parent(const std::filesystem::path& file);
// Makes `directory` unless it is there; its parent must be there.
prep::Result<void> make_directory(const std::filesystem::path& directory);

}  // namespace meshprep
