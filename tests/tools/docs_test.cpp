// The documentation's own promises: what its links lead to is there.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "command_runner.h"
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

TEST(Documentation, LinksLeadToFiles) {
    std::size_t links = 0;
    for (const fs::path& page : pages())
        for (const std::string& target : between(test::read_text(page), "](", ")# \n")) {
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
            for (const std::string& page : between(test::read_text(entry.path()), "docs/", ".")) {
                if (page.empty() ||
                    page.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") != std::string::npos)
                    continue;
                ++names;
                EXPECT_TRUE(fs::exists(test::source_dir() / "docs" / (page + ".md")))
                    << entry.path() << " → " << page;
            }
        }
    EXPECT_GT(names, 5u);
}

}  // namespace
