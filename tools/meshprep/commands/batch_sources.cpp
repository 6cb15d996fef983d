#include "meshprep/commands/batch_sources.h"

#include <algorithm>

#include "base/step_count.h"
#include "meshprep/output/load_options.h"
#include "prep/files.h"
#include "prep/load.h"

namespace meshprep {
namespace {

std::string name_of_file(const std::filesystem::path& file) {
    return identity_of(file).string();
}

// Of what is in the file, without a dot.
std::string ending_of(const std::filesystem::path& input) {
    return lower_ending(lower_ending(input) == "gz" ? input.stem() : input);
}

// Formats whose files name no others.
bool stands_alone(const std::filesystem::path& input) {
    const std::string ending = ending_of(input);
    return ending == "stl" || ending == "off" || ending == "om";
}

}  // namespace

BatchSources::BatchSources(const std::vector<Job>& jobs, const CommonOptions& common,
                           Console& console)
    : jobs_(jobs), common_(common), console_(console), known_(jobs.size(), false) {
    for (std::size_t number = 0; number < jobs.size(); ++number) {
        // An input that is refused as it comes twice is no other reader of its file.
        std::vector<std::size_t>& readers = jobs_of_[name_of_file(jobs[number].input)];
        if (!jobs[number].error || readers.empty()) readers.push_back(number);
        if (jobs[number].error || is_stream(jobs[number].input) || stands_alone(jobs[number].input))
            continue;
        to_load_.insert(to_load_.end(), number);
        if (ending_of(jobs[number].input) == "json")
            scenes_to_load_.insert(scenes_to_load_.end(), number);
    }
}

void BatchSources::add(const std::filesystem::path& file) {
    const std::lock_guard lock(mutex_);
    jobs_of_[name_of_file(file)].push_back(jobs_.size());
}

void BatchSources::add(const Job& job, const InputFile& input, const prep::Scene& scene) {
    std::vector<std::filesystem::path> files;
    const auto take = [&](const std::filesystem::path& file) {
        if (!input.passing(file)) files.push_back(file);
    };
    for (const std::filesystem::path& library : scene.libraries) take(library);
    for (const prep::ImageRef& image : scene.images)
        for (const std::filesystem::path& file : prep::files_of(image)) take(file);
    keep(std::size_t(&job - jobs_.data()), files);
}

void BatchSources::add(const Job& job, const std::vector<std::filesystem::path>& files) {
    keep(std::size_t(&job - jobs_.data()), files);
}

void BatchSources::keep(std::size_t number, const std::vector<std::filesystem::path>& files) {
    std::vector<std::string> names;
    for (const std::filesystem::path& file : files) names.push_back(name_of_file(file));
    const std::lock_guard lock(mutex_);
    if (known_[number]) return;
    known_[number] = true;
    to_load_.erase(number);
    scenes_to_load_.erase(number);
    for (const std::string& name : names) jobs_of_[name].push_back(number);
}

// What cannot be read is that job's error, and it has no sources.
void BatchSources::load(std::size_t number) {
    const Job& job = jobs_[number];
    const prep::Result<InputFile> input = InputFile::open(job.input, common_.input_format, &links_);
    if (input) {
        prep::LoadOptions options = load_options(common_, console_);
        options.reader_log = {};  // said when the job itself is done
        const prep::Result<prep::Scene> scene = prep::load_scene(input->path(), options);
        if (scene) add(job, *input, *scene);
    }
    keep(number, {});
}

// Those that are known by the time of their turn are not loaded again.
void BatchSources::make_known(const std::set<std::size_t>& of, std::size_t but) {
    std::vector<std::size_t> numbers;
    {
        const std::lock_guard data(mutex_);
        numbers.assign(of.begin(), of.end());
    }
    prep::detail::count_steps(numbers.size());
    for (const std::size_t number : numbers) {
        if (number == but) continue;
        const std::lock_guard lock(loading_);
        bool wanted = false;
        {
            const std::lock_guard data(mutex_);
            wanted = !known_[number];
        }
        if (wanted) load(number);
    }
}

bool BatchSources::has_another(const std::string& name, std::size_t number) const {
    const std::lock_guard lock(mutex_);
    const auto found = jobs_of_.find(name);
    return found != jobs_of_.end() &&
           std::any_of(found->second.begin(), found->second.end(),
                       [&](std::size_t other) { return other != number; });
}

bool BatchSources::of_another(const Job& job, const std::filesystem::path& file) {
    const auto number = std::size_t(&job - jobs_.data());
    const std::string name = name_of_file(file);
    if (has_another(name, number)) return true;
    const bool own_output = file == job.output || name == name_of_file(job.output);
    make_known(own_output ? scenes_to_load_ : to_load_, number);
    return has_another(name, number);
}

bool BatchSources::of_any(const std::filesystem::path& file) {
    const std::string name = name_of_file(file);
    const std::size_t none = jobs_.size() + 1;
    if (has_another(name, none)) return true;
    make_known(to_load_, none);
    return has_another(name, none);
}

}  // namespace meshprep
