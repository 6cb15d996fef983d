#include "meshprep/commands/generate.h"

#include "meshprep/files/output_directories.h"
#include "meshprep/options/common_options.h"
#include "meshprep/options/completions.h"
#include "meshprep/options/manual.h"
#include "prep/files.h"
#include "prep/version.h"

namespace meshprep {

int generate(const std::vector<std::string>& words, const CommandTables& tables,
             std::ostream& err) {
    std::vector<std::pair<std::string, std::string>> files;
    const std::string kind = words.empty() ? "" : words[0];
    if (kind == "man") files = manual_pages(tables, std::string(prep::version()));
    // The names that each shell looks for.
    if (kind == "bash") files = {{"meshprep", bash_completion(tables)}};
    if (kind == "zsh") files = {{"_meshprep", zsh_completion(tables)}};
    if (kind == "fish") files = {{"meshprep.fish", fish_completion(tables)}};
    if (files.empty() || words.size() != 2) {
        err << "meshprep: error: --generate takes man, bash, zsh or fish, and a directory\n";
        return exit_usage;
    }
    const std::filesystem::path directory = words[1];
    OutputDirectories directories;
    prep::Result<void> done = directories.make(directory);
    for (const auto& [name, text] : files)
        if (done)
            done = prep::write_file(directory / name, std::as_bytes(std::span<const char>(text)));
    if (done) return exit_done;
    err << "meshprep: error: " << to_string(done.error()) << '\n';
    return exit_failed;
}

}  // namespace meshprep
