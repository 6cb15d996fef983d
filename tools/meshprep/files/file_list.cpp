#include "meshprep/files/file_list.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "prep/formats.h"
#include "text/suggestions.h"

namespace meshprep {
namespace {

namespace fs = std::filesystem;
using prep::Error;
using prep::ErrorCode;
using prep::Result;

std::string with_commas(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

bool known(const std::vector<std::string>& endings, const std::string& ending) {
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

struct Input {
    fs::path path;
    fs::path below;              // directory below the one that was named, kept apart in the output
    std::optional<Error> error;  // why it cannot be read
};

// What is in a directory; where that is nothing, the directory itself with the reason. `output`, an
// identity, is where the results go: what an earlier run left there is no input.
std::vector<Input> list_directory(const fs::path& path, bool recursive, const fs::path& output) {
    std::error_code ec;
    std::vector<Input> found;
    const auto add = [&](const fs::path& at, std::optional<Error> error) {
        found.push_back({at, at.parent_path().lexically_relative(path), std::move(error)});
    };
    const auto take = [&](const fs::directory_entry& entry) {
        if (!holds_mesh(entry.path())) return;
        std::error_code entry_ec;
        if (entry.is_regular_file(entry_ec)) {
            add(entry.path(), {});
        } else if (entry.is_symlink(entry_ec) && !entry.exists(entry_ec)) {
            if (const Result<void> there = require_file(entry.path()); !there)
                add(entry.path(), there.error());
        }
    };
    const auto not_listed = [](const fs::path& directory, const std::error_code& why) {
        return Error{ErrorCode::io, "cannot list the directory: " + why.message(),
                     directory.string()};
    };
    if (recursive) {
        fs::recursive_directory_iterator it(path, ec);
        for (const fs::recursive_directory_iterator end; !ec && it != end; it.increment(ec)) {
            std::error_code entry_ec;
            if (it->is_directory(entry_ec) && !it->is_symlink(entry_ec)) {
                if (identity_of(it->path()) == output) {
                    it.disable_recursion_pending();
                } else if (fs::directory_iterator(it->path(), entry_ec); entry_ec) {
                    it.disable_recursion_pending();
                    add(it->path(), not_listed(it->path(), entry_ec));
                }
            }
            take(*it);
        }
    } else {
        for (fs::directory_iterator it(path, ec), end; !ec && it != end; it.increment(ec))
            take(*it);
    }
    if (ec) return {{path, {}, not_listed(path, ec)}};
    if (found.empty())
        return {{path,
                 {},
                 Error{ErrorCode::io,
                       "the directory holds no mesh file" +
                           std::string(recursive ? "" : "; -r also looks below it"),
                       path.string()}}};
    std::sort(found.begin(), found.end(),
              [](const Input& a, const Input& b) { return a.path < b.path; });
    for (Input& input : found)
        if (input.below == ".") input.below.clear();
    return found;
}

std::vector<Input> list_inputs(const JobRequest& request) {
    std::vector<Input> inputs;
    fs::path output = request.output;
    if (!output.has_filename()) output = output.parent_path();
    if (!output.empty()) output = identity_of(output);
    for (const fs::path& path : request.inputs) {
        std::error_code ec;
        if (is_standard_stream(path)) {
            inputs.push_back({path, {}, {}});
        } else if (!fs::is_directory(path, ec)) {
            const Result<void> there = require_file(path);
            inputs.push_back({path, {}, there ? std::nullopt : std::optional(there.error())});
        } else {
            for (Input& input : list_directory(path, request.recursive, output))
                inputs.push_back(std::move(input));
        }
    }
    return inputs;
}

bool names_directory(const JobRequest& request, std::size_t input_count) {
    std::error_code ec;
    if (fs::is_directory(request.output, ec)) return true;
    if (!request.output.has_filename()) return true;  // ends with a slash
    if (input_count != 1 || request.inputs.size() != 1) return true;
    return fs::is_directory(request.inputs[0], ec);
}

Result<void> check_writable_ending(const fs::path& path) {
    const std::string ending = lower_ending(path);
    if (known(output_endings(), ending)) return {};
    return Error{ErrorCode::unsupported,
                 (ending.empty() ? "the output has no ending" : "cannot write ." + ending) +
                     std::string("; written are ") + output_endings_text() +
                     ". End it with / for a directory",
                 path.string()};
}

// Options that nothing would follow.
Result<void> check_idle_options(const JobList& list, const JobRequest& request, bool directory) {
    if (!request.format.empty() && !directory && !is_standard_stream(request.output) &&
        (request.in_place || lower_ending(request.output) != request.format))
        return Error{ErrorCode::invalid,
                     request.in_place ? "--in-place keeps each file's format; leave --format out"
                                      : "its ending says the format, and --format " +
                                            request.format + " another; leave one of them out",
                     request.output.string()};
    if (!request.ascii || list.jobs.empty()) return {};
    for (const Job& job : list.jobs)
        if (job.format == "ply" || job.format == "stl") return {};
    return Error{ErrorCode::invalid,
                 "--ascii is for PLY and STL, which also have a binary form; leave it out",
                 list.jobs[0].output.string()};
}

// identity_of() of many files: each directory is followed once, while none of them changes.
class Identities {
  public:
    fs::path of(const fs::path& path) {
        const fs::path name = path.filename();
        if (!path.has_parent_path() || name.empty() || name == "." || name == "..")
            return identity_of(path);
        const auto [known, fresh] = directories_.try_emplace(path.parent_path());
        if (fresh) known->second = identity_of(known->first);
        const fs::path file = known->second / name;
        std::error_code ec;
        const fs::file_type type = fs::symlink_status(file, ec).type();
        // What is no link stands where its directory is; the rest is looked at as a whole.
        const bool plain = type == fs::file_type::regular || type == fs::file_type::not_found;
        return plain ? file : identity_of(path);
    }

  private:
    std::map<fs::path, fs::path> directories_;
};

// What is wrong with one of the jobs alone: the others are done.
void find_conflicts(JobList& list, const JobRequest& request) {
    std::map<fs::path, fs::path> outputs;
    std::set<fs::path> inputs, streams;
    Identities identities;
    for (const Job& job : list.jobs) inputs.insert(identities.of(job.input));
    const auto conflict = [&](Job& job) -> std::optional<Error> {
        if (request.in_place) {
            if (is_packed(job.input) || is_stream(job.input))
                return Error{
                    ErrorCode::invalid,
                    "nothing can be written in place of what it was unpacked or read from; "
                    "give -o FILE instead of --in-place",
                    job.input.string()};
            if (const Result<void> good = check_writable_ending(job.output); !good)
                return good.error();
        }
        if (is_standard_stream(job.output)) return std::nullopt;
        const fs::path output = identities.of(job.output);
        const auto [other, fresh] = outputs.emplace(output, job.input);
        if (!fresh)
            return Error{ErrorCode::invalid,
                         other->second == job.input
                             ? "this input is given twice; leave one of them out"
                             : "two inputs would be written to " + job.output.string() + ", and " +
                                   other->second.string() +
                                   " comes first; rename one or prepare them apart",
                         job.input.string()};
        if (is_stream(job.input) && !streams.insert(identities.of(job.input)).second)
            return Error{ErrorCode::invalid,
                         "this is read once, and an earlier input is the same; give it once",
                         job.input.string()};
        if (!request.in_place && inputs.count(output) != 0)
            return Error{ErrorCode::invalid,
                         "the output is also an input; give another name, or --in-place",
                         job.output.string()};
        std::error_code ec;
        if (fs::is_directory(job.output, ec))
            return Error{ErrorCode::io, "a directory is in the way of this output file",
                         job.output.string()};
        job.output_stands = !request.overwrite && fs::exists(job.output, ec);
        if (job.output_stands)
            return Error{ErrorCode::io,
                         "the output exists, and --no-overwrite was given; leave that out, or give "
                         "another name",
                         job.output.string()};
        return std::nullopt;
    };
    for (Job& job : list.jobs)
        if (!job.error) job.error = conflict(job);
}

// The file's name without what says how it is packed and its format.
fs::path stem_of(const fs::path& input) {
    if (is_standard_stream(input)) return "stdin";
    return lower_ending(input) == "gz" ? input.stem().stem() : input.stem();
}

// Where several files go.
Result<void> check_directory(const fs::path& directory, const JobRequest& request) {
    std::error_code ec;
    if (fs::is_directory(directory, ec)) return {};
    if (request.output.has_filename() && check_writable_ending(directory))
        return Error{ErrorCode::invalid,
                     "several inputs need a directory, and this is the name of one mesh; end it "
                     "with a slash if it is to be one",
                     request.output.string()};
    if (fs::exists(directory, ec))
        return Error{ErrorCode::io, "a file of this name is in the way of the output directory",
                     directory.string()};
    return {};
}

}  // namespace

const std::vector<std::string>& output_endings() {
    static const std::vector<std::string> endings = [] {
        std::vector<std::string> list;
        for (const prep::FileFormat& format : prep::file_formats())
            for (const std::string_view ending : format.written)
                list.emplace_back(ending.substr(1));
        return list;
    }();
    return endings;
}

std::string output_endings_text() {
    return with_commas(output_endings());
}

std::string input_endings_text() {
    std::vector<std::string> words;
    for (const prep::FileFormat& format : prep::file_formats()) {
        if (&format == &prep::file_formats().back()) {
            words.push_back("and " + std::string(format.title));
            break;
        }
        for (const std::string_view ending : format.endings)
            words.push_back(std::string(ending.substr(1)) + (format.meshes ? "" : " (scenes)"));
    }
    return with_commas(words);
}

std::string lower_ending(const fs::path& path) {
    const std::string ending = prep::lower_ending(path);
    return ending.empty() ? ending : ending.substr(1);
}

// What to do where there is no such file.
static std::string meant(const fs::path& path) {
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    std::error_code ec;
    if (!fs::is_directory(folder, ec))
        return "nor is there a directory '" + folder.string() + "'; check its name";
    std::vector<std::string> names;
    for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec))
        names.push_back(it->path().filename().string());
    std::sort(names.begin(), names.end());
    const std::string near = prep::detail::nearest_name(path.filename().string(), names);
    return near.empty() ? "check the name and the directory" : "did you mean '" + near + "'?";
}

Result<void> require_file(const fs::path& path) {
    std::error_code ec;
    const fs::file_status status = fs::status(path, ec);
    if (!fs::exists(status)) {
        std::error_code none;
        if (const fs::path to = fs::read_symlink(path, none); !none)
            return Error{ErrorCode::io,
                         ec == std::errc::too_many_symbolic_link_levels
                             ? "this is a link that leads back to itself"
                             : "this is a link to '" + to.string() + "', which is not there",
                         path.string()};
        if (path.empty())
            return Error{ErrorCode::io, "the name of a file is empty; give the file's name", "''"};
        return Error{ErrorCode::io, "there is no such file; " + meant(path), path.string()};
    }
    if (fs::is_directory(status))
        return Error{ErrorCode::io, "this is a directory, expected a file; name the files in it",
                     path.string()};
    if (fs::is_other(status) && !is_stream(path))
        return Error{ErrorCode::io, "this is a device or a socket, expected a file or a pipe",
                     path.string()};
    if (::access(path.c_str(), R_OK) != 0)
        return Error{ErrorCode::io, "no permission to read this file", path.string()};
    return {};
}

Result<void> keep_apart(const std::vector<fs::path>& inputs, const std::vector<fs::path>& outputs) {
    std::set<fs::path> read, written;
    for (const fs::path& path : inputs)
        if (!is_standard_stream(path)) read.insert(identity_of(path));
    for (const fs::path& path : outputs) {
        if (is_standard_stream(path))
            return Error{ErrorCode::invalid,
                         "only --json writes to standard output; give the name of a file", "-"};
        if (read.count(identity_of(path)) != 0)
            return Error{ErrorCode::invalid, "the output is also an input; give another name",
                         path.string()};
        if (!written.insert(identity_of(path)).second)
            return Error{ErrorCode::invalid,
                         "two outputs would be written here; give one of them another name",
                         path.string()};
    }
    return {};
}

std::vector<fs::path> read_beside(const prep::Scene& scene) {
    std::vector<fs::path> files;
    for (const fs::path& library : scene.libraries) files.push_back(identity_of(library));
    for (const prep::ImageRef& image : scene.images)
        for (const fs::path& file : prep::files_of(image)) files.push_back(identity_of(file));
    return files;
}

bool is_standard_stream(const fs::path& path) {
    return path == "-";
}

bool is_stream(const fs::path& path) {
    if (is_standard_stream(path)) return true;
    struct stat file {};
    if (::stat(path.c_str(), &file) != 0) return false;
    if (S_ISFIFO(file.st_mode)) return true;
    // Of devices, which may never end, the terminal at standard input alone.
    struct stat input {};
    return S_ISCHR(file.st_mode) && ::isatty(STDIN_FILENO) == 1 &&
           ::fstat(STDIN_FILENO, &input) == 0 && input.st_rdev == file.st_rdev;
}

Result<void> require_unread(const std::vector<fs::path>& inputs, std::size_t number) {
    const fs::path& path = inputs[number];
    if (!is_stream(path)) return {};
    const auto same = [&](const fs::path& other) {
        if (other == path) return true;
        if (is_standard_stream(path) || is_standard_stream(other)) return false;
        struct stat a {
        }, b{};  // std::filesystem::equivalent() takes no pipes
        return ::stat(path.c_str(), &a) == 0 && ::stat(other.c_str(), &b) == 0 &&
               a.st_dev == b.st_dev && a.st_ino == b.st_ino;
    };
    for (std::size_t other = 0; other < number; ++other)
        if (same(inputs[other]))
            return Error{ErrorCode::invalid,
                         "this is read once, and an earlier input is the same; give it once",
                         path.string()};
    return {};
}

bool is_of_descriptors(const fs::path& folder) {
    std::error_code ec;
    const fs::path full = fs::absolute(folder, ec).lexically_normal();
    auto part = full.begin();
    if (part == full.end() || ++part == full.end()) return false;
    return *part == "proc" || full == "/dev" || full == "/dev/fd";
}

std::string said_of(const fs::path& input, const std::string& text) {
    for (const std::string& name : {input.string(), input.filename().string()})
        if (text.starts_with(name) && text.size() > name.size() &&
            std::string_view(":#,").find(text[name.size()]) != std::string_view::npos)
            return input.string() + text.substr(name.size());
    return input.string() + ": " + text;
}

bool is_packed(const fs::path& path) {
    const std::string ending = lower_ending(path);
    return ending == "gz" || ending == "zip";
}

bool holds_mesh(const fs::path& path) {
    // A scene is JSON, but not all JSON is a scene, and a zip file may hold anything: in a
    // directory only meshes are meant.
    const prep::FileFormat* const format =
        prep::file_format(lower_ending(path) == "gz" ? path.stem() : path);
    return format && format->meshes;
}

Result<JobList> plan_jobs(const JobRequest& request) {
    const std::vector<Input> inputs = list_inputs(request);
    JobList list;
    bool directory = false;
    if (request.in_place) {
        for (const Input& input : inputs)
            list.jobs.push_back({input.path, input.path, lower_ending(input.path), input.error});
    } else if (is_standard_stream(request.output)) {
        if (inputs.size() != 1)
            return Error{ErrorCode::invalid, "standard output takes one result; give one input",
                         "-"};
        if (request.format.empty())
            return Error{
                ErrorCode::invalid,
                "has no ending to say the format; give --format, one of " + output_endings_text(),
                "-"};
        list.jobs.push_back({inputs[0].path, request.output, request.format, inputs[0].error});
    } else if (names_directory(request, inputs.size())) {
        directory = true;
        fs::path folder = request.output;
        if (!folder.has_filename()) folder = folder.parent_path();
        if (const Result<void> good = check_directory(folder, request); !good) return good.error();
        const std::string format = request.format.empty() ? "glb" : request.format;
        for (const Input& input : inputs)
            list.jobs.push_back(
                {input.path, folder / input.below / (stem_of(input.path).string() + "." + format),
                 format, input.error});
    } else {
        if (const Result<void> good = check_writable_ending(request.output); !good)
            return good.error();
        list.jobs.push_back(
            {inputs[0].path, request.output, lower_ending(request.output), inputs[0].error});
    }
    if (const Result<void> good = check_idle_options(list, request, directory); !good)
        return good.error();
    find_conflicts(list, request);
    return list;
}

}  // namespace meshprep
