#include "meshprep/files/file_list.h"

#include <unistd.h>

#include <algorithm>
#include <map>
#include <set>

#include "prep/formats.h"

namespace meshprep {
namespace {

namespace fs = std::filesystem;
using prep::Error;
using prep::ErrorCode;
using prep::Result;

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

bool known(const std::vector<std::string>& endings, const std::string& ending) {
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

struct Input {
    fs::path path;
    fs::path below;  // directory below the one that was named, kept apart in the output
};

Result<std::vector<Input>> list_inputs(const JobRequest& request) {
    std::vector<Input> inputs;
    for (const fs::path& path : request.inputs) {
        std::error_code ec;
        if (!fs::is_directory(path, ec)) {
            if (const Result<void> there = require_file(path); !there) return there.error();
            inputs.push_back({path, {}});
            continue;
        }
        std::vector<Input> found;
        const auto take = [&](const fs::directory_entry& entry) {
            std::error_code entry_ec;
            if (!entry.is_regular_file(entry_ec)) return;
            // A scene is JSON, but not all JSON is a scene: in a directory only meshes are meant.
            const prep::FileFormat* const format = prep::file_format(entry.path());
            if (!format || !format->meshes) return;
            found.push_back({entry.path(), entry.path().parent_path().lexically_relative(path)});
        };
        if (request.recursive) {
            const auto options = fs::directory_options::skip_permission_denied;
            for (fs::recursive_directory_iterator it(path, options, ec), end; !ec && it != end;
                 it.increment(ec))
                take(*it);
        } else {
            for (fs::directory_iterator it(path, ec), end; !ec && it != end; it.increment(ec))
                take(*it);
        }
        if (ec)
            return Error{ErrorCode::io, "cannot list the directory: " + ec.message(),
                         path.string()};
        if (found.empty())
            return Error{ErrorCode::io,
                         "the directory holds no mesh file" +
                             std::string(request.recursive ? "" : "; -r also looks below it"),
                         path.string()};
        std::sort(found.begin(), found.end(),
                  [](const Input& a, const Input& b) { return a.path < b.path; });
        for (Input& input : found) {
            if (input.below == ".") input.below.clear();
            inputs.push_back(std::move(input));
        }
    }
    return inputs;
}

// The same file whatever way it is named.
fs::path identity(const fs::path& path) {
    std::error_code ec;
    const fs::path canonical = fs::weakly_canonical(path, ec);
    return ec ? fs::absolute(path).lexically_normal() : canonical;
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
Result<void> check_idle_options(const JobList& list, const JobRequest& request) {
    if (!request.format.empty() && list.directories.empty() &&
        (request.in_place || lower_ending(request.output) != request.format))
        return Error{ErrorCode::invalid,
                     request.in_place ? "--in-place keeps each file's format; leave --format out"
                                      : "its ending says the format, and --format " +
                                            request.format + " another; leave one of them out",
                     request.output.string()};
    if (!request.ascii || list.jobs.empty()) return {};
    for (const Job& job : list.jobs)
        if (const std::string ending = lower_ending(job.output); ending == "ply" || ending == "stl")
            return {};
    return Error{ErrorCode::invalid,
                 "--ascii is for PLY and STL, which also have a binary form; leave it out",
                 list.jobs[0].output.string()};
}

Result<void> check_conflicts(const JobList& list, const JobRequest& request) {
    std::map<fs::path, fs::path> outputs;
    std::set<fs::path> inputs;
    for (const Job& job : list.jobs) inputs.insert(identity(job.input));
    for (const Job& job : list.jobs) {
        const fs::path id = identity(job.output);
        const auto [other, fresh] = outputs.emplace(id, job.input);
        if (!fresh)
            return Error{ErrorCode::invalid,
                         "two inputs would be written to this file: " + other->second.string() +
                             " and " + job.input.string() + "; rename one or prepare them apart",
                         job.output.string()};
        if (!request.in_place && inputs.count(id) != 0)
            return Error{ErrorCode::invalid,
                         "the output is also an input; give another name, or --in-place",
                         job.output.string()};
        std::error_code ec;
        if (fs::is_directory(job.output, ec))
            return Error{ErrorCode::io, "a directory is in the way of this output file",
                         job.output.string()};
        if (!request.overwrite && fs::exists(job.output, ec))
            return Error{ErrorCode::io, "the output exists, and --no-overwrite was given",
                         job.output.string()};
    }
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
    return joined(output_endings());
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
    return joined(words);
}

std::string lower_ending(const fs::path& path) {
    const std::string ending = prep::lower_ending(path);
    return ending.empty() ? ending : ending.substr(1);
}

Result<void> require_file(const fs::path& path) {
    std::error_code ec;
    const fs::file_status status = fs::status(path, ec);
    if (!fs::exists(status))
        return Error{ErrorCode::io, "there is no such file; check the name and the directory",
                     path.string()};
    if (fs::is_directory(status))
        return Error{ErrorCode::io, "this is a directory, expected a file", path.string()};
    if (::access(path.c_str(), R_OK) != 0)
        return Error{ErrorCode::io, "no permission to read this file", path.string()};
    return {};
}

Result<void> require_parent(const fs::path& file) {
    const fs::path parent = file.has_parent_path() ? file.parent_path() : fs::path(".");
    std::error_code ec;
    if (fs::is_directory(parent, ec)) return {};
    return Error{ErrorCode::io,
                 "the directory '" + parent.string() + "' is not there; make it first",
                 file.string()};
}

Result<void> make_directory(const fs::path& directory) {
    std::error_code ec;
    if (fs::is_directory(directory, ec)) return {};
    if (fs::exists(directory, ec))
        return Error{ErrorCode::io, "a file of this name is in the way of the output directory",
                     directory.string()};
    fs::path plain = directory;
    if (!plain.has_filename()) plain = plain.parent_path();
    if (const Result<void> parent = require_parent(plain); !parent) return parent.error();
    fs::create_directory(plain, ec);
    if (ec)
        return Error{ErrorCode::io, "cannot make the directory: " + ec.message(),
                     directory.string()};
    return {};
}

Result<JobList> plan_jobs(const JobRequest& request) {
    Result<std::vector<Input>> inputs = list_inputs(request);
    if (!inputs) return inputs.error();
    JobList list;
    if (request.in_place) {
        for (const Input& input : *inputs) list.jobs.push_back({input.path, input.path});
    } else if (names_directory(request, inputs->size())) {
        fs::path directory = request.output;
        if (!directory.has_filename()) directory = directory.parent_path();
        const std::string format = request.format.empty() ? "glb" : request.format;
        std::set<fs::path> below;
        list.directories.push_back(directory);
        for (const Input& input : *inputs) {
            fs::path folder;
            for (const fs::path& part : input.below) {
                folder /= part;
                below.insert(folder);
            }
            list.jobs.push_back({input.path, directory / input.below /
                                                 (input.path.stem().string() + "." + format)});
        }
        for (const fs::path& folder : below) list.directories.push_back(directory / folder);
        std::error_code ec;
        if (!fs::is_directory(directory, ec)) {
            if (request.output.has_filename() && check_writable_ending(directory))
                return Error{ErrorCode::invalid,
                             "several inputs need a directory, and this is the name of one mesh; "
                             "end it with a slash if it is to be one",
                             request.output.string()};
            if (fs::exists(directory, ec))
                return Error{ErrorCode::io,
                             "a file of this name is in the way of the output directory",
                             directory.string()};
            if (const Result<void> parent = require_parent(directory); !parent)
                return parent.error();
        }
    } else {
        list.jobs.push_back({(*inputs)[0].path, request.output});
        if (const Result<void> good = check_writable_ending(request.output); !good)
            return good.error();
        if (const Result<void> parent = require_parent(request.output); !parent)
            return parent.error();
    }
    for (const Job& job : list.jobs)
        if (const Result<void> good = check_writable_ending(job.output); !good) return good.error();
    if (const Result<void> good = check_idle_options(list, request); !good) return good.error();
    if (const Result<void> good = check_conflicts(list, request); !good) return good.error();
    return list;
}

}  // namespace meshprep
