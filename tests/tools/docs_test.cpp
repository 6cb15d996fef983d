// The documentation's own promises: what its links lead to is there, what it tells people to type
// is taken.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "command_runner.h"
#include "meshprep/commands/subcommand.h"
#include "prep/render_choices.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> pages() {
    std::vector<fs::path> found;
    for (const char* folder : {"", "docs", "bench", "samples", "fuzz"})
        for (const fs::directory_entry& entry : fs::directory_iterator(test::source_dir() / folder))
            if (entry.path().extension() == ".md") found.push_back(entry.path());
    return found;
}

// What stands between each `open` and the next of the characters `ends`.
std::vector<std::string> between(const std::string& text, const std::string& open,
                                 const std::string& ends) {
    std::vector<std::string> found;
    for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
        at += open.size();
        found.push_back(text.substr(at, text.find_first_of(ends, at) - at));
    }
    return found;
}

// The page without its blocks of code.
std::string prose(const std::string& page) {
    std::istringstream lines(page);
    std::string out;
    bool fenced = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("```", 0) == 0) fenced = !fenced;
        if (!fenced) out += line + "\n";
    }
    return out;
}

TEST(Documentation, LinksLeadToFiles) {
    std::size_t links = 0;
    for (const fs::path& page : pages())
        for (const std::string& target : between(prose(test::file_text(page)), "](", ")# \n")) {
            if (target.empty() || target.find("://") != std::string::npos) continue;
            ++links;
            EXPECT_TRUE(fs::exists(page.parent_path() / target)) << page << " → " << target;
        }
    EXPECT_GT(links, 20u);
}

// Headers and sources refer to pages too.
TEST(Documentation, PagesThatTheCodeNamesAreThere) {
    std::size_t names = 0;
    for (const char* folder : {"libprep", "librast", "tools", "tests", "bench"})
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(test::source_dir() / folder)) {
            const std::string ending = entry.path().extension().string();
            if (ending != ".h" && ending != ".cpp") continue;
            for (const std::string& page : between(test::file_text(entry.path()), "docs/", ".")) {
                if (page.empty() ||
                    page.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") != std::string::npos)
                    continue;
                ++names;
                const fs::path named = test::source_dir() / "docs" / page;
                EXPECT_TRUE(fs::exists(named.string() + ".md") || fs::is_directory(named))
                    << entry.path() << " → " << page;
            }
        }
    EXPECT_GT(names, 5u);
}

TEST(Documentation, TheIndexListsEveryPage) {
    const std::string index = test::file_text(test::source_dir() / "docs/README.md");
    for (const fs::directory_entry& entry : fs::directory_iterator(test::source_dir() / "docs")) {
        const std::string name = entry.path().filename();
        if (entry.path().extension() == ".md" && name != "README.md") {
            EXPECT_NE(index.find("](" + name + ")"), std::string::npos) << name;
        }
    }
}

// Lines of `meshprep SUBCOMMAND …` and options in backticks, against what --help lists.
TEST(Documentation, OptionsOfThePagesAreThoseOfTheCommand) {
    std::map<std::string, std::string> help;
    std::string all;
    for (const char* name :
         {"prepare", "inspect", "render", "validate", "cost", "diff", "height-to-normal"}) {
        const test::Ran ran = test::run_here({name, "--help"});
        ASSERT_EQ(ran.exit_code, 0) << name;
        // Without the examples.
        help[name] = ran.out.substr(0, ran.out.find("Examples:"));
        all += help[name];
    }
    const auto lists = [](const std::string& text, const std::string& option) {
        return std::regex_search(text, std::regex("[ ,]" + option + "[ ,\n]"));
    };
    const std::regex word("--[a-z][a-z-]*");
    std::size_t lines = 0, options = 0;
    for (const fs::path& page : pages()) {
        if (page.filename() == "CHANGELOG.md" || page.filename() == "mutants.md") continue;
        std::istringstream text(test::file_text(page));
        bool fenced = false;
        for (std::string line; std::getline(text, line);) {
            const std::size_t start = line.find_first_not_of(" ");
            if (line.compare(0, 3, "```") == 0) fenced = !fenced;
            std::smatch command;
            if (start != std::string::npos && (fenced || start == 4) &&
                line.compare(start, 9, "meshprep ") == 0 &&
                std::regex_search(line, command, std::regex("meshprep +([a-z-]+)"))) {
                ASSERT_EQ(help.count(command[1]), 1u) << page << ": " << line;
                line.resize(std::min(line.find('#'), line.size()));
                ++lines;
                for (std::sregex_iterator i(line.begin(), line.end(), word), end; i != end; ++i)
                    EXPECT_TRUE(lists(help[command[1]], i->str()))
                        << page << ": " << command[1] << " has no " << i->str();
            } else {
                for (const std::string& code : between(line, "`--", "`")) {
                    std::smatch found;
                    const std::string whole = "--" + code;
                    if (!std::regex_search(whole, found, word)) continue;
                    ++options;
                    EXPECT_TRUE(lists(all, found.str())) << page << ": " << found.str();
                }
            }
        }
    }
    EXPECT_GT(lines, 20u);
    EXPECT_GT(options, 60u);
}

// The README's table: what is written is written and read back, what is only read is refused.
TEST(Documentation, FormatsOfTheReadmeAreReadAndWritten) {
    const test::TempDir dir;
    test::write_text(dir / "cube.obj", test::cube_obj());
    std::istringstream text(test::file_text(test::source_dir() / "README.md"));
    const std::regex row(R"(\| ([^|]+) \| yes \| (yes|–) \|.*)");
    std::size_t written = 0, refused = 0;
    for (std::string line; std::getline(text, line);) {
        std::smatch cells;
        if (!std::regex_match(line, cells, row)) continue;
        const std::string formats = cells[1];
        const std::regex name("[A-Za-z0-9]*[A-Z][A-Za-z0-9]*|3DS");
        for (std::sregex_iterator i(formats.begin(), formats.end(), name), end; i != end; ++i) {
            std::string ending = i->str();
            if (ending == "MTL") continue;  // beside an OBJ
            for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
            const std::string out = (dir / ("a." + ending)).string();
            const int code =
                test::run_here({"prepare", (dir / "cube.obj").string(), "-o", out}).exit_code;
            if (cells[2] == "yes") {
                ++written;
                EXPECT_EQ(code, 0) << ending;
                EXPECT_EQ(test::run_here({"inspect", out}).exit_code, 0) << ending;
            } else {
                ++refused;
                EXPECT_EQ(code, 2) << ending;
                EXPECT_FALSE(fs::exists(out)) << ending;
            }
        }
    }
    EXPECT_EQ(written, 6u);  // OBJ, glTF, GLB, PLY, STL, OFF
    EXPECT_EQ(refused, 6u);  // OM, VRM, JSON, FBX, DAE, 3DS
}

TEST(Documentation, ReadmeListsTheSubcommandsInTheirOrder) {
    const std::string readme = test::file_text(test::source_dir() / "README.md");
    const std::size_t begin = readme.find("| subcommand |");
    ASSERT_NE(begin, std::string::npos);
    const std::string table = readme.substr(begin, readme.find("\n\n", begin) - begin);
    std::vector<std::string> names;
    for (const meshprep::Subcommand& subcommand : meshprep::subcommands())
        names.push_back(subcommand.name);
    EXPECT_EQ(between(table, "\n| `", " `"), names);
}

TEST(Documentation, SceneFormatNamesEveryChoiceOfAPicture) {
    const std::string page = test::file_text(test::source_dir() / "docs/scene-format.md");
    const std::string table = page.substr(page.find("## Picture"));
    prep::for_each_render_choice([&](std::string_view key, auto, const auto&, const char*) {
        EXPECT_NE(table.find("| `" + std::string(key) + "` |"), std::string::npos) << key;
    });
}

}  // namespace
