// Which files a subcommand reads and writes, settled before anything is written.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "prep/result.h"

namespace meshprep {

// Endings without their dot.
const std::vector<std::string>& output_endings();
std::string output_endings_text();  // "glb, gltf, obj, …"
std::string input_endings_text();
std::string lower_ending(const std::filesystem::path& path);

// The file options of `meshprep prepare`.
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
    std::string format;                     // the output's ending
    std::optional<prep::Error> error = {};  // found before anything was read: it is not done
};

struct JobList {
    std::vector<Job> jobs;
};

// Nothing is written or made. Errors (mistakes in the command line as a whole): an output without
// or with an unknown ending, several inputs for one file, a file in the way of the output
// directory, a --format or --ascii that no output follows. Errors of single jobs: an input is not
// there, a directory without mesh files, an output that an earlier input has already or that is an
// input itself without --in-place, an existing output with --no-overwrite.
prep::Result<JobList> plan_jobs(const JobRequest& request);

// `path` must be there and be a file that can be read. For messages before the libraries' own.
prep::Result<void> require_file(const std::filesystem::path& path);

// The same path for the same file, whatever way it is named; it need not be there.
std::filesystem::path identity(const std::filesystem::path& path);

bool is_standard_stream(const std::filesystem::path& path);  // "-"
bool is_packed(const std::filesystem::path& path);           // .gz, .zip
// Whether a directory is meant to be read for this file.
bool holds_mesh(const std::filesystem::path& path);

}  // namespace meshprep
