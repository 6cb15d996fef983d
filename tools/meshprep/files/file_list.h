// Which files a subcommand reads and writes, settled before anything is written.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/atomic_files.h"
#include "prep/result.h"
#include "prep/scene.h"

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
    bool output_stands = false;  // that is the error: no harm where the output is what it would be
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

using prep::detail::identity_of;

// No output may be an input, nor two outputs one file, nor one of them standard output.
prep::Result<void> keep_apart(const std::vector<std::filesystem::path>& inputs,
                              const std::vector<std::filesystem::path>& outputs);
// Of the files that a scene was read from beside its own: libraries and pictures. To be asked while
// its input is open: what is packed or piped reaches them by links that go with it.
std::vector<std::filesystem::path> read_beside(const prep::Scene& scene);

bool is_standard_stream(const std::filesystem::path& path);  // "-"
// "-", pipes, and the terminal at standard input: what can be read once, and has no size.
bool is_stream(const std::filesystem::path& path);
// Error: the input is a stream, and an earlier one is the same.
prep::Result<void> require_unread(const std::vector<std::filesystem::path>& inputs,
                                  std::size_t number);
// Whether a directory holds what processes have open (/dev, /dev/fd, all below /proc): it has no
// files that belong together.
bool is_of_descriptors(const std::filesystem::path& folder);
// What a reader says of an input, after the input's name. Some name it themselves: "a.obj:4: …".
std::string said_of(const std::filesystem::path& input, const std::string& text);
bool is_packed(const std::filesystem::path& path);  // .gz, .zip
// Whether a directory is meant to be read for this file.
bool holds_mesh(const std::filesystem::path& path);

}  // namespace meshprep
