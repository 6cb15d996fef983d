// Manual pages and completions: made from the options there are, readable by what reads them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "command_runner.h"
#include "meshprep/commands/subcommand.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;
using test::file_text;
using test::run_here;
using test::run_program;
using test::TempDir;

std::optional<fs::path> program(const std::string& name) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        std::error_code ec;
        const fs::path file = fs::path(folder) / name;
        if (fs::is_regular_file(file, ec)) return file;
    }
    return std::nullopt;
}

#define REQUIRE_PROGRAM(variable, name)                             \
    const auto variable##_found = program(name);                    \
    if (!variable##_found) GTEST_SKIP() << name << " is not there"; \
    const fs::path variable = *variable##_found

class ShellFiles : public ::testing::Test {
  protected:
    fs::path made(const std::string& kind) {
        const fs::path folder = dir_ / kind;
        const test::Ran ran = run_here({"--generate", kind, folder.string()});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return folder;
    }
    TempDir dir_;
};

// "-o" and "--output" of a subcommand's help, which CLI11 writes from the same definitions.
std::vector<std::string> options_of(const std::string& subcommand) {
    std::vector<std::string> names;
    std::istringstream help(run_here({subcommand, "--help"}).out);
    for (std::string line; std::getline(help, line);) {
        if (line == "Examples:") break;
        if (line.size() < 3 || line.substr(0, 3) != "  -") continue;
        std::istringstream words(line);
        std::string word;
        words >> word;
        std::istringstream list(word);
        for (std::string name; std::getline(list, name, ',');) names.push_back(name);
    }
    return names;
}

// The page as a terminal shows it, in one line.
std::string shown(const fs::path& man, const fs::path& page) {
    setenv("MANWIDTH", "4000", 1);
    setenv("MAN_KEEP_FORMATTING", "", 1);
    const test::Ran ran = run_program(man, {"-l", page.string()});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.err, "") << page;
    return ran.out;
}

TEST_F(ShellFiles, ManualPagesShowEveryOption) {
    REQUIRE_PROGRAM(man, "man");
    setenv("LC_ALL", "C.UTF-8", 1);
    const fs::path folder = made("man");
    const std::string command = shown(man, folder / "meshprep.1");
    for (const meshprep::Subcommand& subcommand : meshprep::subcommands()) {
        EXPECT_NE(command.find("meshprep-" + subcommand.name + "(1)"), std::string::npos)
            << command;
        const std::string page = shown(man, folder / ("meshprep-" + subcommand.name + ".1"));
        EXPECT_NE(page.find("meshprep-" + subcommand.name + " - "), std::string::npos);
        std::size_t count = 0;
        for (const std::string& option : options_of(subcommand.name)) {
            EXPECT_NE(page.find(option), std::string::npos) << subcommand.name << " " << option;
            ++count;
        }
        EXPECT_GT(count, 8u);
        EXPECT_NE(page.find("EXAMPLES"), std::string::npos);
        // An example as it is typed, its dashes with it.
        EXPECT_NE(page.find("meshprep " + subcommand.name + " "), std::string::npos);
    }
}

TEST_F(ShellFiles, ManualPagesDrawNoWarnings) {
    REQUIRE_PROGRAM(groff, "groff");
    for (const auto& page : fs::directory_iterator(made("man"))) {
        const test::Ran ran =
            run_program(groff, {"-man", "-Tutf8", "-ww", "-k", "-z", page.path().string()});
        EXPECT_EQ(ran.exit_code, 0) << page.path();
        EXPECT_EQ(ran.err, "") << page.path();
    }
}

// What bash would offer for words typed so far, the last of them unfinished.
class Bash {
  public:
    Bash(fs::path bash, fs::path script) : bash_(std::move(bash)), script_(std::move(script)) {}
    std::vector<std::string> offers(const std::vector<std::string>& words) const {
        std::string line = "source '" + script_.string() + "'; COMP_WORDS=(meshprep";
        for (const std::string& word : words) line += " '" + word + "'";
        line += "); COMP_CWORD=" + std::to_string(words.size()) +
                "; _meshprep; for offer in \"${COMPREPLY[@]}\"; do echo \"$offer\"; done";
        const test::Ran ran = run_program(bash_, {"--norc", "-c", line});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_EQ(ran.err, "") << line;
        std::vector<std::string> list;
        std::istringstream out(ran.out);
        for (std::string offer; std::getline(out, offer);) list.push_back(offer);
        return list;
    }

  private:
    fs::path bash_, script_;
};

using Words = std::vector<std::string>;

TEST_F(ShellFiles, BashCompletesSubcommandsOptionsWordsAndFiles) {
    REQUIRE_PROGRAM(bash, "bash");
    const fs::path script = made("bash") / "meshprep";
    const test::Ran syntax = run_program(bash, {"-n", script.string()});
    EXPECT_EQ(syntax.exit_code, 0) << syntax.err;
    const Bash shell(bash, script);
    EXPECT_EQ(shell.offers({"pre"}), (Words{"prepare"}));
    EXPECT_EQ(shell.offers({"--ver"}), (Words{"--version"}));
    EXPECT_EQ(shell.offers({"help", "ren"}), (Words{"render"}));
    EXPECT_EQ(shell.offers({"prepare", "--man"}), (Words{"--manifest"}));
    EXPECT_EQ(shell.offers({"render", "--shading", "no"}), (Words{"normal-mapped"}));
    EXPECT_EQ(shell.offers({"prepare", "--hard-angle", ""}), (Words{"off", "auto"}));
    EXPECT_EQ(shell.offers({"prepare", "--threads", ""}), (Words{}));
    for (const meshprep::Subcommand& subcommand : meshprep::subcommands()) {
        const Words all = shell.offers({subcommand.name, "-"});
        for (const std::string& option : options_of(subcommand.name))
            EXPECT_EQ(std::count(all.begin(), all.end(), option), 1)
                << subcommand.name << " " << option;
    }
    // Files, with blanks in their names too, as inputs and as values.
    fs::create_directory(dir_ / "in");
    test::write_text(dir_ / "in/my chair.obj", "");
    test::write_text(dir_ / "in/other.obj", "");
    const Words chair{(dir_ / "in/my chair.obj").string()};
    EXPECT_EQ(shell.offers({"inspect", (dir_ / "in/my").string()}), chair);
    EXPECT_EQ(shell.offers({"prepare", "x.obj", "-o", (dir_ / "in/m").string()}), chair);
}

TEST_F(ShellFiles, ZshReadsItsCompletion) {
    REQUIRE_PROGRAM(zsh, "zsh");
    const test::Ran ran = run_program(zsh, {"-n", (made("zsh") / "_meshprep").string()});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.err, "");
}

TEST_F(ShellFiles, FishReadsItsCompletion) {
    REQUIRE_PROGRAM(fish, "fish");
    const test::Ran ran = run_program(fish, {"-n", (made("fish") / "meshprep.fish").string()});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.err, "");
}

// Without those shells, too: each option once for each subcommand, quotes in pairs.
TEST_F(ShellFiles, ZshAndFishHaveEveryOption) {
    const std::string zsh = file_text(made("zsh") / "_meshprep");
    const std::string fish = file_text(made("fish") / "meshprep.fish");
    std::istringstream lines(zsh);
    for (std::string line; std::getline(lines, line);) {
        const std::string apostrophe = "'\\''";
        for (std::size_t at; (at = line.find(apostrophe)) != std::string::npos;)
            line.erase(at, apostrophe.size());
        EXPECT_EQ(std::count(line.begin(), line.end(), '\'') % 2, 0) << line;
    }
    for (const meshprep::Subcommand& subcommand : meshprep::subcommands()) {
        const std::size_t from = zsh.find("        " + subcommand.name + ")\n");
        ASSERT_NE(from, std::string::npos);
        const std::string part = zsh.substr(from, zsh.find(";;", from) - from);
        for (const std::string& option : options_of(subcommand.name)) {
            EXPECT_NE(part.find(option), std::string::npos) << subcommand.name << " " << option;
            const std::string flag = option.substr(0, 2) == "--" ? " -l " + option.substr(2) + " "
                                                                 : " -s " + option.substr(1) + " ";
            bool found = false;
            std::istringstream rows(fish);
            for (std::string line; std::getline(rows, line);)
                found |= line.find("seen_subcommand_from " + subcommand.name + "'") !=
                             std::string::npos &&
                         line.find(flag) != std::string::npos;
            EXPECT_TRUE(found) << subcommand.name << " " << option;
        }
    }
}

TEST_F(ShellFiles, TheBuildMakesThemAndAWrongKindIsAnError) {
    for (const char* name :
         {"man/meshprep-prepare.1", "bash/meshprep", "zsh/_meshprep", "fish/meshprep.fish"}) {
        const fs::path built = test::command_path().parent_path() / "tools/shell" / name;
        const fs::path here =
            made(fs::path(name).parent_path().string()) / fs::path(name).filename();
        EXPECT_EQ(file_text(built), file_text(here)) << name;
        EXPECT_FALSE(file_text(here).empty()) << name;
    }
    EXPECT_EQ(run_here({"--generate", "tcsh", dir_.path().string()}).exit_code, 2);
    EXPECT_EQ(run_here({"--generate"}).exit_code, 2);
}

}  // namespace
